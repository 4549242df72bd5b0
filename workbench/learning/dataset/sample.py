"""One sample: the recorded state of one frame, and its file.

A file is an uncompressed NPZ: `head` is JSON, images are PNG bytes, and of each solver only the
vertices are kept that it moved by more than `LEAST_MOVE_MM`, that carry force, or that slide; the
others are zero by construction. Every entry has a checksum, so a truncated file is noticed.
"""

from __future__ import annotations

import io
import json
import math
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sim.forces.peaks import Peaks, Triangles, peaks
from workbench.core.base.check import expect
from workbench.core.base.errors import SolveError, StoreError

LEAST_MOVE_MM = 1e-6
"""Vertices that moved less and carry no force are at rest."""
HEAD = "head"
SOURCES = ("mpm", "fem")


def _none(*shape: int) -> np.ndarray:
    return np.zeros(shape, dtype=np.float32)


@dataclass(frozen=True, kw_only=True, slots=True)
class Solved:
    """What one solver found; V outer vertices, sensor frame."""

    displacement_mm: np.ndarray
    """Displacement of the outer skin's vertices [mm], shape (V, 3), float32."""
    contact_force_N: np.ndarray
    """Force of the object on the skin at its vertices [N], shape (V, 3), float32."""
    sliding: np.ndarray
    """Vertices around which most of the contact slides, shape (V,), bool."""
    reaction_N: np.ndarray
    """Force on the object [N], shape (3,), float64."""
    tangential_N: float
    """Size of the reaction across the target's normal [N]."""
    residual: float
    """Relative out-of-balance force."""
    balance: float
    """Force missing between object and what holds the skin, over the load."""
    converged: bool
    seconds: float
    """Time that the frame took [s]."""
    sliding_share: float = 0.0
    """Share of the contact's area that slides in the frame."""
    cauchy_MPa: np.ndarray = field(default_factory=lambda: _none(0, 6))
    """Cauchy stress at the vertices, xx, yy, zz, xy, yz, zx [MPa], shape (V, 6), float32; of the
    FEM only, else (0, 6)."""

    def peaks(self, skin: Triangles) -> Peaks:
        """Largest pressure and disc force, on the skin of the data set: `data.skin`."""
        return peaks(skin, self.contact_force_N, self.displacement_mm)


@dataclass(frozen=True, kw_only=True, slots=True)
class Sample:
    """One frame of a case."""

    case: str
    frame: int
    recipe: str
    """Key of the recipe that it belongs to."""
    indenter: str
    """Shape label."""
    depth_mm: float
    """Depth from first touch [mm]."""
    shear_mm: tuple[float, float]
    """Way along U and V [mm]."""
    pose: np.ndarray
    """x, y, z [mm], qw, qx, qy, qz of the object, shape (7,), float64."""
    target_mm: np.ndarray
    """Target on the undeformed skin [mm], shape (3,)."""
    normal: np.ndarray
    """Outward unit normal there, shape (3,)."""
    tangent_u: np.ndarray
    """Unit U of the tangent plane, shape (3,); V = n x U."""
    mpm: Solved | None = None
    fem: Solved | None = None
    png: bytes = b""
    """Image without markers as a PNG file; empty where images were left out."""
    png_markers: bytes = b""
    """The same with markers."""
    markers_px: np.ndarray = field(default_factory=lambda: _none(0, 2))
    """u, v of the markers in it [px], shape (M, 2), float32; NaN where one is out of sight."""

    @property
    def image(self) -> np.ndarray:
        """Image without markers, sRGB, shape (H, W, 3), uint8."""
        return decoded(self.png)

    @property
    def image_markers(self) -> np.ndarray:
        """Image with markers, sRGB, shape (H, W, 3), uint8."""
        return decoded(self.png_markers)


def decoded(png: bytes) -> np.ndarray:
    """A PNG file as sRGB, shape (H, W, 3), uint8.

    Raises:
        StoreError: If there is no image in it.
    """
    import cv2

    found = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR) if png else None
    if found is None:
        raise StoreError(
            "the sample holds no image" if not png else "the image of the sample cannot be read",
            hint="make the data set with images, or look at its fields only",
            at="image",
        )
    return np.ascontiguousarray(found[..., ::-1])


def to_bytes(sample: Sample) -> bytes:
    """The file of a sample.

    Raises:
        SolveError: If a field of it is not finite: such a sample is never written.
    """
    head: dict[str, Any] = {
        "case": sample.case,
        "frame": sample.frame,
        "recipe": sample.recipe,
        "indenter": sample.indenter,
        "depth_mm": sample.depth_mm,
        "shear_mm": list(sample.shear_mm),
    }
    arrays: dict[str, np.ndarray] = {}
    for name in ("pose", "target_mm", "normal", "tangent_u"):
        head[name] = [float(value) for value in getattr(sample, name)]
    for name in SOURCES:
        solved = getattr(sample, name)
        if solved is not None:
            head[name], own = _packed(solved)
            arrays |= {f"{name}.{part}": values for part, values in own.items()}
    for name in ("png", "png_markers"):
        if content := getattr(sample, name):
            arrays[name] = np.frombuffer(content, np.uint8)
    if len(sample.markers_px):
        arrays["markers_px"] = sample.markers_px.astype(np.float32)
    bad = not_finite(head, arrays)
    if bad:
        raise SolveError(
            f"{bad} of frame {sample.frame + 1} of {sample.case} is not finite",
            hint="lower the depth of the recipe, and report it",
            frame=sample.frame,
        )
    arrays[HEAD] = np.frombuffer(json.dumps(head).encode(), np.uint8)
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)  # pyright: ignore[reportArgumentType]
    return buffer.getvalue()


