"""Forty bodies as others bring them: clean, with holes, cutting through themselves, open CAD.

Each is written as a program or scanner would write it; the same bytes every time.
"""

# OCP has no type stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

Mesh = trimesh.Trimesh
KINDS = ("clean", "holes", "crossing", "cad")


@dataclass(frozen=True, kw_only=True, slots=True)
class Foreign:
    """One body and how a designer would place it."""

    name: str
    """File name with its ending."""
    kind: str
    write: Callable[[Path], None]
    flags: tuple[str, ...] = ()
    """What its designer would add: turns and a cut."""


def ball(subdivisions: int = 4, radius_mm: float = 16.0) -> Mesh:
    """A ball about the origin."""
    return trimesh.creation.icosphere(subdivisions, radius_mm)


def egg(subdivisions: int = 4, waves_mm: float = 0.0) -> Mesh:
    """An upright egg, on which waves may run."""
    made = ball(subdivisions)
    points = np.array(made.vertices) * [1.0, 0.85, 1.4]
    points *= 1.0 + waves_mm / 16.0 * np.sin(0.9 * points[:, [0]]) * np.cos(0.7 * points[:, [2]])
    return Mesh(points, made.faces, process=False)


def column(radius_mm: float = 13.0, height_mm: float = 36.0) -> Mesh:
    """A round column with a domed head, from the lathe."""
    turn = np.linspace(0.0, np.pi / 2, 24)
    rim = np.column_stack(
        [radius_mm * np.cos(turn), height_mm - radius_mm + radius_mm * np.sin(turn)]
    )
    outline = np.vstack([[0.0, 0.0], [radius_mm, 0.0], rim[:-1], [0.0, height_mm]])
    return trimesh.creation.revolve(outline, sections=96)


def brick(size_mm: tuple[float, float, float] = (28.0, 24.0, 30.0)) -> Mesh:
    """A block."""
    return trimesh.creation.box(size_mm)


def cup(wall_mm: float = 2.5) -> Mesh:
    """A column that is hollow from below: a membrane already."""
    return trimesh.boolean.difference(
        [column(), _moved(column(13.0 - wall_mm, 36.0 - wall_mm), (0.0, 0.0, -0.01))],
        engine="manifold",
    )


def double_walled() -> Mesh:
    """A ball in a ball, the inner one inside out: one hollow body of two surfaces."""
    inner = ball(4, 13.0)
    inner.invert()
    return trimesh.util.concatenate([ball(4, 16.0), inner])


def bent() -> Mesh:
    """A bent finger: circles along a quarter of a turn, closed at both ends."""
    return _pipe(_arc(60.0), np.full(40, 11.0))


def knotted() -> Mesh:
    """A pipe whose bend is narrower than the pipe: it cuts through itself."""
    return _pipe(_arc(100.0, bend_mm=7.0), np.full(40, 10.0))


def _arc(degrees: float, bend_mm: float = 30.0) -> np.ndarray:
    turn = np.radians(np.linspace(0.0, degrees, 28))
    bend = np.column_stack(
        [bend_mm - bend_mm * np.cos(turn), 0 * turn, 16 + bend_mm * np.sin(turn)]
    )
    foot = np.column_stack([np.zeros((12, 2)), np.linspace(0.0, 15.0, 12)])
    return np.vstack([foot, bend])


