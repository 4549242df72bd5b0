"""A set of 21 objects of the kind that printed sets are: a foot below, what is to touch on top.

Each stands on a foot of 16 x 16 mm, its head of about 10 mm toward +Z: pressed as the file comes,
all 21 touch with the same square.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import manifold3d
import numpy as np
import trimesh

FOOT_MM = (16.0, 16.0, 6.0)
HIGH_MM = 5.0
SEGMENTS = 48
M, Section = manifold3d.Manifold, manifold3d.CrossSection


def _up(polygon: Any, high_mm: float = HIGH_MM) -> Any:
    """A prism of a closed polygon, or of a section."""
    section = polygon if isinstance(polygon, Section) else Section([np.asarray(polygon)])
    return M.extrude(section, high_mm)


def _round(count: int, radius_mm: float, other_mm: float | None = None) -> np.ndarray:
    """A regular polygon; with another radius a star of twice as many corners."""
    radii = [radius_mm] if other_mm is None else [radius_mm, other_mm]
    turns = np.arange(count * len(radii)) * 2.0 * np.pi / (count * len(radii))
    reach = np.resize(radii, len(turns))
    return np.column_stack([reach * np.cos(turns), reach * np.sin(turns)])


def _disc(radius_mm: float, x_mm: float = 0.0, y_mm: float = 0.0) -> Any:
    return Section.circle(radius_mm, SEGMENTS).translate((x_mm, y_mm))


def _bar(long_mm: float, wide_mm: float, degrees: float = 0.0, y_mm: float = 0.0) -> Any:
    return Section.square((long_mm, wide_mm), True).translate((0.0, y_mm)).rotate(degrees)


def _ball(radius_mm: float, z_mm: float) -> Any:
    """A ball, cut off where the foot begins."""
    ball = M.sphere(radius_mm, SEGMENTS).translate((0.0, 0.0, z_mm))
    return ball.trim_by_plane((0.0, 0.0, 1.0), 0.0)


def _cone(corners: int, radius_mm: float = 5.0) -> Any:
    return M.cylinder(HIGH_MM, radius_mm, 0.0, corners)


def _torus() -> Any:
    tube = _disc(1.5, 3.5, 0.0)
    return M.revolve(tube, SEGMENTS).translate((0.0, 0.0, 1.5))


def _lying(radius_mm: float) -> Any:
    """A cylinder on its side, half sunk into the foot."""
    rod = M.cylinder(10.0, radius_mm, radius_mm, SEGMENTS, True).rotate((0.0, 90.0, 0.0))
    return rod.trim_by_plane((0.0, 0.0, 1.0), 0.0)


def _wave() -> Any:
    along = np.linspace(-5.0, 5.0, 81)
    crest = 2.5 + 1.5 * np.cos(2.0 * np.pi * along / 3.3)
    outline = np.vstack([[[-5.0, 0.0], [5.0, 0.0]], np.column_stack([along, crest])[::-1]])
    return M.extrude(Section([outline]), 10.0).rotate((90.0, 0.0, 0.0)).translate((0, 5, 0))


def _random() -> Any:
    rng = np.random.default_rng(21)
    bumps = [
        M.cylinder(float(high), 0.9, 0.9, SEGMENTS).translate((float(x), float(y), 0.0))
        for x, y, high in zip(*rng.uniform(-4, 4, (2, 16)), rng.uniform(2, 5, 16), strict=True)
    ]
    return sum(bumps[1:], bumps[0])


def _grid(radius_mm: float) -> Any:
    places = np.linspace(-3.2, 3.2, 3)
    dots = [_disc(radius_mm, float(x), float(y)) for x in places for y in places]
    return sum(dots[1:], dots[0])


HEADS: dict[str, Callable[[], Any]] = {
    "sphere": lambda: _ball(5.0, 0.0),
    "cone": lambda: _cone(SEGMENTS),
    "pyramid": lambda: _cone(4, 7.0),
    "cylinder": lambda: _up(_disc(5.0)),
    "side_cylinder": lambda: _lying(3.0),
    "cube": lambda: M.cube((9.0, 9.0, HIGH_MM), True).translate((0.0, 0.0, HIGH_MM / 2)),
    "cross": lambda: _up(_bar(11.0, 2.5, 45.0) + _bar(11.0, 2.5, -45.0)),
    "dots": lambda: _up(_grid(0.8)),
    "dots_in": lambda: _up(_bar(10.0, 10.0) - _grid(0.9)),
    "pacman": lambda: _up(_disc(5.0) - Section([np.array([[0, 0], [9.0, -5.2], [9.0, 5.2]])])),
    "moon": lambda: _up(_disc(5.0) - _disc(4.6, 2.4)),
    "wave": _wave,
    "lines": lambda: _up(_bar(10, 1.4) + _bar(10, 1.4, 0, 3.5) + _bar(10, 1.4, 0, -3.5)),
    "hexagon": lambda: _up(_round(6, 4.6)),
    "triangle": lambda: _up(_round(3, 5.5)),
    "star": lambda: _up(_round(5, 5.5, 2.3)),
    "torus": _torus,
    "tube": lambda: _up(_disc(5.0) - _disc(3.8)),
    "shell": lambda: _up((_disc(5.0) - _disc(3.6)) ^ _bar(12, 12, 0, 6)),
    "pins": lambda: _up(_disc(2.2, 2.8) + _disc(2.2, -2.8)),
    "random": _random,
}
"""What the feet carry, each from z = 0 on, by name."""


def on_a_foot(name: str) -> Any:
    """The whole object, its foot from -6 mm to 0."""
    long, wide, high = FOOT_MM
    foot = M.cube((long, wide, high), True).translate((0.0, 0.0, -high / 2))
    # A little into the foot, so that both are one body.
    return foot + HEADS[name]().translate((0.0, 0.0, -1e-3))


def write_stl(body: Any, path: Path) -> Path:
    """A body of the set as an STL file."""
    mesh = body.to_mesh()
    points = np.asarray(mesh.vert_properties, dtype=np.float64)[:, :3]
    trimesh.Trimesh(points, np.asarray(mesh.tri_verts), process=False).export(path)
    return path
