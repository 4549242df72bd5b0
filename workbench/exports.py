"""`workbench export`: bodies, mould, meshes and the design file, without a press."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from workbench.core.design import SensorDesign
from workbench.core.errors import DeviceError
from workbench.core.optics import Transport
from workbench.core.results import MembraneMesh, VolumeMesh
from workbench.design_toml import design_files, design_to_toml
from workbench.folder import RUN_FILES, prepare, remove_stale
from workbench.outputs import write_package
from workbench.pipeline import InlineRunner, PressCase, StageMonitor, evaluate, plan, results
from workbench.store import Store
from workbench.vtkfiles import write_vtk
from workbench.whole_files import write_atomically

OPTIONAL = ("mesh.npz", "tets.npz", "exploded.png", "bodies/*", "mitsuba/*")
"""Files that not every export writes."""
MADE = ("membrane.stl", "support.stl", "base.stl", "mesh.npz", "tets.npz", "exploded.png")
"""What is made of a design; `design.toml` and `bodies/` may be the very one that is asked for."""
STAGES = ("mesh", "mould", "housing", "recipe", "package")


def clear_exports(out: Path, *, but: Path) -> None:
    """Make the folder, without what an earlier run or export made there.

    Args:
        but: The design or body that is asked for, which stays.

    Raises:
        DesignError: If a file has that name.
        StoreError: If the folder cannot be made or written.
    """
    made = (*RUN_FILES, *MADE, "mitsuba/*")
    prepare(out, clear=[name for name in made if (out / name).resolve() != but.resolve()])


def export_design(
    design: SensorDesign,
    out: Path,
    store: Store,
    monitor: StageMonitor,
    *,
    tets: bool = False,
    mitsuba: bool = False,
) -> Iterator[Path]:
    """Write the files of a design and yield their paths.

    `design.toml` (with the files of a body of its own under `bodies/`), `membrane.stl`,
    `support.stl`, `base.stl`, `mesh.npz` (nodes, hexahedra, labels), `mesh.vtu`, `membrane.vtp`,
    `exploded.png` (where the machine can render) and everything of the workshop: `moulds/`,
    `parts/`, `all_parts.3mf`, `build_sheet.html`, `recipe.json`, `bom.csv`. Such files of an
    earlier export that this one does not replace go.

    Args:
        tets: Also write `tets.npz`: nodes, tetrahedra, labels; takes about a minute.
        mitsuba: Also write the sensor at rest as a scene of Mitsuba 3, `mitsuba/scene.xml`.

    Raises:
        DesignError: If Mitsuba has no like of the camera or the lights, or they cannot be where
            they are.
        WorkbenchError: If a stage fails or the folder cannot be written.
    """
    from geometry.export import stl_bytes

    if mitsuba:
        _check_scene(design)
    prepare(out, clear=())
    runner = InlineRunner(store)
    wanted = (*STAGES, "tets") if tets else STAGES
    if mitsuba:
        for _ in evaluate(design, PressCase(), runner, wanted=("mesh",), monitor=monitor):
            pass
        mesh = results(store, plan(design, PressCase()), ("mesh",))["mesh"]
        _check_places(design, mesh)
    for _ in evaluate(design, PressCase(), runner, wanted=wanted, monitor=monitor):
        pass
    # A machine without an off-screen renderer still gets all files but the picture.
    with contextlib.suppress(DeviceError):
        for _ in evaluate(design, PressCase(), runner, wanted=("picture",), monitor=monitor):
            pass
    found = results(store, plan(design, PressCase()), ("build", *wanted, "picture"))
    solid, hexes = found["build"], found["mesh"].hexes
    files = {"design.toml": design_to_toml(design).encode()}
    for name in ("membrane", "base"):
        surface = getattr(solid, name)
        files[f"{name}.stl"] = stl_bytes(surface.points_mm, surface.faces)
    # One name, one body: where the skin cuts into the support, the part to print is what there is.
    files["support.stl"] = found["package"].files["parts/support.stl"].tobytes()
    if hexes is not None:
        files["mesh.npz"] = _volume_bytes(hexes)
    if tets:
        files["tets.npz"] = _volume_bytes(found["tets"])
    if "picture" in found:
        files["exploded.png"] = found["picture"].png.tobytes()
    files |= design_files(design)
    remove_stale(out, OPTIONAL, keep=files)
    for name, content in files.items():
        write_atomically(out / name, content)
        yield out / name
    for name in write_vtk(out, solid, found["mesh"], tets=found.get("tets")):
        yield out / name
    write_package(out, found["package"])
    for name in found["package"].files:
        yield out / name
    if mitsuba:
        yield from _write_scene(out / "mitsuba", design, found["mesh"])


def scene_notice(design: SensorDesign) -> str:
    """What of the design's optics a scene of Mitsuba leaves out, as a sentence, or \"\"."""
    optics = design.optics
    held = {
        "markers": optics.markers.visible,
        "the photographed background": optics.background is not None,
        "further cameras": bool(optics.cameras),
    }
    left_out = [name for name, there in held.items() if there]
    return f"the scene of Mitsuba leaves out {' and '.join(left_out)}" if left_out else ""


def _check_scene(design: SensorDesign) -> None:
    from sim.optics.lights import place_leds
    from sim.optics.mitsuba_scene import check_scene

    optics = design.optics
    check_scene(place_leds(optics.ring, optics.lamps), optics.camera)


def _check_places(design: SensorDesign, mesh: MembraneMesh) -> None:
    from sim.optics.places import check_camera, check_lights

    check_lights(mesh, design.optics.ring, design.optics.lamps)
    check_camera(mesh, design.optics.camera)


def _write_scene(folder: Path, design: SensorDesign, mesh: MembraneMesh) -> Iterator[Path]:
    from sim.optics.lights import place_leds
    from sim.optics.mitsuba_scene import scene_files

    optics = design.optics
    transport = Transport(
        coating=optics.coating, refractive_index=optics.refractive_index, baking=optics.baking
    )
    leds = place_leds(optics.ring, optics.lamps)
    for name, content in scene_files(mesh, leds, optics.camera, transport).items():
        write_atomically(folder / name, content)
        yield folder / name


def _volume_bytes(mesh: VolumeMesh) -> bytes:
    """A compressed NumPy archive of nodes, cells, labels and numbers."""
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        points_mm=mesh.points_mm,
        cells=mesh.cells,
        labels=mesh.labels,
        numbers=mesh.numbers,
    )
    return buffer.getvalue()
