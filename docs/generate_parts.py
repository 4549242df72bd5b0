"""Write `parts.md`: the catalogue of cameras and LEDs, with where each value is from."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from workbench.core.catalogue.camera_part import CameraPart, camera_parts
from workbench.core.catalogue.led_part import LedPart, led_parts

HEAD = """# Cameras and LEDs that can be bought

Made from the program by `make docs`. `workbench run pad --camera raspberry_pi_2 --led
kingbright_apt1608ec,qilste_f312qtcg,kingbright_kp1608pbc` takes a camera and LEDs, one for each
sector of the ring; in the browser **Module** and **LED type** of *Optics* do. Fields that are set
(`--set`) come after. What no source says is left open here, and is left as it is in the design.
The list is a file for each: `workbench/core/catalogue/cameras/`, `workbench/core/catalogue/leds/`.
"""
CAMERAS = """## Cameras

A camera sets pixels, field of view, projection, pupil (focal length over f-number), full well, and
as the first camera the room of its module in the housing. Images are those of a mode that sees the
whole field of view. The projection is the one that fits focal length and fields of view better.
"""
LEDS = """## LEDs

An LED sets the colours of the ring by peak (else dominant) wavelength and bandwidth, or by colour
temperature; the exponent of its lobe by the angle between half intensities; and its room in the
housing. No maker says how large the part is that shines: it stays as it is. Of a range the middle.
"""
Cell = Callable[[Any], str]


def page() -> str:
    """The whole page."""
    parts = [HEAD, CAMERAS, _table(camera_parts(), _CAMERA), LEDS, _table(led_parts(), _LED)]
    return "\n".join(parts)


def _table(parts: Mapping[str, Any], columns: Mapping[str, Cell]) -> str:
    head = [*columns, "source"]
    lines = [_row(["name", *head]), _row(["---"] * (1 + len(head)))]
    for name, part in parts.items():
        cells = [cell(part) for cell in columns.values()]
        lines.append(_row([f"`{name}`", *cells, "; ".join(_sources(part))]))
    return "\n".join([*lines, ""])


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _sources(part: CameraPart | LedPart) -> Iterator[str]:
    """The address of all, then those of single fields."""
    yield f"[sheet]({part.source})"
    for field in dataclasses.fields(part):
        if field.name in part.sources:
            yield f"`{field.name}` [here]({part.sources[field.name]})"


def _number(*values: float | None) -> str:
    known = [f"{value:g}" for value in values if value is not None]
    return " x ".join(known) if len(known) == len(values) else ""


def _numbers(values: Sequence[float]) -> str:
    return ", ".join(f"{value:g}" for value in values)


_CAMERA: dict[str, Cell] = {
    "camera": lambda part: part.title,
    "image sensor": lambda part: part.image_sensor,
    "pixels": lambda part: _number(*part.pixels),
    "image px": lambda part: _number(*part.image_px),
    "view deg": lambda part: _number(part.view_x_deg, part.view_y_deg) or _number(part.view_x_deg),
    "lens": lambda part: part.lens.value,
    "focal mm": lambda part: _number(part.focal_mm),
    "f-number": lambda part: _number(part.stop),
    "module mm": lambda part: (
        _number(part.width_mm, part.height_mm, part.depth_mm)
        or _number(part.width_mm, part.height_mm)
    ),
}
_LED: dict[str, Cell] = {
    "LED": lambda part: part.title,
    "light": lambda part: ", ".join(part.light),
    "body mm": lambda part: _number(part.width_mm, part.height_mm, part.thick_mm),
    "half to half deg": lambda part: _number(part.view_deg),
    "peak nm": lambda part: _numbers(part.peak_nm),
    "dominant nm": lambda part: _numbers(part.dominant_nm),
    "band nm": lambda part: _numbers(part.band_nm),
    "white": lambda part: (
        _numbers(part.chromaticity or ()) if part.kelvin is None else f"{part.kelvin:g} K"
    ),
    "mcd": lambda part: _numbers(part.intensity_mcd),
    "at mA": lambda part: _number(part.current_mA),
}
