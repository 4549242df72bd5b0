"""The stages: name, version, lane, narrow inputs, function; all that is stored comes from them.

A stage is a pure function of dataclasses and a `Monitor`. What it reads is what its key holds:
pass the part of the design a stage needs, never the whole, and a camera move cannot re-run
contact. Bump `version` when the output of a stage changes.
"""

from __future__ import annotations

from typing import Any

from workbench.calls import Call, Outcome, Ref, Stage
from workbench.core.camera import Camera
from workbench.core.design import Elastomer, Layers, Meshing, MouldOptions
from workbench.core.errors import SolveError, Stopped, StoreError
from workbench.core.fabrication import HousingSet, MouldSet, Recipe, SheetHead
from workbench.core.fem import FemSettings
from workbench.core.force_field import ForceField
from workbench.core.imported import ImportedBody, Pick, ReadBody
from workbench.core.indenter import Indenter
from workbench.core.lighting import LedRing
from workbench.core.making import Casting, Housing, Printer
from workbench.core.monitor import Monitor, part, silent
from workbench.core.press import ContactSettings, Press
from workbench.core.results import (
    Bundle,
    MaterialPoints,
    MembraneMesh,
    Picture,
    QualityReport,
    Solid,
    VolumeMesh,
)
from workbench.core.sampled import SampledDistance
from workbench.core.sensing import Contact
from workbench.force_calls import fem_parts, learned_parts, shown_parts
from workbench.learned import learned
from workbench.light_calls import shoot_parts
from workbench.optical_stages import bake, maps, photons, shoot, start_device, table
from workbench.store import Store, timed

PARTIAL = "press_partial"
"""Where the store keeps the settled frames of a press that failed, by the key of that press."""
PARTS_SHARE = 0.95
"""Share of the progress of a divided stage that its parts take."""


def run(store: Store, call: Call, monitor: Monitor = silent) -> Outcome:
    """Compute a call unless its result is stored, and store it.

    Raises:
        WorkbenchError: Whatever the stage raises. The frames that a press settled before it
            failed are then stored as `PARTIAL` under the same key, nothing else is.
    """
    stage = STAGES[call.stage]
    key = call.key
    if store.has(stage.name, key):
        return Outcome(stage=stage.name, key=key, cached=True, seconds=0.0)
    parts = stage.parts(store, call.inputs) if stage.parts else ()
    spent_s = 0.0
    for number, piece in enumerate(parts):
        span = (PARTS_SHARE * number / len(parts), PARTS_SHARE * (number + 1) / len(parts))
        spent_s += run(store, piece, part(monitor, *span)).seconds
    inputs = [store.load(i.stage, i.key) if isinstance(i, Ref) else i for i in call.inputs]
    inputs += [store.load(piece.stage, piece.key) for piece in parts]
    rest = part(monitor, PARTS_SHARE, 1.0) if parts else monitor
    try:
        value, seconds = timed(stage.function, *inputs, monitor=rest)
    except (SolveError, Stopped) as error:
        _keep_partial(store, stage, key, error)
        raise
    store.save(stage.name, key, value, seconds=spent_s + seconds, version=stage.version)
    return Outcome(stage=stage.name, key=key, cached=False, seconds=spent_s + seconds)


def _keep_partial(store: Store, stage: Stage, key: str, error: SolveError | Stopped) -> None:
    """Store what settled, and leave its key in the error instead, which then is small to send."""
    if error.partial is None:
        return
    spent_s = float(error.partial.frame_seconds.sum())
    try:
        store.save(PARTIAL, key, error.partial, seconds=spent_s, version=stage.version)
    except StoreError as unsaved:
        # Why the press failed is what the designer must read first.
        error.hint = f"{error.hint}; what settled is lost: {unsaved.message}"
    else:
        error.kept = key
    finally:
        error.partial = None


def intake(body: ImportedBody, *, monitor: Monitor) -> ReadBody:
    """The designer's file to closed surfaces, repaired where that is safe."""
    from geometry.intake import read_body

    return read_body(body, monitor)


