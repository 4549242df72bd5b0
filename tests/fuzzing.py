"""Damaged designs and CAD files, the same for the same seed, as a disk, an editor or a bug
elsewhere makes them: see `tests.property.test_fuzz`.
"""

from __future__ import annotations

import random
import re
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import trimesh

NUMBER = re.compile(r"(?<![\w#.])[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")
EXTREME = (
    *("0", "0.0", "-0.0", "-1", "1", "2", "1e-9", "-1e-9", "1e-300", "1e9", "1e308", "-1e308"),
    *(
        "nan",
        "inf",
        "-inf",
        "2147483648",
        "-9223372036854775809",
        "1" + "0" * 400,
        "1" + "0" * 5000,
        "1_0",
    ),
)
"""Numbers that a field may meet; some are no TOML."""
FOREIGN = (
    *("'text'", "''", "true", "[]", "{}", "[1, 'a', [2]]", "1979-05-27", "{nan = nan}"),
    *("'\\u0000'", '"\\u0000\\u202e\\U0001f600"', "'../../etc/passwd'", "[[0.0, 0.0, 0.0]]"),
    *("'builtin:nothing.png'", "'" + "x" * 100_000 + "'", '"' + "\\u00e9" * 20_000 + '"'),
    *("[" + "1.0, " * 2000 + "]", "[" * 4000 + "]" * 4000, "[" * 90 + "]" * 90),
)
"""Values that are no number."""
GARBAGE = (
    *(b"", b"\0", b"\x89PNG\r\n\x1a\n" + bytes(90), b"PK\3\4" + bytes(200), b"<!DOCTYPE html>"),
    *(b"solid", b"solid x\nendsolid x\n", b"ISO-10303-21;", bytes(84), b"v 0 0 0\nf 1 1 1\n"),
    *(b"f 1 2 3\n", b"v nan nan nan\nf 1 1 1\n", b"\xff\xfe" + bytes(33), b"v 1 2\nf a b c\n"),
)
"""Contents that are no body at all."""


def changed_design(text: str, rng: random.Random) -> bytes:
    """A design file with one to four edits."""
    for _ in range(rng.choice((1, 1, 1, 2, 4))):
        text = rng.choice(TEXT_EDITS)(text, rng)
    content = text.encode("utf-8", "surrogatepass")
    return rng.choice(BYTE_EDITS)(content, rng) if rng.random() < 0.12 else content


def changed_file(content: bytes, ending: str, rng: random.Random) -> tuple[bytes, str]:
    """A CAD file with one or two edits, and the ending it is given."""
    if rng.random() < 0.05:
        content = rng.choice((*GARBAGE, rng.randbytes(rng.choice((7, 84, 134, 5000)))))
    else:
        edits = [*BYTE_EDITS]
        binary = ending == ".stl" and not content.startswith(b"solid")
        edits += [*STL_EDITS] * 2 if binary else [*WORD_EDITS] * 2
        for _ in range(rng.choice((1, 1, 2))):
            content = rng.choice(edits)(content, rng)
    return content, rng.choice(
        (".stl", ".STL", ".step", ".stp", ".obj")
    ) if rng.random() < 0.06 else ending


def _lines(text: str) -> list[int]:
    """Lines that set a value."""
    return [n for n, line in enumerate(text.split("\n")) if "=" in line]


def _line_edit(change: Callable[[str, random.Random], str]) -> Callable[[str, random.Random], str]:
    def edit(text: str, rng: random.Random) -> str:
        lines, places = text.split("\n"), _lines(text)
        if places:
            place = rng.choice(places)
            lines[place] = change(lines[place], rng)
        return "\n".join(lines)

    return edit


def _with_value(line: str, value: str) -> str:
    return f"{line.partition('=')[0]}= {value}"


def _scaled(line: str, rng: random.Random) -> str:
    """Every number a little, or much, larger or smaller: what may still be built."""
    factor = rng.choice((0.1, 0.5, 0.9, 1.1, 1.5, 2.0, 5.0, -1.0))
    name, _, value = line.partition("=")
    return f"{name}={NUMBER.sub(lambda found: f'{float(found[0]) * factor:.6g}', value)}"


