"""Draw the gallery of README and designs: each family's membrane, parts and image.

`.venv/bin/python docs/gallery.py` runs each preset through the pipeline (about three minutes; the
project folder keeps the results, so again takes seconds) and writes `docs/gallery.png`. Each row
has the membrane, the mould and the sensor drawn apart, and the tactile image of a 1 mm press with
an 8 mm sphere where the family aims, with a close-up of its change from the untouched one.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import cv2  # noqa: TID253 (a program of its own, not part of the package)
import numpy as np

from designs.family import eye, family
from geometry.drawing.sensor_drawings import exploded_sensor, membrane_drawing
from workbench.core.design.design import SensorDesign
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.planning.plan import InlineRunner, evaluate, plan, results
from workbench.project.aim import default_target_mm
from workbench.project.named_designs import load_design
from workbench.project.project import Project

PICTURE = Path(__file__).with_name("gallery.png")
PRESETS = ("geltip", "trunk", "paw", "thumb", "tentacle", "pad", "digitac")
WANTED = ("shoot", "mould", "housing")
SPHERE_MM = 8.0
DEPTH_MM = 1.0
FRAMES = 4
ROW_PX = (1084, 232)
GUTTER_PX = 14
MARGIN_PX = 20
TITLE_PX = 40
MEMBRANE_PX = (188, 180)
PARTS_PX = (366, 220)
IMAGE_PX = (220, 165)
FINER = 2
"""Drawings are made this many times larger and averaged down, for smooth edges."""
MOST_GAIN = 8
SPREADS = 3.5
"""Half of the close-up's width, in root mean square distances of what changed."""
LEAST_SHARE = 0.2
"""Of the image's width, for the close-up."""
FRAME = (255, 255, 255)
GROUND = (247, 245, 243)
INK = (52, 44, 36)
FAINT = (110, 100, 90)
LEGEND = (
    ("Membrane, the soft skin", "#f08a6c"),
    ("Actuator surfaces", "#5b8def"),
    ("Outer parts of the mould", "#8299b3"),
    ("Core of the mould", "#e6cf86"),
    ("Support, clear resin", "#a9d6ea"),
    ("LED ring holder", "#4c9a6a"),
    ("Base and camera mount", "#565d66"),
    ("Sliders of the actuators", "#e0a030"),
)


def computed(name: str, project: Project) -> tuple[SensorDesign, dict[str, Any]]:
    """A preset and the stored results of its chain, computed where they are missing."""
    design = load_design(name)
    press = Press(target_mm=default_target_mm(design), depth_mm=DEPTH_MM, frames=FRAMES)
    case = PressCase(indenter=Indenter(size_mm=SPHERE_MM), press=press)
    for outcome in evaluate(design, case, InlineRunner(project.store), wanted=WANTED):
        print(f"{design.name:10} {outcome.stage:8} {outcome.seconds:6.1f} s", flush=True)
    calls = plan(design, case)
    return design, results(project.store, calls, calls)


