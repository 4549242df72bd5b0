"""The sensors that Mitsuba showed once: bodies, lights and coatings of the record, stated in full.

A finger and a flat pad as their families build them, with LEDs in the cavity or in the clear shell.
The coating is the default one, flakes of aluminium, and once a matte one. The LEDs are wider than
those of the presets, because a path tracer finds a light behind a wall only by chance. Nothing is
taken from presets, which may change; families and the mesher may, and then the record no longer
belongs to the scene: it keeps a digest of what is stated here, and the size and the moments of the
surfaces, which a body that was built elsewhere has to a millionth.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from workbench.core.base.digest import digest
from workbench.core.base.monitor import silent
from workbench.core.design.camera import Camera
from workbench.core.design.design import Layers, Meshing
from workbench.core.design.lighting import Baking, LedMount, LedRing
from workbench.core.design.optics import Coating, Optics
from workbench.core.result.results import MembraneMesh, Skin

if TYPE_CHECKING:
    from workbench.pipeline.stages.build import BuildInputs

WIDTH_PX, HEIGHT_PX = 64, 48
CELL_PX = 8
"""Side of the squares whose mean is compared: 48 in an image, of three colours each."""
INK = Coating(albedo=0.1, specular=0.4, roughness=0.2)
MATTE = Coating(albedo=0.6, specular=0.0)
IN_CAVITY = LedRing(count=9, radius_mm=8.5, height_mm=0.5, phase_deg=50.0, size_mm=5.0)
IN_SHELL = LedRing(count=9, radius_mm=11.5, height_mm=0.5, size_mm=2.4, mount=LedMount.SHELL)
THICK_MM = 3.0
"""Of the clear shell that holds wide LEDs."""
UNDER_PLATE = LedRing(count=12, radius_mm=6.0, height_mm=13.0, tilt_deg=-60.0, size_mm=3.0)
PAD = {"width_mm": 20.0, "depth_mm": 20.0, "corner_mm": 0.5, "dome_mm": 0.0, "standoff_mm": 18.0}
DENT = {"at_mm": (0.0, 8.0, 39.0), "depth_mm": 1.0, "radius_mm": 4.0}
"""On the finger's round end."""


@dataclass(frozen=True, kw_only=True, slots=True)
class RecordedScene:
    """One sensor under one light."""

    name: str
    family: str
    shape: dict[str, float] = field(default_factory=dict)
    elastomer_mm: float = 2.0
    support_mm: float = 1.0
    fov_x_deg: float = 100.0
    ring: LedRing = IN_CAVITY
    coating: Coating = INK
    dented: bool = False

    @property
    def optics(self) -> Optics:
        """Camera, lights and coating; the light model is left at its default."""
        camera = Camera(width_px=WIDTH_PX, height_px=HEIGHT_PX, fov_x_deg=self.fov_x_deg)
        return Optics(camera=camera, ring=self.ring, coating=self.coating, refractive_index=1.41)


SCENES = (
    RecordedScene(name="finger, LEDs in the cavity", family="finger"),
    RecordedScene(
        name="finger, LEDs in the shell", family="finger", support_mm=THICK_MM, ring=IN_SHELL
    ),
    RecordedScene(name="dented finger, LEDs in the cavity", family="finger", dented=True),
    RecordedScene(name="matte finger, LEDs in the cavity", family="finger", coating=MATTE),
    RecordedScene(
        name="pad, LEDs under the plate",
        family="pad",
        shape=PAD,
        elastomer_mm=4.0,
        fov_x_deg=62.0,
        ring=UNDER_PLATE,
    ),
)


_BODIES: dict[str, MembraneMesh] = {}
"""By the digest of what they are built from: scenes share them."""


def _build_inputs(scene: RecordedScene) -> BuildInputs:
    from designs.family import resolve_shape
    from workbench.pipeline.stages.build import BuildInputs

    shape = resolve_shape(scene.family, scene.shape)
    layers = Layers(support_mm=scene.support_mm, elastomer_mm=scene.elastomer_mm)
    return BuildInputs(family=scene.family, shape=shape, layers=layers)


def body_of(scene: RecordedScene) -> MembraneMesh:
    """The body at rest, built by the workbench's own stages at edges of 0.4 mm."""
    inputs = _build_inputs(scene)
    if digest(inputs) not in _BODIES:
        from workbench.pipeline.stages.build import build
        from workbench.pipeline.stages.mesh import MeshInputs, mesh

        solid = build(inputs, monitor=silent)
        _BODIES[digest(inputs)] = mesh(MeshInputs(solid=solid, meshing=Meshing()), monitor=silent)
    return _BODIES[digest(inputs)]


def displacement_mm(scene: RecordedScene) -> np.ndarray:
    """Of the seen skin's vertices [mm], shape (V, 3), float32."""
    from sim.optics.proof.specimen import dent

    skin = body_of(scene).seen
    return dent(skin, **DENT) if scene.dented else np.zeros(skin.points_mm.shape, dtype=np.float32)


def scene_digest(scene: RecordedScene) -> str:
    """Of all that is stated: body, camera, lights, coating, dent."""
    optics = dataclasses.replace(scene.optics, baking=Baking())
    stated = (_build_inputs(scene), optics.camera, optics.ring, optics.transport)
    return digest((*stated, DENT if scene.dented else None))


def moments(scene: RecordedScene) -> np.ndarray:
    """Of skin and wall: faces, area [mm2], mean place [mm], mean square of places [mm2]; (2, 8)."""
    mesh, moved = body_of(scene), displacement_mm(scene)
    skin = dataclasses.replace(mesh.seen, points_mm=mesh.seen.points_mm + moved)
    return np.stack([_moments(skin), _moments(mesh.cavity)])


def _moments(skin: Skin) -> np.ndarray:
    from geometry.surface.surface import face_areas

    area = face_areas(skin.points_mm, skin.faces)
    middle = skin.points_mm[skin.faces].mean(axis=1).astype(np.float64)
    first, second = (np.average(middle**power, axis=0, weights=area) for power in (1, 2))
    return np.array([len(area), area.sum(), *first, *second], dtype=np.float64)


def cells(image: np.ndarray) -> np.ndarray:
    """Means of squares of pixels: (..., H, W, 3) to (..., H / 8, W / 8, 3)."""
    head, rows, columns = image.shape[:-3], HEIGHT_PX // CELL_PX, WIDTH_PX // CELL_PX
    blocks = image.reshape(*head, rows, CELL_PX, columns, CELL_PX, 3)
    return blocks.mean(axis=(-4, -2), dtype=np.float64)
