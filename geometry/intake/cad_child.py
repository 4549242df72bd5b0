"""Reads one CAD file in a process of its own, because a damaged file can kill the CAD kernel.

`python -m geometry.intake.cad_child FILE OUT SECONDS` reads the STEP file FILE and leaves in OUT,
an `.npz`, what `geometry.intake.cad_file` reads back: loose triangles, or the reason why there are
none. The process ends by itself after SECONDS of the processor, and with the process that started
it. Only OCP is imported: build123d would take three more seconds.
"""

# OCP has no type stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import contextlib
import json
import signal
import sys
from pathlib import Path
from typing import Any

import numpy as np

from geometry.body.solid import ANGLE_RAD, TOLERANCE_MM, loose_triangles

WAITS = 8.0
"""Times SECONDS that it may take on a machine that is busy with others, or waits for its disk."""
MOST_MEMORY = 8 << 30
"""A damaged number must not ask this machine for all its memory [bytes]."""
FINE_SHARE = 5e-5
"""Chord over the size of a body above 400 mm: coarser than `TOLERANCE_MM`, and refused later."""
SEW_MM = 0.01
"""Edges nearer than this are one when faces are sewn [mm]: ten times what CAD programs promise."""


def main(arguments: list[str]) -> int:
    """Entry point of the process."""
    source, out, seconds = Path(arguments[0]), Path(arguments[1]), float(arguments[2])
    _confine(seconds)
    try:
        found = _read(source)
    except Exception as error:
        # OCP's errors have no base of their own; whatever it was, the file could not be read.
        found = {"reason": str(error).strip() or type(error).__name__}
    with out.open("wb") as file:
        said = {name: value for name, value in found.items() if not isinstance(value, np.ndarray)}
        arrays: dict[str, Any] = {
            name: value for name, value in found.items() if isinstance(value, np.ndarray)
        }
        np.savez(file, said=json.dumps(said), **arrays)
    return 0


def _confine(seconds: float) -> None:
    """Limit time and memory, and follow the parent into death, as far as the system can."""
    import ctypes

    if not hasattr(signal, "setitimer"):
        # Windows has no such limits: `cad_file` looks at the clock.
        return
    import resource

    # The kernel may hold the interpreter for as long as it likes: only the system's signals end it.
    for alarm, timer, limit_s in (
        (signal.SIGPROF, signal.ITIMER_PROF, seconds),
        (signal.SIGALRM, signal.ITIMER_REAL, WAITS * seconds),
    ):
        signal.signal(alarm, signal.SIG_DFL)
        signal.setitimer(timer, limit_s)
    with contextlib.suppress(ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if sys.platform == "linux":
        # PR_SET_PDEATHSIG of prctl(2).
        ctypes.CDLL(None).prctl(1, signal.SIGKILL)


def _read(source: Path) -> dict[str, Any]:
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.ShapeFix import ShapeFix_Shape
    from OCP.STEPControl import STEPControl_Reader

    reader = STEPControl_Reader()
    if reader.ReadFile(str(source)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        return {"reason": ""}
    reader.TransferRoots()
    shape = reader.OneShape()
    if shape is None or shape.IsNull():
        return {"reason": "it holds no shape"}
    solids, notes = _parts(shape, "SOLID"), []
    if not solids:
        whole, notes = _sewn(shape)
    elif len(solids) == 1:
        whole = solids[0]
        if not BRepCheck_Analyzer(whole).IsValid():
            fixing = ShapeFix_Shape(whole)
            fixing.Perform()
            fixed = _parts(fixing.Shape(), "SOLID")
            if len(fixed) == 1 and BRepCheck_Analyzer(fixed[0]).IsValid():
                whole, notes = fixed[0], ["the CAD kernel repaired the solid"]
            else:
                notes = [""]
    else:
        whole = shape
    sound = len(solids) == 1 and notes != [""]
    points, faces, patch = loose_triangles(
        whole, tolerance_mm=max(TOLERANCE_MM, FINE_SHARE * _size(whole)), angle_rad=ANGLE_RAD
    )
    return {
        "points": points,
        "faces": faces,
        "patch": patch,
        "solids_mm3": [_volume(solid) for solid in solids],
        "sound": sound,
        "notes": [note for note in notes if note],
    }


def _sewn(shape: Any) -> tuple[Any, list[str]]:
    """Faces that belong to no solid, sewn along edges that meet."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Sewing

    faces = _parts(shape, "FACE")
    if len(faces) < 2:
        return shape, []
    sewing = BRepBuilderAPI_Sewing(SEW_MM)
    for face in faces:
        sewing.Add(face)
    sewing.Perform()
    whole = sewing.SewedShape()
    if whole is None or whole.IsNull():
        return shape, []
    return whole, [f"{len(faces)} loose faces were sewn"]


def _parts(shape: Any, kind: str) -> list[Any]:
    """The different parts of a kind, in the order of the file."""
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(shape, getattr(TopAbs_ShapeEnum, f"TopAbs_{kind}"))
    found = {}
    while explorer.More():
        found[hash(explorer.Current())] = explorer.Current()
        explorer.Next()
    return list(found.values())


def _size(shape: Any) -> float:
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box)
    return 0.0 if box.IsVoid() else float(np.sqrt(box.SquareExtent()))


def _volume(solid: Any) -> float:
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(solid, properties)
    return float(properties.Mass())


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