def row(design: SensorDesign, found: Mapping[str, Any]) -> np.ndarray:
    """One family: membrane, parts, tactile image and its change; shape (H, W, 3), BGR."""
    solid, rgb = found["build"], found["shoot"].frames.rgb
    canvas = blank(ROW_PX)
    write(canvas, family(design.family).title, (MARGIN_PX, 32), 22, INK, weight=600)
    paste(
        canvas,
        drawn(membrane_drawing, (solid,), MEMBRANE_PX, clear=False, eye=eye(design.family)),
        (MARGIN_PX, TITLE_PX + 4),
    )
    x = MARGIN_PX + MEMBRANE_PX[0] + GUTTER_PX
    parts = drawn(exploded_sensor, (solid, found["mould"], found["housing"]), PARTS_PX)
    paste(canvas, parts, (x, (ROW_PX[1] - PARTS_PX[1]) // 2))
    difference, gain = change(rgb)
    low, high = window(difference)
    framed = cv2.rectangle(rgb[-1].copy(), low, high, FRAME, round(rgb.shape[2] / IMAGE_PX[0]))
    close = difference[low[1] : high[1], low[0] : high[0]]
    force = f"{DEPTH_MM:g} mm press: {found['press'].normal_N[-1]:.2f} N"
    x += PARTS_PX[0] + GUTTER_PX
    for image, text in ((framed, force), (close, f"Change in the frame, x {gain}")):
        fitted = fit(image)
        paste(canvas, fitted, (x, 20 + (IMAGE_PX[1] - fitted.shape[0]) // 2))
        write(canvas, text, (x, ROW_PX[1] - 18), 16, FAINT)
        x += IMAGE_PX[0] + GUTTER_PX
    return canvas


def change(rgb: np.ndarray) -> tuple[np.ndarray, int]:
    """Absolute difference of the last image from the background, and how much it is amplified.

    The most changed thousandth of the pixels may saturate.
    """
    difference = np.abs(rgb[-1].astype(np.int16) - rgb[0])
    gain = min(MOST_GAIN, int(255 // max(np.percentile(difference, 99.9), 1.0)))
    return np.minimum(gain * difference, 255).astype(np.uint8), gain


def window(difference: np.ndarray) -> tuple[tuple[int, int], tuple[int, int]]:
    """Corners of a part of the image about what changed, of the image's proportions [px]."""
    height, width = difference.shape[:2]
    weight = difference.sum(axis=2, dtype=np.float64) ** 2
    y, x = (np.average(grid, weights=weight) for grid in np.indices((height, width)))
    rows, columns = np.indices((height, width))
    spread = np.sqrt(np.average((rows - y) ** 2 + (columns - x) ** 2, weights=weight))
    half = float(np.clip(SPREADS * spread / width, LEAST_SHARE / 2.0, 0.5))
    left = int(np.clip(x - half * width, 0, width - 2.0 * half * width))
    top = int(np.clip(y - half * height, 0, height - 2.0 * half * height))
    return (left, top), (left + int(2.0 * half * width), top + int(2.0 * half * height))


def legend() -> np.ndarray:
    """The last row: what the colours mean."""
    columns = 4
    canvas = blank((ROW_PX[0], 88))
    for number, (text, colour) in enumerate(LEGEND):
        line, column = divmod(number, columns)
        x = MARGIN_PX + column * (ROW_PX[0] - MARGIN_PX) // columns
        y = 35 + 34 * line
        cv2.rectangle(canvas, (x, y - 15), (x + 24, y + 3), bgr(colour), cv2.FILLED)
        write(canvas, text, (x + 36, y), 17, INK)
    return canvas


def drawn(
    draw: Callable[..., np.ndarray], bodies: Sequence[Any], size_px: tuple[int, int], **how: Any
) -> np.ndarray:
    """A drawing made finer than needed and averaged down; shape (H, W, 3), BGR."""
    width, height = size_px
    fine = cv2.imdecode(draw(*bodies, (FINER * width, FINER * height), **how), cv2.IMREAD_COLOR)
    assert fine is not None
    return cv2.resize(fine, size_px, interpolation=cv2.INTER_AREA)


def fit(rgb: np.ndarray) -> np.ndarray:
    """The whole image, as large as its cell allows."""
    height, width = rgb.shape[:2]
    scale = min(IMAGE_PX[0] / width, IMAGE_PX[1] / height)
    size = round(width * scale), round(height * scale)
    how = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_CUBIC
    return cv2.resize(np.ascontiguousarray(rgb[..., ::-1]), size, interpolation=how)


def blank(size_px: tuple[int, int]) -> np.ndarray:
    return np.full((size_px[1], size_px[0], 3), 255, dtype=np.uint8)


def paste(canvas: np.ndarray, part: np.ndarray, corner: tuple[int, int]) -> None:
    x, y = corner
    canvas[y : y + part.shape[0], x : x + part.shape[1]] = part


def write(
    canvas: np.ndarray,
    text: str,
    corner: tuple[int, int],
    size_px: int,
    colour: tuple[int, int, int],
    weight: int = 400,
) -> None:
    cv2.putText(canvas, text, corner, colour, cv2.FontFace("sans"), size_px, weight)


def bgr(colour: str) -> tuple[int, int, int]:
    red, green, blue = bytes.fromhex(colour[1:])
    return blue, green, red


def page(rows: Sequence[np.ndarray]) -> np.ndarray:
    """The rows below each other on a grey ground."""
    height = sum(row.shape[0] + GUTTER_PX for row in rows) + GUTTER_PX
    canvas = np.full((height, ROW_PX[0] + 2 * GUTTER_PX, 3), GROUND, dtype=np.uint8)
    y = GUTTER_PX
    for each in rows:
        paste(canvas, each, (GUTTER_PX, y))
        y += each.shape[0] + GUTTER_PX
    return canvas


def save(canvas: np.ndarray, path: Path) -> None:
    """Write an image as a small PNG, and say how small."""
    compact = [cv2.IMWRITE_PNG_COMPRESSION, 9]
    compact += [cv2.IMWRITE_PNG_STRATEGY, cv2.IMWRITE_PNG_STRATEGY_FILTERED]
    path.write_bytes(cv2.imencode(".png", canvas, compact)[1].tobytes())
    print(f"{path}: {path.stat().st_size / 1000:.0f} kB")


def main() -> None:
    """Write the gallery."""
    # Taichi greets on stdout when it is imported.
    os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "0")
    project = Project()
    rows = [row(*computed(name, project)) for name in PRESETS]
    save(page([*rows, legend()]), PICTURE)


if __name__ == "__main__":
    main()