def _pipe(line: np.ndarray, radius: np.ndarray, sides: int = 48) -> Mesh:
    along = np.gradient(line, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    across = np.cross(along, [0.0, 1.0, 0.0])
    angle = np.linspace(0.0, 2 * np.pi, sides, endpoint=False)
    rings = (
        line[:, None]
        + radius[:, None, None] * np.cos(angle)[None, :, None] * across[:, None]
        + radius[:, None, None] * np.sin(angle)[None, :, None] * np.array([0.0, 1.0, 0.0])
    )
    count = len(line)
    a = np.arange((count - 1) * sides).reshape(count - 1, sides)
    b, c, d = np.roll(a, -1, axis=1), a + sides, np.roll(a, -1, axis=1) + sides
    walls = np.vstack(
        [np.stack([a, b, d], -1).reshape(-1, 3), np.stack([a, d, c], -1).reshape(-1, 3)]
    )
    first, last = count * sides, count * sides + 1
    ring = np.arange(sides)
    low = np.column_stack([np.full(sides, first), np.roll(ring, -1), ring])
    top = ring + (count - 1) * sides
    high = np.column_stack([np.full(sides, last), top, np.roll(top, -1)])
    points = np.vstack([rings.reshape(-1, 3), line[0], line[-1]])
    made = Mesh(points, np.vstack([walls, low, high]), process=False)
    if made.volume < 0.0:
        made.invert()
    return made


def _moved(made: Mesh, shift: tuple[float, float, float]) -> Mesh:
    again = made.copy()
    again.apply_translation(shift)
    return again


def without(made: Mesh, chosen: Callable[[np.ndarray], np.ndarray]) -> Mesh:
    """The mesh without the triangles whose middles are chosen."""
    again = made.copy()
    again.update_faces(~chosen(again.triangles_center))
    return again


def confetti(made: Mesh, share: float, seed: int = 0) -> Mesh:
    """The mesh with a share of its triangles gone, all over."""
    gone = np.random.default_rng(seed).random(len(made.faces)) < share
    again = made.copy()
    again.update_faces(~gone)
    return again


def cracked(made: Mesh, gap_mm: float) -> Mesh:
    """Cut into eight along the planes of the axes, the pieces drawn apart, without new faces."""
    pieces = []
    for signs in np.ndindex(2, 2, 2):
        side = 2.0 * np.array(signs) - 1.0
        middle = made.triangles_center - made.centroid
        part = made.copy()
        part.update_faces((middle * side > 0.0).all(axis=1))
        pieces.append(_moved(part, tuple(0.5 * gap_mm * side)))
    return trimesh.util.concatenate(pieces)


def together(*made: Mesh) -> Mesh:
    """Meshes in one file, not united."""
    return trimesh.util.concatenate(list(made))


def studded() -> Mesh:
    """An egg with sixty knobs stuck in, not united."""
    skin, knob = egg(), ball(1, 1.2)
    places = skin.vertices[skin.vertices[:, 2] > -4.0][::20][:60]
    return together(skin, *[_moved(knob, tuple(place)) for place in places])


def twisted() -> Mesh:
    """A ball with a vertex pulled through to the other side."""
    made = ball()
    points = np.array(made.vertices)
    points[np.argmax(points[:, 0])] = [-19.0, 1.0, 2.0]
    return Mesh(points, made.faces, process=False)


def doubled() -> Mesh:
    """Two blocks on each other that share a face, which both have, and a third half sunk in."""
    return together(
        brick((26.0, 26.0, 20.0)),
        _moved(brick((26.0, 26.0, 16.0)), (0.0, 0.0, 18.0)),
        _moved(brick((16.0, 16.0, 16.0)), (0.0, 0.0, 27.0)),
    )


def stl(make: Callable[[], Mesh]) -> Callable[[Path], None]:
    """A writer of the mesh as STL."""
    return lambda path: path.write_bytes(bytes(make().export(file_type="stl"))) and None


def step(make: Callable[[], Any]) -> Callable[[Path], None]:
    """A writer of OCCT shapes as STEP, faces that belong to nothing included."""

    def write(path: Path) -> None:
        from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

        writer = STEPControl_Writer()
        for shape in make():
            writer.Transfer(shape, STEPControl_StepModelType.STEPControl_AsIs)
        writer.Write(str(path))

    return write


def faces_of(body: Any, left_out: tuple[int, ...] = (), gap_mm: float = 0.0) -> list[Any]:
    """The faces of a build123d body as loose shapes, some left out, each moved outward a little."""
    from build123d import Pos

    middle = body.center()
    found = []
    for number, face in enumerate(body.faces()):
        if number in left_out:
            continue
        away = (face.center() - middle).normalized() * gap_mm
        moved = Pos(away.X, away.Y, away.Z) * face if gap_mm else face
        found.append(moved.wrapped)
    return found


def cad_block() -> Any:
    """A block with rounded edges."""
    from build123d import Box, fillet

    made = Box(26, 22, 30)
    return fillet(made.edges(), 4.0)


def cad_column() -> Any:
    """A column with a domed head."""
    from build123d import Cylinder, Pos, Sphere

    return Cylinder(13, 24) + Pos(0, 0, 12) * Sphere(13)


def cad_cone() -> Any:
    """A truncated cone on a plate."""
    from build123d import Cone, Cylinder, Pos

    return Cone(14, 9, 28) + Pos(0, 0, -16) * Cylinder(16, 6)


def cad_loft() -> Any:
    """A square that becomes a circle."""
    from build123d import Circle, Pos, Rectangle, loft

    return loft([Rectangle(26, 26).face(), (Pos(0, 0, 32) * Circle(10)).face()])


def cad_shell() -> list[Any]:
    """The shell of a block without its solid."""
    return [cad_block().shells()[0].wrapped]


def cad_half() -> list[Any]:
    """The curved faces of a column only: a sleeve without foot."""
    made = cad_column()
    lowest = min(range(len(made.faces())), key=lambda k: made.faces()[k].center().Z)
    return faces_of(made, (lowest,))


def cad_sheet() -> list[Any]:
    """One flat face: there is nothing to go round."""
    return faces_of(cad_block())[:1]


def cad_crossing() -> list[Any]:
    """Two columns through each other, as two solids."""
    from build123d import Pos

    return [cad_column().wrapped, (Pos(9, 0, 4) * cad_block()).wrapped]


TURN = ("--body-turn-deg", "90,0,0")


def _cut(mm: float) -> tuple[str, ...]:
    return ("--body-cut-mm", f"{mm:g}")


def _foreign(kind: str, number: int, made: Any, flags: tuple[str, ...] = ()) -> Foreign:
    ending, writer = ("step", step) if kind == "cad" else ("stl", stl)
    return Foreign(name=f"{kind}_{number}.{ending}", kind=kind, write=writer(made), flags=flags)


def _high(points: np.ndarray) -> np.ndarray:
    return points[:, 2] > 12.0


def _side(points: np.ndarray) -> np.ndarray:
    return (points[:, 0] > 9.0) & (np.abs(points[:, 2]) < 8.0)


def _foot(points: np.ndarray) -> np.ndarray:
    # An uneven rim: no flat lid closes it.
    return points[:, 2] + 1.5 * np.sin(points[:, 0]) < -12.0


CLEAN = (
    (column, ()),
    (ball, _cut(8.0)),
    (egg, _cut(7.0)),
    (lambda: egg(6, 0.5), _cut(7.0)),
    (brick, ()),
    (cup, ()),
    (double_walled, _cut(6.0)),
    (bent, ()),
    (lambda: trimesh.creation.capsule(22.0, 13.0, count=(48, 48)), _cut(10.0)),
    (lambda: _moved(_turned(column()), (3.0, 50.0, -7.0)), ("--body-turn-deg", "-90,0,0")),
)
HOLES = (
    (lambda: without(ball(), _high), _cut(8.0)),
    (lambda: without(egg(), _side), _cut(7.0)),
    (lambda: without(egg(5), _foot), _cut(9.0)),
    (lambda: confetti(egg(5), 0.01), _cut(7.0)),
    (lambda: confetti(egg(6), 0.03), _cut(7.0)),
    (lambda: confetti(column(), 0.02), ()),
    (lambda: cracked(ball(5), 0.05), _cut(8.0)),
    (lambda: cracked(egg(5), 0.4), _cut(8.0)),
    (lambda: without(without(ball(5), _high), _foot), _cut(8.0)),
    (lambda: without(bent(), lambda p: (p[:, 2] > 14.0) & (p[:, 1] > 5.0)), ()),
)
CROSSING = (
    (studded, _cut(7.0)),
    (twisted, _cut(8.0)),
    (doubled, ()),
    (knotted, ()),
    (lambda: together(egg(), _moved(ball(4, 9.0), (9.0, 0.0, 8.0))), _cut(7.0)),
    (lambda: together(column(), _moved(brick((20.0, 20.0, 14.0)), (0.0, 0.0, 7.0))), ()),
    (lambda: together(*[_moved(ball(3, 9.0), (0.0, 0.0, 6.0 * k)) for k in range(4)]), _cut(6.0)),
    (lambda: together(ball(5), _turned(brick((44.0, 6.0, 6.0)))), _cut(8.0)),
    (lambda: together(ball(), _moved(ball(), (60.0, 0.0, 0.0))), _cut(8.0)),
    (lambda: together(egg(6, 0.5), _moved(ball(4, 8.0), (0.0, 0.0, 20.0))), _cut(7.0)),
)
CAD = (
    (cad_shell, ()),
    (lambda: faces_of(cad_block()), ()),
    (lambda: faces_of(cad_column()), ()),
    (lambda: faces_of(cad_column(), gap_mm=0.002), ()),
    (lambda: faces_of(cad_cone(), gap_mm=0.05), ()),
    (lambda: faces_of(cad_loft(), left_out=(0,)), ()),
    (cad_half, ()),
    (lambda: faces_of(cad_block(), left_out=(3, 7)), ()),
    (cad_sheet, ()),
    (cad_crossing, ()),
)


def _turned(made: Mesh) -> Mesh:
    again = made.copy()
    again.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, [1.0, 0.0, 0.0]))
    return again


FORTY = tuple(
    _foreign(kind, number, made, flags)
    for kind, rows in zip(KINDS, (CLEAN, HOLES, CROSSING, CAD), strict=True)
    for number, (made, flags) in enumerate(rows)
)


def written(foreign: Foreign) -> bytes:
    """The file's bytes."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / foreign.name
        foreign.write(path)
        return path.read_bytes()