def _misspelt(line: str, rng: random.Random) -> str:
    name, _, value = line.partition("=")
    place = rng.randrange(len(name))
    letter = rng.choice(("", "x", "é", ".", " ", "-", "\u202e", "\0"))
    return f"{name[:place]}{letter}{name[place + 1 :]}={value}"


def _lengthened(line: str, rng: random.Random) -> str:
    name, _, value = line.partition("=")
    return f"{name}= [{', '.join([value.strip()] * rng.choice((2, 3, 50, 600)))}]"


def _one_number(line: str, rng: random.Random) -> str:
    """One number of a line, as of a vector."""
    found = list(NUMBER.finditer(line.partition("=")[2]))
    if not found:
        return _with_value(line, rng.choice(EXTREME))
    name, _, value = line.partition("=")
    one = rng.choice(found)
    return f"{name}={value[: one.start()]}{rng.choice(EXTREME)}{value[one.end() :]}"


def _shuffled(text: str, rng: random.Random) -> str:
    """Some lines stand elsewhere, or twice."""
    lines = text.split("\n")
    for _ in range(rng.choice((1, 3))):
        line = lines[rng.randrange(len(lines))]
        lines.insert(rng.randrange(len(lines)), line)
    return "\n".join(lines)


def _other_family(text: str, rng: random.Random) -> str:
    names = ("finger", "pad", "paw", "thumb", "trunk", "tentacle", "digitac", "imported", "none")
    return re.sub(r'family = "\w+"', f'family = "{rng.choice(names)}"', text)


def _cut(text: str, rng: random.Random) -> str:
    return text[: rng.randrange(len(text) + 1)]


def _inserted(text: str, rng: random.Random) -> str:
    lines = text.split("\n")
    more = ("[a" + ".a" * 3000 + "]", "[shape]", "[[optics.lamps]]", "[optics.lamps]", "= 1")
    line = rng.choice((*more, "\ufeff", "x = 1\r", "schema = 99", "[body]\nouter = 'a.step'"))
    lines.insert(rng.randrange(len(lines)), line)
    return "\n".join(lines)


TEXT_EDITS: tuple[Callable[[str, random.Random], str], ...] = (
    *[_line_edit(_one_number)] * 4,
    *[_line_edit(_scaled)] * 6,
    *[_line_edit(lambda line, rng: _with_value(line, rng.choice(FOREIGN)))] * 3,
    _line_edit(_misspelt),
    _line_edit(_lengthened),
    _line_edit(lambda line, rng: ""),
    _shuffled,
    _other_family,
    _inserted,
    _cut,
)


def _flipped(content: bytes, rng: random.Random) -> bytes:
    found = bytearray(content)
    for _ in range(rng.choice((1, 4, 32)) if found else 0):
        found[rng.randrange(len(found))] ^= 1 << rng.randrange(8)
    return bytes(found)


def _shortened(content: bytes, rng: random.Random) -> bytes:
    return content[: rng.randrange(len(content) + 1)]


def _stuffed(content: bytes, rng: random.Random) -> bytes:
    place = rng.randrange(len(content) + 1)
    stuff = rng.choice((rng.randbytes(64), bytes(3), b"\n" * 50, b"(" * 5000, b"1" * 100_000))
    return content[:place] + stuff + content[place + rng.choice((0, len(stuff))) :]


BYTE_EDITS: tuple[Callable[[bytes, random.Random], bytes], ...] = (_flipped, _shortened, _stuffed)


def _number_edit(content: bytes, rng: random.Random) -> bytes:
    """A few numbers of a text take extreme values."""
    text = content.decode("latin-1")
    found = list(NUMBER.finditer(text))
    for one in sorted(
        rng.sample(found, min(len(found), rng.choice((1, 3)))), key=lambda m: -m.start()
    ):
        text = text[: one.start()] + rng.choice(EXTREME) + text[one.end() :]
    return text.encode("latin-1")


