"""The sensors, lights and dents on which light models are compared with traced photons.

Finger, trunk and paw as the families build them, at 0.4 mm. The finger has its camera on the axis;
trunk and paw have one beside the axis and tilted. LEDs sit in the cavity or in the shell, three
neighbours in each of red, green and blue; in the shell of a body that is not round they are placed
in the middle of the wall at their azimuth, one by one. The skin is matte in all six, and in four
more it has the coating of a new design, whose lobe is narrow. The images are 320 x 240.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from dataclasses import dataclass

import numpy as np

from workbench.core.base.digest import digest
from workbench.core.base.frames import quaternion
from workbench.core.base.monitor import silent
from workbench.core.design.camera import Camera
from workbench.core.design.design import Meshing, SensorDesign
from workbench.core.design.lighting import Baking, Lamp, LampKind, LedMount, LedRing, LightModel
from workbench.core.design.optics import Coating, Optics
from workbench.core.result.results import MembraneMesh, Skin
from workbench.pipeline.stages.build import BuildInputs, build
from workbench.pipeline.stages.mesh import MeshInputs, mesh

WIDTH_PX, HEIGHT_PX = 320, 240
COLOURS = ("#ff0000", "#00ff00", "#0000ff")
LED_HEIGHT_MM = 0.6
SIZE_MM = {LedMount.CAVITY: 1.5, LedMount.SHELL: 0.6}
"""Discs of the LEDs; in the shell they must fit into its 1 mm."""
CAVITY_SHARE = 0.75
"""Radius of cavity LEDs over that of the cavity, as on the finger."""
MATTE = Coating(albedo=0.6, specular=0.04, roughness=0.35)
"""It scatters far more than the coating of a new design."""
INK = Coating(albedo=0.1, specular=0.4, roughness=0.2)
"""The coating of a new design when the references were recorded: flakes in ink, most of whose light
goes into a lobe."""
AZIMUTHS_DEG = tuple(base + turn for base in (90, 210, 330) for turn in (-40, 0, 40))


@dataclass(frozen=True, kw_only=True, slots=True)
class LightScene:
    """One sensor under one light."""

    body: str
    """`finger`, `trunk` or `paw`."""
    mount: LedMount
    coating: Coating = MATTE

    @property
    def name(self) -> str:
        """For rows and files, for example `finger shell` or `finger shell ink`."""
        return f"{self.body} {self.mount.value}{' ink' if self.coating == INK else ''}"


SCENES = (
    *(
        LightScene(body=body, mount=mount)
        for body in ("finger", "trunk", "paw")
        for mount in LedMount
    ),
    *(LightScene(body="finger", mount=mount, coating=INK) for mount in LedMount),
    LightScene(body="trunk", mount=LedMount.SHELL, coating=INK),
    LightScene(body="paw", mount=LedMount.CAVITY, coating=INK),
)


@functools.cache
def mesh_of(body: str) -> MembraneMesh:
    """The body at 0.4 mm, built by the workbench's own stages."""
    solid = build(_build_inputs(body), monitor=silent)
    return mesh(MeshInputs(solid=solid, meshing=Meshing()), monitor=silent)


def body_digest(body: str) -> str:
    """Of the family's parameters and layers: what a recorded image of the body belongs to."""
    return digest(_build_inputs(body))


def _build_inputs(body: str) -> BuildInputs:
    from designs.family import resolve_shape
    from workbench.project.named_designs import load_design

    design = SensorDesign() if body == "finger" else load_design(body)
    shape = resolve_shape(design.family, design.shape)
    return BuildInputs(family=design.family, shape=shape, layers=design.layers)


def optics_of(scene: LightScene, model: LightModel, *, seed: int = 1) -> Optics:
    """Camera and lights of a scene, under a light model."""
    return Optics(
        camera=camera_of(scene.body),
        ring=LedRing(count=0),
        lamps=lamps_of(mesh_of(scene.body), scene.mount),
        coating=scene.coating,
        light_model=model,
        baking=Baking(seed=seed),
    )


def camera_of(body: str) -> Camera:
    """On the axis of the finger; beside it and tilted in the others."""
    if body == "finger":
        return Camera(width_px=WIDTH_PX, height_px=HEIGHT_PX, position_mm=(0.0, 0.0, 0.3))
    return Camera(
        width_px=WIDTH_PX,
        height_px=HEIGHT_PX,
        fov_x_deg=110.0,
        position_mm=(3.0, -2.0, 0.6),
        wxyz=tilted(np.array([0.12, 0.16, 1.0])),
    )


def tilted(forward: np.ndarray) -> tuple[float, float, float, float]:
    """Quaternion of a camera that looks along a vector, its rows along the sensor's Y."""
    z = forward / np.linalg.norm(forward)
    x = np.cross([0.0, 1.0, 0.0], z)
    x /= np.linalg.norm(x)
    w, i, j, k = quaternion(np.column_stack([x, np.cross(z, x), z]))
    return float(w), float(i), float(j), float(k)


def lamps_of(mesh: MembraneMesh, mount: LedMount) -> tuple[Lamp, ...]:
    """Nine LEDs, three of each colour, in the cavity or in the middle of the shell."""
    found = []
    for number, azimuth_deg in enumerate(AZIMUTHS_DEG):
        angle = math.radians(azimuth_deg)
        outward = np.array([math.cos(angle), math.sin(angle), 0.0])
        cavity_mm, inner_mm = (_radius_mm(skin, outward) for skin in (mesh.cavity, mesh.inner))
        in_shell = mount is LedMount.SHELL
        radius_mm = (cavity_mm + inner_mm) / 2.0 if in_shell else CAVITY_SHARE * cavity_mm
        x, y, _ = radius_mm * outward
        found.append(
            Lamp(
                kind=LampKind.POINT,
                position_mm=(float(x), float(y), LED_HEIGHT_MM),
                colour=COLOURS[number // 3],
                size_mm=SIZE_MM[mount],
                mount=mount,
            )
        )
    return tuple(found)


def _radius_mm(skin: Skin, outward: np.ndarray) -> float:
    from geometry.surface.rays import RayCaster

    origin = np.array([[0.0, 0.0, LED_HEIGHT_MM]])
    return float(RayCaster(skin.points_mm, skin.faces).hits(origin, outward[None])[0][0])


def skins_of(mesh: MembraneMesh) -> MembraneMesh:
    """The mesh without its hexahedra: all that light needs."""
    return dataclasses.replace(mesh, hexes=None)
