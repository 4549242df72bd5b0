"""X, Y and Z of a field on the deformed skin: predicted, by finite elements, and their difference.

As in the paper's Fig. 6a and 13, in 3D: the skin about the press, moved as finite elements say,
seen from outside along the normal and a little from above. Blue is negative, red positive, white
nothing. A row has one scale, the largest by finite elements; the difference is drawn `GAIN` times
as strong.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.learning.dataset.folder import SkinData
from workbench.learning.dataset.sample import Sample

TILE_PX = 250
GAIN = 4.0
"""By how much differences are drawn stronger."""
LEAST = 0.02
"""Least scale of a row over the largest number of all three: an axis along which next to nothing
happens is not blown up."""
GROUND = (0.87, 0.89, 0.92)
"""Behind the skin, whose zero is white."""
NEAR_MM = 7.0
"""Half the width of the skin that fills a tile [mm]."""
RISE = 0.55
"""How far the eye is above the normal."""
LINE_PX = 20
INK = (40, 40, 40)
ENDS = np.array([(33, 82, 180), (120, 168, 232), (246, 246, 244), (236, 148, 118), (172, 30, 44)])
"""Colours from -1 to 1."""
AXES = "XYZ"
COLUMNS = ("learned", "finite elements", f"difference x {GAIN:g}")


@dataclass(frozen=True, kw_only=True, slots=True)
class Pair:
    """One field of one sample as two say it."""

    sample: Sample
    found: np.ndarray
    """Vectors at the vertices, shape (V, 3)."""
    truth: np.ndarray
    moved_mm: np.ndarray
    """Displacement by finite elements [mm], shape (V, 3)."""
    unit: str
    """Of the field."""


def diverging(share: np.ndarray) -> np.ndarray:
    """Colours (..., 3) uint8 of values in [-1, 1]; beyond, the ends'."""
    places = np.linspace(-1.0, 1.0, len(ENDS))
    mixed = [np.interp(share, places, ENDS[:, channel]) for channel in range(3)]
    return np.rint(np.stack(mixed, axis=-1)).astype(np.uint8)


def heat_map(skin: SkinData, pair: Pair) -> np.ndarray:
    """A sheet of three rows (X, Y, Z) and three columns, sRGB, shape (H, W, 3), uint8.

    Raises:
        DeviceError: If nothing here can render.
    """
    rows = [np.concatenate([_caption(text) for text in COLUMNS], axis=1)]
    largest = float(np.abs(pair.truth).max(initial=0.0))
    for axis, name in enumerate(AXES):
        found, truth = pair.found[:, axis], pair.truth[:, axis]
        scale = max(float(np.abs(truth).max(initial=0.0)), LEAST * largest, 1e-30)
        shares = (found / scale, truth / scale, GAIN * (found - truth) / scale)
        tiles = [_tile(skin, pair, diverging(share)) for share in shares]
        rows.append(np.concatenate(tiles, axis=1))
        most = [float(np.abs(values).max()) for values in (found, truth, found - truth)]
        words = [f"{name}: largest {_number(value, pair.unit)}" for value in most]
        words[1] += f", scale {_number(scale, pair.unit)}"
        rows.append(np.concatenate([_caption(text) for text in words], axis=1))
    return np.concatenate([*rows, _scale_bar()])


def _number(value: float, unit: str) -> str:
    return f"{1e3 * value:.3g} m{unit}" if unit == "N" else f"{value:.3g} {unit}"


def _tile(skin: SkinData, pair: Pair, colours: np.ndarray) -> np.ndarray:
    """The skin in these colours, shape (TILE_PX, TILE_PX, 3), uint8."""
    import cv2

    from geometry.drawing.rendering import canvas, look, png, surface

    eye = _eye(pair.sample.normal)
    body = surface(skin.points_mm + pair.moved_mm, skin.faces)
    body["colours"] = colours
    plotter = canvas((TILE_PX, TILE_PX))
    plotter.set_background(GROUND)
    plotter.add_mesh(
        body,
        scalars="colours",
        rgb=True,
        smooth_shading=True,
        ambient=0.55,
        diffuse=0.5,
        specular=0.0,
        show_scalar_bar=False,
    )
    offsets = NEAR_MM * np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
    across, up = _across(eye)
    flat = offsets[:, :1] * across + offsets[:, 1:2] * up
    look(plotter, eye, pair.sample.target_mm + flat)
    return np.asarray(cv2.imdecode(png(plotter), cv2.IMREAD_COLOR))[..., ::-1]


def _eye(normal: np.ndarray) -> np.ndarray:
    """Direction to the eye: a little above the normal, or before a skin that looks up."""
    lift = np.array([0.0, 0.0, 1.0]) if abs(normal[2]) < 0.7 else np.array([0.0, -1.0, 0.0])
    eye = normal + RISE * lift
    return eye / np.linalg.norm(eye)


def _across(eye: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    from geometry.drawing.rendering import screen_axes

    return screen_axes(eye)


def _caption(text: str) -> np.ndarray:
    import cv2

    tile = np.full((LINE_PX, TILE_PX, 3), 255, np.uint8)
    place = (6, LINE_PX - 6)
    cv2.putText(tile, text, place, cv2.FONT_HERSHEY_SIMPLEX, 0.42, INK, 1, cv2.LINE_AA)
    return tile


def _scale_bar() -> np.ndarray:
    """Colours from the largest negative to the largest positive number of the finite elements."""
    width = 3 * TILE_PX
    bar = np.full((2 * LINE_PX, width, 3), 255, np.uint8)
    share = np.linspace(-1.0, 1.0, TILE_PX)
    bar[6:LINE_PX, TILE_PX : 2 * TILE_PX] = diverging(share)
    for number, text in enumerate(("-1", "0", "+1  of the row's scale")):
        _write(bar, text, (TILE_PX - 8 + number * (TILE_PX // 2), 2 * LINE_PX - 5))
    return bar


def _write(image: np.ndarray, text: str, place: tuple[int, int]) -> None:
    import cv2

    cv2.putText(image, text, place, cv2.FONT_HERSHEY_SIMPLEX, 0.4, INK, 1, cv2.LINE_AA)
