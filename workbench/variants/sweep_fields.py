"""Numbers of a design and its press that can be swept: label, unit, range, and how one is set.

The shape's own come from the family's sliders, the rest from the table here with the ranges of the
front's sliders. A target that stands where the family aims follows the family along the sweep;
one that the designer placed stays.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import suggest
from workbench.core.press.press_case import PressCase
from workbench.edit.forms import resolve_shape, sliders
from workbench.edit.item_fields import read_field, with_field
from workbench.project.aim import default_target_mm
from workbench.project.design_toml import check_design
from workbench.project.state import State


@dataclass(frozen=True, kw_only=True, slots=True)
class SweepField:
    """A number that can be swept."""

    path: str
    """Dotted field of the state, for example `design.layers.elastomer_mm`."""
    label: str
    """What people read, the group before it."""
    unit: str
    low: float
    high: float
    whole: bool = False
    """Whether only whole numbers mean anything."""

    @property
    def title(self) -> str:
        """Label with its unit."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label


RING, CAMERA, COATING = "design.optics.ring", "design.optics.camera", "design.optics.coating"
OTHERS = tuple(
    SweepField(path=path, label=label, unit=unit, low=low, high=high, whole=whole)
    for path, label, unit, low, high, whole in (
        ("design.layers.elastomer_mm", "Layers: elastomer", "mm", 0.8, 6.0, False),
        ("design.layers.support_mm", "Layers: support", "mm", 0.4, 5.0, False),
        ("design.material.young_MPa", "Material: Young's modulus", "MPa", 0.03, 1.0, False),
        ("design.material.poisson", "Material: Poisson's ratio", "", 0.3, 0.49, False),
        ("design.material.friction", "Material: friction", "", 0.0, 1.5, False),
        ("design.material.backing_MPa", "Material: backing gel", "MPa", 0.0, 0.1, False),
        (f"{RING}.count", "LED ring: count", "", 1, 24, True),
        (f"{RING}.radius_mm", "LED ring: radius", "mm", 1.0, 30.0, False),
        (f"{RING}.height_mm", "LED ring: height", "mm", 0.0, 40.0, False),
        (f"{RING}.phase_deg", "LED ring: first LED", "°", 0.0, 360.0, False),
        (f"{RING}.tilt_deg", "LED ring: tilt", "°", -90.0, 90.0, False),
        (f"{RING}.cone_deg", "LED ring: cone", "°", 1.0, 180.0, False),
        (f"{RING}.size_mm", "LED ring: LED size", "mm", 0.1, 5.0, False),
        (f"{CAMERA}.fov_x_deg", "Camera: field of view", "°", 40.0, 160.0, False),
        (f"{CAMERA}.position_mm[1]", "Camera: x", "mm", -20.0, 20.0, False),
        (f"{CAMERA}.position_mm[2]", "Camera: y", "mm", -20.0, 20.0, False),
        (f"{CAMERA}.position_mm[3]", "Camera: z", "mm", 0.0, 30.0, False),
        (f"{CAMERA}.focus_mm", "Camera: focus", "mm", 1.0, 100.0, False),
        (f"{CAMERA}.aperture_mm", "Camera: aperture", "mm", 0.0, 3.0, False),
        (f"{CAMERA}.sensor.gain_dB", "Camera: gain", "dB", 0.0, 48.0, False),
        (f"{COATING}.albedo", "Coating: albedo", "", 0.0, 1.0, False),
        (f"{COATING}.specular", "Coating: gloss", "", 0.0, 1.0, False),
        (f"{COATING}.roughness", "Coating: roughness", "", 0.01, 1.0, False),
        ("design.optics.markers.spacing_mm", "Markers: pitch", "mm", 0.5, 10.0, False),
        ("design.optics.markers.diameter_mm", "Markers: size", "mm", 0.1, 5.0, False),
        ("design.meshing.hex_mm", "Mesh: hexahedra", "mm", 0.2, 1.5, False),
        ("case.press.depth_mm", "Press: depth", "mm", 0.1, 3.0, False),
        ("case.press.shear_mm[1]", "Press: shear along U", "mm", -2.0, 2.0, False),
        ("case.press.shear_mm[2]", "Press: shear along V", "mm", -2.0, 2.0, False),
        ("case.press.twist_deg", "Press: twist", "°", -45.0, 45.0, False),
        ("case.indenter.size_mm", "Object: size", "mm", 0.5, 30.0, False),
        ("case.indenter.turn_deg[1]", "Object: turn about X", "°", -180.0, 180.0, False),
        ("case.indenter.turn_deg[2]", "Object: turn about Y", "°", -180.0, 180.0, False),
        ("case.indenter.turn_deg[3]", "Object: turn about Z", "°", -180.0, 180.0, False),
        ("case.settings.grid_mm", "Contact solver: grid", "mm", 0.25, 1.5, False),
    )
)


def sweep_fields(state: State) -> list[SweepField]:
    """All numbers of a design and its press that can be swept, the shape's own first."""
    family = state.design.family
    own = [
        SweepField(
            path=f"design.shape.{slider.name}",
            label=f"Shape: {slider.label}",
            unit=slider.unit,
            low=slider.minimum,
            high=slider.maximum,
            whole=slider.step >= 1.0 and not slider.unit,
        )
        for slider in sliders(family)
    ]
    return [*own, *OTHERS]


def find_field(state: State, path: str) -> SweepField:
    """The field of that path.

    Raises:
        DesignError: If there is none.
    """
    known = {field.path: field for field in sweep_fields(state)}
    full = next((p + path for p in ("", "design.", "case.") if p + path in known), f"design.{path}")
    if full not in known:
        raise DesignError(f"{shown(path)} cannot be swept", hint=suggest(full, known), at="--field")
    return known[full]


def field_value(state: State, path: str) -> float:
    """The value of a swept field; of the shape the default where none is given."""
    if path.startswith("design.shape."):
        shape = resolve_shape(state.design.family, state.design.shape)
        return float(getattr(shape, path.rsplit(".", 1)[1]))
    return float(read_field(state, path))


def with_value(state: State, field: SweepField, value: float) -> State:
    """A design and press with one number changed.

    Raises:
        DesignError: If the value is refused.
    """
    number = round(value) if field.whole else value
    root, _, rest = field.path.partition(".")
    if root == "case":
        return _with_case(state, rest, number)
    design = with_field(state.design, rest, number)
    check_design(design)
    return State(design=design, case=aimed(state, dataclasses.replace(state, design=design)))


def _with_case(state: State, path: str, value: Any) -> State:
    part, _, name = path.partition(".")
    owner = getattr(state.case, part)
    name, _, number = name.partition("[")
    if number:
        values = list(getattr(owner, name))
        values[int(number.removesuffix("]")) - 1] = value
        value = tuple(values)
    changed = dataclasses.replace(owner, **{name: value})
    return State(design=state.design, case=dataclasses.replace(state.case, **{part: changed}))


def aimed(before: State, after: State) -> PressCase:
    """The press of a changed design: aimed anew where it was aimed as the family says."""
    press, design = before.case.press, before.design
    # A body from a file has to be built to be aimed at: its target stays.
    if design.body is not None or press.trajectory is not None:
        return before.case
    if tuple(press.target_mm) != default_target_mm(design):
        return before.case
    moved = dataclasses.replace(press, target_mm=default_target_mm(after.design))
    return dataclasses.replace(before.case, press=moved)
