"""From a design to a pack: what is missing is computed and kept in the project."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.condensed.surface import surface_of
from workbench.core.base.packages import naming_packages
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.core.result.condensed import CondensedSkin, Hardening
from workbench.live.live_press import live_design, small
from workbench.pipeline.devices import open_device
from workbench.pipeline.store import Store
from workbench.planning.plan import InlineRunner, StageMonitor, evaluate, plan
from workbench.planning.tile_columns import tile_finder
from workbench.project.design_toml import design_to_toml
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.sensor.pack import Pack

if TYPE_CHECKING:
    from sim.condensed.growing import GrowingContact
    from sim.optics.studio.render import Studio

LIGHT = ("mesh", "bake", "table")
WHOLE = (*LIGHT, "condensed", "hardening")


def make_pack(
    source: str | SensorDesign,
    project: Project | Path | str | None = None,
    *,
    width_px: int | None = None,
    monitor: StageMonitor | None = None,
) -> Pack:
    """A pack of a design.

    Args:
        source: A design, or its name or file.
        project: Where results are kept; `.workbench`, or `$WORKBENCH_PROJECT`, by default.
        width_px: Width of the images, the camera's own where left out or wider.
        monitor: Told stage, fraction and note.

    Raises:
        DesignError: If there is no such design.
        MeshingError: If its skin cannot be condensed.
    """
    given, design, store = _begun(source, project, width_px)
    found = _evaluated(design, store, WHOLE, monitor)
    return _packed(given, design, found, (found["condensed"], found["hardening"]))


def make_growing(
    source: str | SensorDesign,
    project: Project | Path | str | None = None,
    *,
    width_px: int | None = None,
    monitor: StageMonitor | None = None,
) -> tuple[Pack, GrowingContact]:
    """A pack whose skin is bare, and contact that finds its compliance where it is touched.

    Forces follow the general law unless the design's own presses are in the project. Arguments and
    errors are those of `make_pack`.
    """
    given, design, store = _begun(source, project, width_px)
    calls = plan(design, PressCase())
    skin, law = calls["condensed"].inputs, calls["hardening"]
    found = _evaluated(design, store, (*LIGHT, skin.mesh.stage), monitor)
    from sim.condensed.general_law import general_law
    from sim.condensed.growing import GrowingContact

    fast = GrowingContact(
        found[skin.mesh.stage],
        skin.wall_mm,
        store.load(law.stage, law.key) if store.has(law.stage, law.key) else general_law(),
        design.material,
        tile_finder(store, skin),
    )
    return _packed(given, design, found, (fast.skin, fast.law)), fast


def _begun(
    source: str | SensorDesign, project: Project | Path | str | None, width_px: int | None
) -> tuple[SensorDesign, SensorDesign, Store]:
    """The design as given, as it is rendered frame by frame, and where results are kept."""
    where = project if isinstance(project, Project) else Project(project)
    given = source if isinstance(source, SensorDesign) else load_design(source, project=where)
    return given, packed_design(given, width_px), where.store


def packed_design(design: SensorDesign, width_px: int | None = None) -> SensorDesign:
    """A design as a pack renders it: light as it was baked, images of this width."""
    design = live_design(design)
    if width_px is None:
        return design
    return dataclasses.replace(design, optics=small(design.optics, width_px))


def _evaluated(
    design: SensorDesign, store: Store, wanted: tuple[str, ...], monitor: StageMonitor | None
) -> dict[str, Any]:
    """Results of stages by name, made where the store lacks them."""
    calls = plan(design, PressCase())
    with naming_packages():
        for _ in evaluate(design, PressCase(), InlineRunner(store), wanted=wanted, monitor=monitor):
            pass
    open_device()
    return {name: store.load(name, calls[name].key) for name in wanted if name in calls}


def _packed(
    given: SensorDesign,
    design: SensorDesign,
    found: dict[str, Any],
    contact: tuple[CondensedSkin, Hardening],
) -> Pack:
    from sim.optics.studio.render import Studio

    mesh, (skin, law) = found["mesh"], contact
    studio = Studio(mesh, found["bake"], design.optics, table=found.get("table"))
    return Pack(
        name=design.name,
        design_toml=design_to_toml(given),
        skin=skin,
        law=law,
        material=design.material,
        surface=surface_of(skin.points_mm, skin.normals, mesh.seen.points_mm, mesh.seen.normals),
        images=studio.imager.state(),
        rest_depth_mm=rest_depth_mm(studio),
        left_out=left_out(given),
    )


def rest_depth_mm(studio: Studio) -> np.ndarray:
    """Depth of the untouched skin along the camera's axis, (H, W), float32; NaN beside it."""
    nothing = np.zeros((0, studio.imager.raster.vertices, 3), dtype=np.float32)
    return studio.shoot(nothing).depth_z_mm[0]


def left_out(design: SensorDesign) -> tuple[str, ...]:
    """What the camera of a design does that images of a pack do not show."""
    camera = design.optics.camera
    found = []
    if camera.sensor.noise:
        found.append("noise of the image sensor")
    if camera.aperture_mm > 0.0:
        found.append("blur out of focus")
    if design.optics.cameras:
        found.append("cameras after the first")
    if live_design(design) is not design:
        found.append("photons of each frame: light is looked up as it was baked")
    return tuple(found)