def _reference_edit(content: bytes, rng: random.Random) -> bytes:
    """A few references of a STEP file point elsewhere: to nothing, to themselves, in circles."""
    text = content.decode("latin-1")
    found = list(re.finditer(r"#\d+", text))
    names = [one[0] for one in found]
    for one in sorted(
        rng.sample(found, min(len(found), rng.choice((1, 2, 8)))), key=lambda m: -m.start()
    ):
        other = rng.choice((rng.choice(names), rng.choice(names), "#999999", "#0", "$", "*"))
        text = text[: one.start()] + other + text[one.end() :]
    return text.encode("latin-1")


def _line_order(content: bytes, rng: random.Random) -> bytes:
    """Lines are missing, doubled, or stand elsewhere."""
    lines = content.split(b"\n")
    for _ in range(rng.choice((1, 5, 40))):
        if lines:
            line = lines.pop(rng.randrange(len(lines)))
            for _ in range(rng.choice((0, 1, 2))):
                lines.insert(rng.randrange(len(lines) + 1), line)
    return b"\n".join(lines)


def _word_edit(content: bytes, rng: random.Random) -> bytes:
    """A keyword becomes another of the file."""
    found = list(re.finditer(rb"[A-Za-z_]{2,}", content))
    if not found:
        return content
    one, other = rng.choice(found), rng.choice(found)
    return content[: one.start()] + other[0] + content[one.end() :]


WORD_EDITS: tuple[Callable[[bytes, random.Random], bytes], ...] = (
    _number_edit,
    _number_edit,
    _reference_edit,
    _line_order,
    _word_edit,
)