def build(
    family: str,
    shape: Any,
    layers: Layers,
    body: ReadBody | None = None,
    picks: tuple[Pick, ...] = (),
    *,
    monitor: Monitor,
) -> Solid:
    """Parameters, or a body that was read, to a labelled body."""
    if body is not None:
        from geometry.imported import build_imported

        return build_imported(body, shape, layers, picks, monitor)
    from designs.family import family as find_family
    from workbench.building import build_solid

    return build_solid(find_family(family), shape, layers)


def mesh(solid: Solid, meshing: Meshing, *, monitor: Monitor) -> MembraneMesh:
    """Body to hexahedra and uniform skins."""
    from geometry.hexmesh import mesh_membrane

    return mesh_membrane(solid, meshing, monitor=monitor)


def tets(solid: Solid, edge_mm: float, *, monitor: Monitor) -> VolumeMesh:
    """Body to tetrahedra."""
    from geometry.tets import tetrahedra

    return tetrahedra(solid, edge_mm, monitor=monitor)


def quality(solid: Solid, mesh: MembraneMesh, *, monitor: Monitor) -> QualityReport:
    """How good the meshes of the body are."""
    from geometry.quality import quality_report

    return quality_report(mesh, solid.volume_mm3)


def lattice(solid: Solid, grid_mm: float, *, monitor: Monitor) -> MaterialPoints:
    """Body to material points on a reference lattice."""
    from geometry.lattice import material_points

    return material_points(solid.membrane, grid_mm, monitor=monitor)


def object_distance(indenter: Indenter, grid_mm: float, *, monitor: Monitor) -> SampledDistance:
    """Signed distance of an object made of triangles or with a texture: up to a minute."""
    from workbench.devices import open_device

    monitor(0.0, "sampling the object")
    open_device()
    from sim.contact.objects.sampling import sample_indenter

    return sample_indenter(indenter, grid_mm=grid_mm)


def press(
    mesh: MembraneMesh,
    points: MaterialPoints,
    material: Elastomer,
    indenter: Indenter,
    path: Press,
    settings: ContactSettings,
    sampled: SampledDistance | None = None,
    *,
    monitor: Monitor,
) -> Contact:
    """Quasi-static contact along a press path; `sampled` is the object's distance, if known."""
    start_device(monitor)
    from sim.contact.solver import press_membrane

    return press_membrane(
        mesh, points, material, indenter, path, settings, sampled=sampled, monitor=monitor
    )


def fem(
    solid: Solid,
    material: Elastomer,
    indenter: Indenter,
    path: Press,
    settings: FemSettings,
    mesh: MembraneMesh,
    sampled: SampledDistance | None = None,
    *,
    monitor: Monitor,
) -> ForceField:
    """The same press by finite elements, on a mesh of their own: minutes, and the truth."""
    start_device(monitor)
    from sim.fem.press import solve_press
    from workbench.devices import solver_device

    return solve_press(
        mesh,
        material,
        indenter,
        path,
        settings,
        sampled=sampled,
        device=solver_device(),
        monitor=monitor,
    )


def forces(
    mesh: MembraneMesh,
    solid: Solid,
    hex_mm: float,
    found: ForceField,
    source: MembraneMesh,
    *,
    monitor: Monitor,
) -> ForceField:
    """The result of finite elements, found on the mesh `source`, on the skin of the design."""
    from sim.forces.transfer import transferred

    return transferred(found, source, mesh)


def mould(solid: Solid, options: MouldOptions, *, monitor: Monitor) -> MouldSet:
    """Printable mould of the body."""
    from geometry.moulds import make_mould

    return make_mould(solid, options, monitor=monitor)


def housing(
    solid: Solid,
    options: Housing,
    ring: LedRing,
    camera_mm: tuple[float, float, float],
    camera_wxyz: tuple[float, float, float, float],
    printer: Printer,
    *,
    monitor: Monitor,
) -> HousingSet:
    """Rigid parts of the sensor; of camera and ring only what has a size or a place."""
    from geometry.housing import make_housing

    camera = Camera(position_mm=camera_mm, wxyz=camera_wxyz)
    return make_housing(solid, options, ring=ring, camera=camera, printer=printer, monitor=monitor)


