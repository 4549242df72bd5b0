"""The cases of the robustness matrix of the finite elements: objects, places and paths.

Eight objects with edges of 0.45 mm are pressed 1 mm into four places of a membrane in ten frames,
sheared by 0.5 mm along U, then along V instead, twisted by 10 degrees on other membranes than the
finger, and released.
"""

from __future__ import annotations

import functools
import itertools
from dataclasses import dataclass

import numpy as np

from workbench.core.base.digest import digest
from workbench.core.base.errors import MeshingError, WorkbenchError
from workbench.core.base.monitor import silent
from workbench.core.design.design import Elastomer, Meshing
from workbench.core.press.fem import FemSettings
from workbench.core.press.indenter import (
    DEFAULT_EDGE_RADIUS_MM,
    Indenter,
    IndenterKind,
    IndenterMesh,
)
from workbench.core.press.motion import release, slide, twist
from workbench.core.press.press import Press
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.stages.mesh import MeshInputs, mesh
from workbench.proof.specimens import finger_solid
from workbench.proof.validation.contact.presses import tip_target
from workbench.proof.validation.contact.trials import rim
from workbench.proof.validation.geometry.meshes import default_solid

FAMILIES = ("finger", "trunk", "paw")
WEDGE = "wedge"
"""A roof that presses with its ridge: no kind of object lies on an edge."""
OBJECTS = (
    IndenterKind("sphere").value,
    IndenterKind("cylinder_end").value,
    IndenterKind("cylinder_side").value,
    IndenterKind("cube").value,
    IndenterKind("cone").value,
    IndenterKind("triangle").value,
    WEDGE,
    IndenterKind("torus").value,
)
PLACES = 4
POLAR_DEG = (0.0, 30.0, 60.0, 90.0)
"""Places on the finger: angle of its tip from the axis; 90 degrees is where the cylinder ends."""
SIZE_MM = 6.0
DEPTH_MM, FRAMES = 1.0, 10
SHEAR_MM = 0.5
TWIST_DEG = 10.0
RIM_MM = 6.0
"""Least distance of a place from the rim of the skin: half an object's diagonal and 1 mm."""
MOST_TRIED = 200
"""Vertices tried for a place before its family is given up."""


@dataclass(frozen=True, kw_only=True, slots=True)
class MatrixCase:
    """One path."""

    family: str
    thing: str
    """One of `OBJECTS`."""
    place: int
    """From 0."""
    hex_mm: float = FemSettings().hex_mm

    @property
    def name(self) -> str:
        """Key of the case in a record."""
        draft = "" if self.hex_mm == FemSettings().hex_mm else f", {self.hex_mm:g} mm"
        return f"{self.family}, {self.thing}, place {self.place + 1}{draft}"

    @property
    def settings(self) -> FemSettings:
        """The default ones, on the mesh of this case."""
        return FemSettings(hex_mm=self.hex_mm, error=False)


def every_case(hex_mm: float = FemSettings().hex_mm) -> list[MatrixCase]:
    """All 96 of them, family by family."""
    return [
        MatrixCase(family=family, thing=thing, place=place, hex_mm=hex_mm)
        for family, place, thing in itertools.product(FAMILIES, range(PLACES), OBJECTS)
    ]


def object_of(thing: str) -> Indenter:
    """The object of a name."""
    if thing != WEDGE:
        return Indenter(kind=IndenterKind(thing), size_mm=SIZE_MM)
    return Indenter(
        kind=IndenterKind("mesh"),
        size_mm=SIZE_MM,
        mesh=_roof(),
        mesh_rounding_mm=DEFAULT_EDGE_RADIUS_MM,
    )


@functools.cache
def _roof() -> IndenterMesh:
    """A prism along Y whose ridge of 90 degrees points down, 6 mm wide and long, 3 mm high."""
    half, low = 0.5 * SIZE_MM, -0.25 * SIZE_MM
    ends = [(x, y, z) for y in (-half, half) for x, z in ((0.0, low), (half, -low), (-half, -low))]
    faces = [
        (0, 1, 2),
        (3, 5, 4),
        (0, 3, 4),
        (0, 4, 1),
        (0, 2, 5),
        (0, 5, 3),
        (1, 4, 5),
        (1, 5, 2),
    ]
    return IndenterMesh(points_mm=np.array(ends), faces=np.array(faces, dtype=np.int32))