def _stl_count(content: bytes, rng: random.Random) -> bytes:
    count = rng.choice((0, 1, 0x7FFFFFFF, 0xFFFFFFFF, len(content) // 50, len(content) // 50 - 5))
    return content[:80] + struct.pack("<I", max(0, count)) + content[84:]


def _stl_edit(change: Callable[[np.ndarray, random.Random], np.ndarray]) -> Callable[..., bytes]:
    """An edit of the triangles (M, 3, 3) of a binary STL."""

    def edit(content: bytes, rng: random.Random) -> bytes:
        count = (len(content) - 84) // 50
        if count < 1:
            return content
        rows = np.frombuffer(content, np.uint8, 50 * count, 84).reshape(count, 50)
        corners = rows[:, 12:48].copy().view("<f4").reshape(count, 3, 3)
        return stl_bytes(change(corners, rng))

    return edit


def stl_bytes(corners: np.ndarray) -> bytes:
    """Triangles (M, 3, 3) as a binary STL."""
    rows = np.zeros((len(corners), 50), dtype=np.uint8)
    rows[:, 12:48] = np.ascontiguousarray(corners, dtype="<f4").reshape(-1, 9).view(np.uint8)
    return bytes(80) + struct.pack("<I", len(corners)) + rows.tobytes()


def _coordinates(corners: np.ndarray, rng: random.Random) -> np.ndarray:
    flat = corners.reshape(-1)
    for _ in range(rng.choice((1, 5))):
        flat[rng.randrange(len(flat))] = rng.choice((np.nan, np.inf, -1e38, 1e-40, 0.0, 1e6))
    return corners


def _size(corners: np.ndarray, rng: random.Random) -> np.ndarray:
    factor = rng.choice((0.0, 1e-30, 1e-3, 0.1, 10.0, 1e3, 1e30))
    return corners * np.float32(factor)


def _flat(corners: np.ndarray, rng: random.Random) -> np.ndarray:
    corners[..., rng.randrange(3)] *= np.float32(rng.choice((0.0, 1e-6, 0.01)))
    return corners


def _noise(corners: np.ndarray, rng: random.Random) -> np.ndarray:
    """Corners that met no longer do, or all of them move together so that faces cross."""
    draw = np.random.default_rng(rng.randrange(2**32))
    if rng.random() < 0.5:
        return corners + draw.normal(0.0, 10.0 ** rng.uniform(-7, 0), corners.shape)
    points, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    moved = points + draw.normal(0.0, 10.0 ** rng.uniform(-3, 0.5), points.shape)
    return moved[index.ravel()].reshape(corners.shape)


def _fewer(corners: np.ndarray, rng: random.Random) -> np.ndarray:
    draw = np.random.default_rng(rng.randrange(2**32))
    return corners[draw.random(len(corners)) > rng.choice((0.01, 0.1, 0.9))]


def _doubled(corners: np.ndarray, rng: random.Random) -> np.ndarray:
    """A copy beside, across, inside or exactly on the body, perhaps inside out."""
    copy = corners * np.float32(rng.choice((1.0, 0.5, -1.0))) + np.float32(
        rng.choice((0, 1e-4, 5, 90))
    )
    return np.concatenate([corners, copy[:, ::-1] if rng.random() < 0.5 else copy])


def _turned(corners: np.ndarray, rng: random.Random) -> np.ndarray:
    """Some faces, or all, look inward."""
    draw = np.random.default_rng(rng.randrange(2**32))
    some = draw.random(len(corners)) < rng.choice((0.01, 0.5, 1.0))
    corners[some] = corners[some][:, ::-1]
    return corners


STL_EDITS: tuple[Callable[[bytes, random.Random], bytes], ...] = (
    _stl_count,
    *(_stl_edit(edit) for edit in (_coordinates, _size, _flat, _noise, _noise)),
    *(_stl_edit(edit) for edit in (_fewer, _doubled, _turned)),
)


def whole_files(folder: Path) -> dict[str, bytes]:
    """Sound files by name: a body (a dome on a drum) and an object (a notched ball), each as STEP,
    binary and ASCII STL, and the object as OBJ too.
    """
    import manifold3d as m3

    drum = m3.Manifold.cylinder(10.0, 12.0, 12.0, 32)
    dome = m3.Manifold.sphere(12.0, 32).translate((0.0, 0.0, 10.0))
    body = drum + dome.trim_by_plane((0.0, 0.0, 1.0), 9.0)
    notch = m3.Manifold.cube((2.0, 9.0, 2.0), True).translate((0.0, 0.0, -3.0))
    found = {}
    for name, solid in (("body", body), ("object", m3.Manifold.sphere(3.5, 24) - notch)):
        raw = solid.to_mesh()
        mesh = trimesh.Trimesh(raw.vert_properties[:, :3], raw.tri_verts)
        found[f"{name}.stl"] = stl_bytes(mesh.triangles)
        for kind, ending in (("stl_ascii", "ascii.stl"), ("obj", "obj")):
            text = mesh.export(file_type=kind)
            found[f"{name}.{ending}"] = text.encode() if isinstance(text, str) else text
    found |= {f"{name}.step": _step(name, folder) for name in ("body", "object")}
    return found


def _step(name: str, folder: Path) -> bytes:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
    from OCP.BRepPrimAPI import (
        BRepPrimAPI_MakeBox,
        BRepPrimAPI_MakeCylinder,
        BRepPrimAPI_MakeSphere,
    )
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

    if name == "body":
        drum = BRepPrimAPI_MakeCylinder(12.0, 10.0).Shape()
        axes = gp_Ax2(gp_Pnt(0.0, 0.0, 10.0), gp_Dir(0.0, 0.0, 1.0))
        shape = BRepAlgoAPI_Fuse(drum, BRepPrimAPI_MakeSphere(axes, 12.0, 0.0, 1.5707963).Shape())
    else:
        notch = BRepPrimAPI_MakeBox(gp_Pnt(-1, -5, -4), gp_Pnt(1, 5, -2)).Shape()
        shape = BRepAlgoAPI_Cut(BRepPrimAPI_MakeSphere(3.5).Shape(), notch)
    writer = STEPControl_Writer()
    writer.Transfer(shape.Shape(), STEPControl_StepModelType.STEPControl_AsIs)
    path = folder / f"{name}.step"
    writer.Write(str(path))
    return path.read_bytes()