def recipe(
    solid: Solid,
    moulds: MouldSet,
    housing: HousingSet,
    ring: LedRing,
    casting: Casting,
    young_MPa: float,
    density_g_cm3: float,
    backing_MPa: float,
    *,
    monitor: Monitor,
) -> Recipe:
    """What to weigh, pour, coat, solder and print."""
    from geometry.recipe import make_recipe

    return make_recipe(
        solid,
        moulds,
        housing,
        ring=ring,
        casting=casting,
        young_MPa=young_MPa,
        density_g_cm3=density_g_cm3,
        backing_MPa=backing_MPa,
    )


def picture(solid: Solid, moulds: MouldSet, housing: HousingSet, *, monitor: Monitor) -> Picture:
    """Mould and sensor drawn apart, for the report; a DeviceError where nothing can render."""
    from geometry.pictures import exploded_sensor

    return Picture(png=exploded_sensor(solid, moulds, housing))


def portrait(solid: Solid, *, monitor: Monitor) -> Picture:
    """The membrane at rest, small, for lists; a DeviceError where nothing can render."""
    from geometry.portraits import at_rest

    return Picture(png=at_rest(solid))


def portrait_pressed(mesh: MembraneMesh, contact: Contact, *, monitor: Monitor) -> Picture:
    """The skin in the last frame of a press, small, for lists; a DeviceError likewise."""
    from geometry.portraits import pressed

    return Picture(png=pressed(mesh.outer, contact.displacement_mm[-1], contact.normal))


def package(
    moulds: MouldSet,
    housing: HousingSet,
    recipe: Recipe,
    name: str,
    family: str,
    shrink_percent: float,
    draft_deg: float,
    *,
    monitor: Monitor,
) -> Bundle:
    """Every part as STL, STEP and 3MF, the assemblies, the build sheet and the parts list."""
    from geometry.export import package_files

    head = SheetHead(name=name, family=family, shrink_percent=shrink_percent, draft_deg=draft_deg)
    return package_files(moulds, housing, recipe, head, monitor=monitor)


STAGES = {
    stage.name: stage
    for stage in (
        Stage(name="intake", version=2, lane="cad", function=intake),
        Stage(name="build", version=3, lane="cad", function=build),
        Stage(name="mesh", version=2, lane="cad", function=mesh),
        Stage(name="quality", version=1, lane="cad", function=quality),
        Stage(name="tets", version=1, lane="cad", function=tets),
        Stage(name="lattice", version=2, lane="cad", function=lattice),
        Stage(name="bake", version=3, lane="sim", function=bake),
        Stage(name="table", version=2, lane="sim", function=table),
        Stage(name="object", version=1, lane="sim", function=object_distance),
        Stage(name="press", version=7, lane="sim", function=press),
        Stage(name="fem", version=2, lane="sim", function=fem, parts=fem_parts),
        Stage(name="forces", version=1, lane="sim", function=forces, parts=shown_parts),
        Stage(name="learned", version=1, lane="sim", function=learned, parts=learned_parts),
        Stage(name="photons", version=1, lane="sim", function=photons),
        Stage(name="shoot", version=4, lane="sim", function=shoot, parts=shoot_parts),
        Stage(name="maps", version=2, lane="sim", function=maps),
        Stage(name="mould", version=4, lane="cad", function=mould),
        Stage(name="housing", version=4, lane="cad", function=housing),
        Stage(name="recipe", version=3, lane="cad", function=recipe),
        Stage(name="package", version=5, lane="cad", function=package),
        Stage(name="picture", version=2, lane="cad", function=picture),
        Stage(name="portrait", version=1, lane="cad", function=portrait),
        Stage(name="portrait_pressed", version=1, lane="cad", function=portrait_pressed),
    )
}