@functools.cache
def membrane(family: str, hex_mm: float) -> MembraneMesh:
    """The default shape of a family, in hexahedra where it has some.

    Raises:
        WorkbenchError: If it cannot be built.
    """
    solid = finger_solid() if family == "finger" else default_solid(family)
    return mesh(
        MeshInputs(solid=solid, meshing=Meshing(hex_mm=hex_mm), paired=True), monitor=silent
    )


def body_digest(family: str) -> str:
    """Of the default shape and layers of a family: what a record of it belongs to."""
    from designs.family import resolve_shape
    from workbench.core.design.design import Layers

    return digest([family, resolve_shape(family, {}), Layers()])


def press_of(case: MatrixCase) -> Press:
    """The path of a case.

    Raises:
        WorkbenchError: If the family has no place for it.
    """
    back = slide(-SHEAR_MM, SHEAR_MM, frames=7)
    turning = () if case.family == "finger" else (twist(TWIST_DEG, frames=5),)
    return Press(
        target_mm=places_of(case.family, case.hex_mm)[case.place],
        depth_mm=DEPTH_MM,
        frames=FRAMES,
        strokes=(slide(SHEAR_MM, 0.0, frames=5), back, *turning, release(frames=10)),
    )


@functools.cache
def places_of(family: str, hex_mm: float) -> tuple[tuple[float, float, float], ...]:
    """Four places of the skin [mm] that a cube can press, as far apart as quarters of the skin.

    Beyond the family's own target vertices are tried in the order of their distance from it.

    Raises:
        WorkbenchError: If there are none.
    """
    if family == "finger":
        return tuple(tip_target(polar_deg, 0.0) for polar_deg in POLAR_DEG)
    skin = membrane(family, hex_mm)
    ordered = _inside(family, skin)
    starts = [len(ordered) * quarter // PLACES for quarter in range(PLACES)]
    return tuple(_reachable(skin, ordered[start:], family) for start in starts)


def _inside(family: str, skin: MembraneMesh) -> np.ndarray:
    """Vertices away from the rim, by their distance from the family's target, shape (V, 3)."""
    from designs.family import family as find_family
    from designs.family import resolve_shape
    from workbench.core.design.design import Layers

    target_mm = np.array(find_family(family).target(resolve_shape(family, {}), Layers()))
    points_mm = skin.outer.points_mm
    rim_mm = points_mm[rim(skin.outer)]
    away = np.array([np.linalg.norm(rim_mm - p, axis=1).min(initial=99.0) for p in points_mm])
    points_mm = points_mm[away > RIM_MM]
    return points_mm[np.argsort(np.linalg.norm(points_mm - target_mm, axis=1), kind="stable")]


def _reachable(skin: MembraneMesh, ordered: np.ndarray, family: str) -> tuple[float, float, float]:
    """The first of some vertices at which the widest object meets the skin and no support.

    Raises:
        MeshingError: If there is none.
    """
    from sim.contact.readout.verdict import check_depth
    from sim.contact.region.backing import support_points_mm
    from sim.contact.region.placing import place_object

    cube = object_of(IndenterKind("cube"))
    for x, y, z in ordered[:: max(1, len(ordered) // MOST_TRIED)].tolist():
        press = Press(target_mm=(x, y, z), depth_mm=DEPTH_MM, shear_mm=(SHEAR_MM, SHEAR_MM))
        try:
            approach = place_object(skin.outer, cube, press, grid_mm=0.25)
            check_depth(support_points_mm(skin), approach)
        except WorkbenchError:
            continue
        return x, y, z
    raise MeshingError(f"a cube reaches no place of the {family}", hint="choose another family")


def material() -> Elastomer:
    """The elastomer of all cases."""
    return Elastomer()
