"""The sensor workbench from Python: `import workbench as wb`.

    design = wb.load("geltip").replace("layers.elastomer_mm", 1.5)
    press = wb.Press(target_mm=(0.0, 10.0, 25.0), depth_mm=1.0, frames=3)
    results = wb.evaluate(design, wb.Indenter("sphere", size_mm=6.0), press)
    results.contact.reaction_N      # (3, 3) [N]
    results.images                  # (4, H, W, 3), uint8

These names are stable; everything else is private, and may move or change with any version. Each is
imported when it is first used, so that `import workbench` costs nothing. Inside, lengths are mm,
forces N, pressures MPa; a name says where it is otherwise. What goes wrong is a `WorkbenchError`
with a message, a hint, and the field that it is about.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from workbench.core.base.version import VERSION as __version__

if TYPE_CHECKING:
    from workbench.core.base.errors import WorkbenchError
    from workbench.core.base.packages import PackageError
    from workbench.core.design.camera import Camera
    from workbench.core.design.design import Elastomer as Material
    from workbench.core.design.design import SensorDesign as Design
    from workbench.core.design.lighting import LedRing
    from workbench.core.design.optics import Optics
    from workbench.core.press.indenter import Indenter
    from workbench.core.press.motion import lift, release, roll, slide, twist
    from workbench.core.press.press import ContactSettings, Press
    from workbench.core.press.trajectory import Trajectory
    from workbench.door.force_network import ForceNetwork
    from workbench.door.results import Results, evaluate
    from workbench.door.studies import compare, search_designs, sweep
    from workbench.edit.indenter_choice import choose_indenter
    from workbench.learning.dataset.algorithms import finger_algorithm
    from workbench.learning.dataset.folder import DataSet
    from workbench.project.named_designs import load_design as load
    from workbench.project.project import Project
    from workbench.sensor.sensor import Sensor
    from workbench.simulators.mujoco_attach import attach

__all__ = [
    "Camera",
    "ContactSettings",
    "DataSet",
    "Design",
    "ForceNetwork",
    "Indenter",
    "LedRing",
    "Material",
    "Optics",
    "PackageError",
    "Press",
    "Project",
    "Results",
    "Sensor",
    "Trajectory",
    "WorkbenchError",
    "__version__",
    "attach",
    "choose_indenter",
    "compare",
    "evaluate",
    "finger_algorithm",
    "lift",
    "load",
    "release",
    "roll",
    "search_designs",
    "slide",
    "sweep",
    "twist",
]

_PLACES = {
    "Camera": "workbench.core.design.camera",
    "ContactSettings": "workbench.core.press.press",
    "DataSet": "workbench.learning.dataset.folder",
    "Design": "workbench.core.design.design:SensorDesign",
    "ForceNetwork": "workbench.door.force_network",
    "Indenter": "workbench.core.press.indenter",
    "LedRing": "workbench.core.design.lighting",
    "Material": "workbench.core.design.design:Elastomer",
    "Optics": "workbench.core.design.optics",
    "PackageError": "workbench.core.base.packages",
    "Press": "workbench.core.press.press",
    "Project": "workbench.project.project",
    "Results": "workbench.door.results",
    "Sensor": "workbench.sensor.sensor",
    "Trajectory": "workbench.core.press.trajectory",
    "WorkbenchError": "workbench.core.base.errors",
    "attach": "workbench.simulators.mujoco_attach",
    "choose_indenter": "workbench.edit.indenter_choice",
    "compare": "workbench.door.studies",
    "evaluate": "workbench.door.results",
    "finger_algorithm": "workbench.learning.dataset.algorithms",
    "lift": "workbench.core.press.motion",
    "load": "workbench.project.named_designs:load_design",
    "release": "workbench.core.press.motion",
    "roll": "workbench.core.press.motion",
    "search_designs": "workbench.door.studies",
    "slide": "workbench.core.press.motion",
    "sweep": "workbench.door.studies",
    "twist": "workbench.core.press.motion",
}
"""Module of each name, and what it is called there if otherwise."""


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module, _, inner = _PLACES[name].partition(":")
    found = getattr(importlib.import_module(module), inner or name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted(__all__)