def from_bytes(content: bytes, vertices: int) -> Sample:
    """The sample in a file.

    Args:
        content: The file.
        vertices: Vertices of the skin.

    Raises:
        ValueError: If the file is truncated, damaged, of another skin, or a field is not finite.
    """
    try:
        with np.load(io.BytesIO(content)) as file:
            arrays = {name: file[name] for name in file.files}
        head = json.loads(arrays.pop(HEAD).tobytes())
        bad = not_finite(head, arrays)
        if bad:
            raise ValueError(f"{bad} is not finite")
        solved = {
            name: _unpacked(head[name], arrays, name, vertices) if name in head else None
            for name in SOURCES
        }
        return Sample(
            case=str(head["case"]),
            frame=int(head["frame"]),
            recipe=str(head["recipe"]),
            indenter=str(head["indenter"]),
            depth_mm=float(head["depth_mm"]),
            shear_mm=(float(head["shear_mm"][0]), float(head["shear_mm"][1])),
            pose=np.array(head["pose"]),
            target_mm=np.array(head["target_mm"]),
            normal=np.array(head["normal"]),
            tangent_u=np.array(head["tangent_u"]),
            mpm=solved["mpm"],
            fem=solved["fem"],
            png=arrays.get("png", _none(0)).tobytes(),
            png_markers=arrays.get("png_markers", _none(0)).tobytes(),
            markers_px=arrays.get("markers_px", _none(0, 2)),
        )
    except (OSError, KeyError, TypeError, IndexError, EOFError, zlib.error) as error:
        raise ValueError(f"it is damaged: {error!r}") from error
    except zipfile.BadZipFile as error:
        raise ValueError(f"it is truncated or damaged: {error}") from error


def not_finite(head: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> str:
    """Name of the first field with a value that is not finite, else ""."""
    for name, values in arrays.items():
        # A marker out of sight has no place.
        if name != "markers_px" and values.dtype.kind == "f" and not np.isfinite(values).all():
            return name
    for name, value in head.items():
        if isinstance(value, dict):
            if bad := not_finite(value, {}):
                return f"{name}.{bad}"
            continue
        items = value if isinstance(value, list) else [value]
        if any(isinstance(item, float) and not math.isfinite(item) for item in items):
            return name
    return ""


def _packed(solved: Solved) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    count = len(solved.displacement_mm)
    expect(solved.displacement_mm, "V 3", name="displacement")
    expect(solved.contact_force_N, f"{count} 3", name="force")
    touched = solved.contact_force_N.any(axis=1) | solved.sliding
    # What is not finite is kept, to be refused.
    moved = ~(np.abs(solved.displacement_mm).max(axis=1) <= LEAST_MOVE_MM)
    index = np.flatnonzero(touched | moved).astype(np.int32)
    arrays = {
        "index": index,
        "displacement_mm": solved.displacement_mm[index].astype(np.float32),
        "contact_force_N": solved.contact_force_N[index].astype(np.float32),
        "sliding": solved.sliding[index].astype(bool),
    }
    if len(solved.cauchy_MPa):
        arrays["cauchy_MPa"] = solved.cauchy_MPa[index].astype(np.float32)
    head = {
        "vertices": count,
        "reaction_N": [float(value) for value in solved.reaction_N],
        "tangential_N": float(solved.tangential_N),
        "residual": float(solved.residual),
        "balance": float(solved.balance),
        "converged": bool(solved.converged),
        "seconds": float(solved.seconds),
        "sliding_share": float(solved.sliding_share),
    }
    return head, arrays


def _unpacked(
    head: Mapping[str, Any], arrays: Mapping[str, np.ndarray], name: str, vertices: int
) -> Solved:
    if head["vertices"] != vertices:
        raise ValueError(f"its skin has {head['vertices']} vertices, this data set's {vertices}")
    index = arrays[f"{name}.index"]

    def spread(part: str) -> np.ndarray:
        values = arrays[f"{name}.{part}"]
        found = np.zeros((vertices, *values.shape[1:]), values.dtype)
        found[index] = values
        return found

    return Solved(
        displacement_mm=spread("displacement_mm"),
        contact_force_N=spread("contact_force_N"),
        sliding=spread("sliding"),
        cauchy_MPa=spread("cauchy_MPa") if f"{name}.cauchy_MPa" in arrays else _none(0, 6),
        reaction_N=np.array(head["reaction_N"]),
        tangential_N=head["tangential_N"],
        residual=head["residual"],
        balance=head["balance"],
        converged=head["converged"],
        seconds=head["seconds"],
        # Of samples of before, nobody knows: their flags meant something else.
        sliding_share=head.get("sliding_share", 0.0),
    )
