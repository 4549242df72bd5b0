"""Drawings of a sensor: the membrane, the exploded view, and a skin coloured by a field.

All are PNG bytes, shape (bytes,), uint8, drawn off-screen; each raises DeviceError where nothing
can render.
"""

from __future__ import annotations

import numpy as np

from geometry.drawing.exploded import exploded
from geometry.drawing.rendering import canvas, draw, look, png, surface
from workbench.core.result.fabrication import HousingSet, MouldSet
from workbench.core.result.results import Label, LabelledSurface, Skin, Solid

SIZE_PX = (1200, 900)
MEMBRANE_PX = (480, 480)
EYE = np.array([1.6, 1.8, 0.9])
"""Direction from the body to the eye; most families aim at +Y."""
COLOURS = {
    "membrane": "#f08a6c",
    "support": "#a9d6ea",
    "led_ring_holder": "#4c9a6a",
    "housing_base": "#565d66",
    "camera_mount": "#8a919b",
    "core": "#e6cf86",
}
MOULD_COLOURS = ("#b7c9dd", "#8299b3", "#c9d6c4", "#9db39a")
"""Outer parts of a mould in their order."""
SLIDER = "#e0a030"
GLASS = 0.45
"""Opacity of what is transparent."""
CLEAR = 0.3
"""Opacity of a membrane whose pins shall show."""
ACTUATORS = ("#5b8def", "#8d6fe0", "#3fb8a5", "#d9679f")
"""Actuator regions by number, then again from the first."""
SMOOTH = ("membrane", "support")
"""Parts drawn without lines along their edges: slivers of their many triangles would be lines."""
PIN = "#27384d"
LEGEND_SHARE = 0.24
"""Share of the drawing's width that the colour bar takes."""


def membrane_drawing(
    solid: Solid,
    size_px: tuple[int, int] = MEMBRANE_PX,
    *,
    clear: bool = True,
    eye: tuple[float, float, float] | None = None,
) -> np.ndarray:
    """The membrane, actuator regions tinted; one with pins is clear, so that they show.

    Args:
        clear: Whether the ground is transparent instead of white.
        eye: Direction from the body to the eye, where it is not `EYE`.
    """
    membrane = solid.membrane
    pins, driven = membrane.has(Label.PIN), membrane.has(Label.ACTUATOR)
    plotter = canvas(size_px)
    seen = membrane.has(Label.OUTER) if pins.any() else np.ones(len(pins), dtype=bool)
    opacity = CLEAR if pins.any() else 1.0
    _draw_faces(plotter, membrane, seen & ~driven & ~pins, COLOURS["membrane"], opacity)
    for number in np.unique(membrane.numbers[driven]):
        chosen = driven & (membrane.numbers == number)
        _draw_faces(plotter, membrane, chosen, ACTUATORS[int(number) % len(ACTUATORS)], opacity)
    _draw_faces(plotter, membrane, pins, PIN, 1.0)
    look(plotter, EYE if eye is None else np.array(eye), membrane.points_mm)
    return png(plotter, clear=clear)


def _draw_faces(
    plotter: object, membrane: LabelledSurface, chosen: np.ndarray, colour: str, opacity: float
) -> None:
    if chosen.any():
        faces = membrane.faces[chosen]
        draw(plotter, membrane.points_mm, faces, colour, opacity=opacity, edges=False)


def exploded_sensor(
    solid: Solid,
    moulds: MouldSet,
    housing: HousingSet,
    size_px: tuple[int, int] = SIZE_PX,
) -> np.ndarray:
    """The mould drawn apart, and beside it the parts of the sensor as a stack."""
    plotter = canvas(size_px)
    places = exploded(solid, moulds, housing, EYE)
    # The mould's names first: its core has a colour of its own and keeps it.
    outer = {p.name: MOULD_COLOURS[k % len(MOULD_COLOURS)] for k, p in enumerate(moulds.parts)}
    colours = {**outer, **COLOURS}
    for place in places:
        colour = colours.get(place.name, SLIDER)
        opacity = GLASS if place.name == "support" else 1.0
        edges = place.name not in SMOOTH
        draw(plotter, place.points_mm, place.faces, colour, opacity=opacity, edges=edges)
    look(plotter, EYE, np.concatenate([place.points_mm for place in places]))
    return png(plotter)


def skin_field(
    skin: Skin,
    values: np.ndarray,
    label: str,
    size_px: tuple[int, int] = SIZE_PX,
    *,
    eye: np.ndarray = EYE,
) -> np.ndarray:
    """A skin coloured by one value at each vertex, pale to dark from 0, with a colour bar.

    Args:
        values: Shape (V,).
        label: Name and unit of the values, for the bar.
        eye: Direction from the skin to the eye.
    """
    values = np.asarray(values, dtype=np.float64)
    plotter = canvas(size_px)
    bar = {
        "title": f"{label}\n",
        "color": "black",
        "vertical": True,
        "position_x": 0.82,
        "position_y": 0.1,
        "height": 0.8,
        "width": 0.05,
        "title_font_size": round(size_px[1] / 36),
        "label_font_size": round(size_px[1] / 42),
        "fmt": "%.2g",
    }
    plotter.add_mesh(
        surface(skin.points_mm, skin.faces),
        scalars=values,
        cmap="YlGnBu",
        clim=(min(0.0, float(values.min())), float(values.max())),
        smooth_shading=True,
        ambient=0.3,
        diffuse=0.8,
        scalar_bar_args=bar,
    )
    look(plotter, eye, skin.points_mm, (0.0, LEGEND_SHARE))
    return png(plotter)
