"""Draw the sheets of the pages about light: what each family sees, and the maps of one design.

`.venv/bin/python docs/optics_sheets.py` runs each preset through the pipeline (about five minutes;
the project folder keeps the results, so again takes seconds) and writes two sheets.
`docs/contact_sheet.png` has for each preset the image at rest, with a ball of 6 mm pressed 1 mm
deep where the family aims, a close-up of the change, and the normals that the camera sees.
`docs/maps.png` has the maps of one design on its skin.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cv2  # noqa: TID253 (a program of its own, not part of the package)
import numpy as np
from gallery import FAINT, FRAME, GROUND, GUTTER_PX, INK, blank, paste, save, window, write

from designs.family import family
from geometry.drawing.rendering import canvas, look, png, surface
from workbench.core.design.design import SensorDesign
from workbench.core.design.lighting import LightModel
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.maps import DesignerMaps, SkinMap
from workbench.core.result.results import Skin
from workbench.core.result.sensing import TactileFrames
from workbench.planning.plan import InlineRunner, evaluate, plan, results
from workbench.project.aim import default_target_mm
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.view.colour_scale import NOTHING_GREY, viridis
from workbench.view.image_views import View, looked, visible_change
from workbench.view.map_display import is_flag, map_look

FOLDER = Path(__file__).parent
PRESETS = ("geltip", "trunk", "paw", "thumb", "tentacle", "pad", "digitac")
MAPPED = "geltip"
BALL_MM, DEPTH_MM, FRAMES = 6.0, 1.0, 4
PHOTO_PX = (384, 288)
LINE_PX = 34
HEAD_PX = 46
MAP_PX = (314, 330)
MAPS_IN_A_ROW = 5
BAR_PX = (224, 12)
FINER = 2
"""Drawings are made this many times larger and averaged down, for smooth edges."""
EYE = np.array([1.0, 0.15, 0.7])
"""From where the skin is looked at; LED 1 lights the side that is seen."""
SHOWN = (
    "visible",
    "mm_per_pixel",
    "incidence",
    "separability",
    "illumination",
    "led_01",
    "resolvability",
    "sensitivity_depth",
    "sensitivity_force",
    "glare",
)
COLUMNS = (
    "At rest",
    "A 6 mm ball, 1 mm deep",
    "Change in the frame, about mid grey",
    "Normals: x, y, z in red, green, blue",
)


def computed(name: str, project: Project, *wanted: str) -> tuple[SensorDesign, dict[str, Any]]:
    """A preset and the stored results of its chain, computed where they are missing."""
    design = load_design(name).replace("optics.light_model", LightModel("hybrid"))
    press = Press(target_mm=default_target_mm(design), depth_mm=DEPTH_MM, frames=FRAMES)
    case = PressCase(indenter=Indenter(size_mm=BALL_MM), press=press)
    for outcome in evaluate(design, case, InlineRunner(project.store), wanted=wanted):
        print(f"{design.name:10} {outcome.stage:8} {outcome.seconds:6.1f} s", flush=True)
    calls = plan(design, case)
    return design, results(project.store, calls, ("mesh", "press", *wanted))


def contact_row(design: SensorDesign, frames: TactileFrames, force_N: float) -> np.ndarray:
    """One preset: image at rest, pressed, change and normals; shape (H, W, 3), BGR."""
    normals = looked(View.NORMALS, frames.rgb, FRAMES, frames)
    pressed = frames.rgb[FRAMES].copy()
    low, high = window(np.abs(pressed.astype(np.int16) - frames.rgb[0]))
    rows, columns = slice(low[1], high[1]), slice(low[0], high[0])
    # Of the close-up alone: a few grey levels all over the image would ask for too much gain.
    close, gain = visible_change(pressed[rows, columns], frames.rgb[0][rows, columns])
    cv2.rectangle(pressed, low, high, FRAME, round(pressed.shape[1] / PHOTO_PX[0]))
    images = (frames.rgb[0], pressed, close, normals.rgb)
    width = len(images) * (PHOTO_PX[0] + GUTTER_PX) - GUTTER_PX
    row = blank((width, LINE_PX + PHOTO_PX[1]))
    write(row, f"{family(design.family).title} ({design.name})", (4, 24), 19, INK, weight=600)
    for column, (rgb, text) in enumerate(
        zip(images, ("", f"{force_N:.2f} N", f"× {gain}", ""), strict=True)
    ):
        x = column * (PHOTO_PX[0] + GUTTER_PX)
        write(row, text, (x + 4, 24), 17, FAINT)
        paste(row, fitted(rgb), (x, LINE_PX))
    return row


def fitted(rgb: np.ndarray) -> np.ndarray:
    """The whole image in the middle of a cell; shape (H, W, 3), BGR."""
    height, width = rgb.shape[:2]
    scale = min(PHOTO_PX[0] / width, PHOTO_PX[1] / height)
    size = round(width * scale), round(height * scale)
    how = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_CUBIC
    small = cv2.resize(np.ascontiguousarray(rgb[..., ::-1]), size, interpolation=how)
    cell = np.full((PHOTO_PX[1], PHOTO_PX[0], 3), GROUND, dtype=np.uint8)
    paste(cell, small, ((PHOTO_PX[0] - size[0]) // 2, (PHOTO_PX[1] - size[1]) // 2))
    return cell


def contact_sheet(rows: Sequence[np.ndarray]) -> np.ndarray:
    """All presets below each other, under the names of the columns."""
    head = blank((rows[0].shape[1], HEAD_PX))
    for column, text in enumerate(COLUMNS):
        write(head, text, (column * (PHOTO_PX[0] + GUTTER_PX) + 4, 30), 19, INK)
    return framed([head, *rows])


def framed(parts: Sequence[np.ndarray]) -> np.ndarray:
    """Parts below each other on white, with a margin."""
    height = sum(part.shape[0] + GUTTER_PX for part in parts) + GUTTER_PX
    canvas = blank((parts[0].shape[1] + 2 * GUTTER_PX, height))
    y = GUTTER_PX
    for part in parts:
        paste(canvas, part, (GUTTER_PX, y))
        y += part.shape[0] + GUTTER_PX
    return canvas


def map_sheet(design: SensorDesign, maps: DesignerMaps, skin: Skin) -> np.ndarray:
    """The maps of one design on its skin, in rows."""
    cells = [map_cell(maps.named(name), skin) for name in SHOWN]
    rows = [
        np.hstack(cells[start : start + MAPS_IN_A_ROW])
        for start in range(0, len(cells), MAPS_IN_A_ROW)
    ]
    head = blank((rows[0].shape[1], HEAD_PX))
    text = f"{family(design.family).title} ({design.name}): where on its skin it sees, and how well"
    write(head, text, (10, 30), 21, INK, weight=600)
    return framed([head, *rows])


def map_cell(found: SkinMap, skin: Skin) -> np.ndarray:
    """One map: label, skin in colours, bar with its unit, median and score."""
    shown = map_look(found)
    cell = blank((MAP_PX[0], MAP_PX[1] + 132))
    write(cell, found.label, (10, 24), 19, INK, weight=600)
    paste(cell, coloured(skin, shown.colours), (0, 34))
    y = MAP_PX[1] + 44
    if is_flag(found):
        flag_key(cell, y)
        middle = ""
    else:
        bar(cell, y, shown.low, shown.high, found.unit)
        middle = f"median {number(shown.middle)} {unit(found)}".rstrip()
    write(cell, middle, (10, y + 56), 16, INK)
    write(cell, f"{found.score_name}: {number(found.score)}", (10, y + 76), 12, FAINT)
    return cell


def coloured(skin: Skin, colours: np.ndarray) -> np.ndarray:
    """The skin with a colour at each vertex (V, 3), uint8; shape (H, W, 3), BGR."""
    plotter = canvas((FINER * MAP_PX[0], FINER * MAP_PX[1]))
    body = surface(skin.points_mm, skin.faces)
    body["colours"] = colours
    plotter.add_mesh(
        body, scalars="colours", rgb=True, smooth_shading=True, ambient=0.75, diffuse=0.3
    )
    look(plotter, EYE, skin.points_mm)
    fine = cv2.imdecode(png(plotter), cv2.IMREAD_COLOR)
    assert fine is not None
    return cv2.resize(fine, MAP_PX, interpolation=cv2.INTER_AREA)


def bar(cell: np.ndarray, y: int, low: float, high: float, unit_words: str) -> None:
    """The scale of colours with its ends and its unit."""
    x = (MAP_PX[0] - BAR_PX[0]) // 2
    colours = viridis(np.linspace(0.0, 1.0, BAR_PX[0]))[None, :, ::-1]
    paste(cell, np.repeat(colours, BAR_PX[1], axis=0), (x, y))
    write(cell, number(low), (x, y + 30), 15, INK)
    middle = "" if unit_words == "1" else unit_words
    for text, place in ((middle, x + BAR_PX[0] / 2), (number(high), x + BAR_PX[0])):
        width = 7.5 * len(text)
        start = place - width / (2.0 if text == middle else 1.0)
        write(cell, text, (round(start), y + 30), 15, INK)


def flag_key(cell: np.ndarray, y: int) -> None:
    """What the two colours of a map of yes and no mean."""
    yes = tuple(int(c) for c in viridis(np.array(1.0))[::-1])
    for x, colour, text in ((40, yes, "seen"), (160, NOTHING_GREY, "blind")):
        cv2.rectangle(cell, (x, y), (x + 22, y + 14), colour, cv2.FILLED)
        write(cell, text, (x + 30, y + 13), 15, INK)


def number(value: float) -> str:
    """Three digits, without an exponent."""
    return f"{value:.3g}"


def unit(found: SkinMap) -> str:
    """The unit for people; none where it is 1."""
    return "" if found.unit == "1" else found.unit


def main() -> None:
    """Write both sheets."""
    # Taichi greets on stdout when it is imported.
    os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "0")
    project = Project()
    rows = []
    for name in PRESETS:
        design, found = computed(name, project, "shoot")
        force_N = float(found["press"].normal_N[-1])
        rows.append(contact_row(design, found["shoot"].frames, force_N))
    save(contact_sheet(rows), FOLDER / "contact_sheet.png")
    design, found = computed(MAPPED, project, "maps")
    save(map_sheet(design, found["maps"], found["mesh"].seen), FOLDER / "maps.png")


if __name__ == "__main__":
    main()
