"""Files for the workshop: binary STL and named STEP assemblies."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from geometry.solid import part_from_brep
from workbench.core.errors import StoreError
from workbench.core.fabrication import FabricationPart
from workbench.core.monitor import Monitor, silent

ASSEMBLY = "mould_assembly"
HEADER = b"binary STL in millimetres"


def stl_bytes(points_mm: np.ndarray, faces: np.ndarray) -> bytes:
    """A binary STL file [mm]: 80 bytes of header, the count, 50 bytes a triangle."""
    corners = np.asarray(points_mm, dtype=np.float64)[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("spare", "<u2")])
    rows = np.zeros(len(faces), dtype=record)
    rows["normal"], rows["corners"] = normal, corners
    return HEADER.ljust(80, b"\0") + np.array(len(faces), dtype="<u4").tobytes() + rows.tobytes()


def step_file(parts: Sequence[FabricationPart], path: Path) -> None:
    """Write a STEP assembly in which every part has its name.

    Raises:
        StoreError: If the file cannot be written.
    """
    from build123d import Compound

    bodies = []
    for part in parts:
        body = part_from_brep(part.brep)
        body.label = part.name
        bodies.append(body)
    _write_step(Compound(label=ASSEMBLY, children=bodies), path)


def step_part(part: FabricationPart, path: Path) -> None:
    """Write one part as a STEP file.

    Raises:
        StoreError: If the file cannot be written.
    """
    body = part_from_brep(part.brep)
    body.label = part.name
    _write_step(body, path)


def part_files(
    parts: Sequence[FabricationPart], monitor: Monitor = silent
) -> dict[str, np.ndarray]:
    """Every part as STL and STEP, and all as one STEP assembly.

    Returns:
        Bytes of each file by its name, shape (bytes,), uint8.
    """
    files: dict[str, np.ndarray] = {}
    # OCCT writes STEP to named files only.
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "part.step"
        for number, part in enumerate(parts):
            monitor(number / (len(parts) + 1), f"writing {part.name}")
            files[f"{part.name}.stl"] = _array(stl_bytes(part.points_mm, part.faces))
            step_part(part, path)
            files[f"{part.name}.step"] = _array(path.read_bytes())
        monitor(len(parts) / (len(parts) + 1), "writing the assembly")
        step_file(parts, path)
        files[f"{ASSEMBLY}.step"] = _array(path.read_bytes())
    return files


def _write_step(body: Any, path: Path) -> None:
    from build123d import export_step

    try:
        written = export_step(body, str(path), timestamp="2000-01-01T00:00:00")
    except (OSError, RuntimeError) as error:
        raise _unwritten(path) from error
    if not written:
        raise _unwritten(path)


def _unwritten(path: Path) -> StoreError:
    return StoreError(
        f"cannot write {path}", hint="check that the folder exists and has room", at="out"
    )


def _array(data: bytes) -> np.ndarray:
    return np.frombuffer(data, dtype=np.uint8).copy()
