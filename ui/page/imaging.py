"""Arrays to display images and colours, with legends and units."""

from __future__ import annotations

import html
from collections.abc import Sequence

import numpy as np

from ui.page.colours import AMBER
from workbench.view.colour_scale import viridis
from workbench.view.glb import Topology, write_glb
from workbench.view.section_cut import Plane, clip, packed

REST_SHARE = 0.05
"""Below this share of the maximum the colour of rest shows through."""


def heat_colours(share: np.ndarray, rest: tuple[int, int, int]) -> np.ndarray:
    """Viridis where something happens, the colour `rest` where nothing does, shape (N, 3) uint8."""
    strength = np.clip(share / REST_SHARE, 0.0, 1.0)[:, None]
    return ((1 - strength) * np.array(rest) + strength * viridis(share)).astype(np.uint8)


def coloured_glb(
    points: np.ndarray,
    faces: np.ndarray,
    colours: np.ndarray,
    plane: Plane | None = None,
    topology: Topology | None = None,
) -> bytes:
    """A mesh with an sRGB colour at each vertex as a GLB file with a matt material, cut or whole.

    Args:
        points: Vertices [mm], shape (N, 3).
        faces: Triangles, shape (M, 3).
        colours: Shape (N, 3), uint8.
        plane: What the mesh is cut by, if it is.
        topology: That of the whole mesh, where it is known.
    """
    cut = plane is not None
    if cut:
        kept = clip(points, faces, plane)
        points, faces, used = packed(kept.points_mm, kept.faces)
        colours = kept.carry(colours)[used]
        if not len(faces):
            # A file must have a mesh: a triangle without an area.
            points, faces = np.zeros((3, 3)), np.array([[0, 1, 2]])
            colours = np.zeros((3, 3), np.uint8)
        topology = None
    # Of a closed skin the back is seen only where it is cut.
    known = topology or Topology.of(faces, len(points))
    return write_glb(points, colours, known, both_sides=cut)


def placeholder(*lines: str, width_px: int = 320, height_px: int = 240) -> np.ndarray:
    """A dark image that stands where none has been rendered, and says what fills it."""
    image = np.full((height_px, width_px, 3), 34, np.uint8)
    if not lines:
        return image
    import cv2

    face, size, white = cv2.FONT_HERSHEY_SIMPLEX, 0.45, (175, 180, 188)
    top = height_px // 2 - 10 * (len(lines) - 1)
    for number, line in enumerate(lines):
        (wide, high), _ = cv2.getTextSize(line, face, size, 1)
        place = ((width_px - wide) // 2, top + high // 2 + 22 * number)
        cv2.putText(image, line, place, face, size, white, 1, cv2.LINE_AA)
    return image


def legend(
    title: str, high: float, unit: str, rest: tuple[int, int, int], *, badge: str = ""
) -> str:
    """A colour bar from 0 as HTML, in the colours of `heat_colours`; a badge is a warning."""
    stops = heat_colours(np.r_[0.0, 0.025, np.linspace(0.05, 1, 20)], rest)
    colours = ", ".join(f"rgb({r},{g},{b})" for r, g, b in stops)
    mark = (
        f" <span style='color:#000;background:{AMBER};border-radius:3px;padding:0 4px'>"
        f"{html.escape(badge)}</span>"
        if badge
        else ""
    )
    return (
        # Beside each other where there is room, else one below the other.
        "<div style='font-size:12px;margin:0 12px'><div style='display:flex;flex-wrap:wrap;"
        f"justify-content:space-between'><span>{html.escape(title)}{mark}</span>"
        f"<span>0 to {high:.3g} {html.escape(unit)}</span></div>"
        f"<div style='height:8px;border-radius:3px;background:linear-gradient(90deg,{colours})'>"
        "</div></div>"
    )


def scale_bar(low: float, high: float, unit: str, *, middle: float | None = None) -> str:
    """A bar of viridis from `low` to `high` as HTML, with the place of a middle value."""
    stops = ", ".join(f"rgb({r},{g},{b})" for r, g, b in viridis(np.linspace(0, 1, 21)))
    unit = "" if unit == "1" else f" {html.escape(unit)}"
    mark = number = ""
    if middle is not None and np.isfinite(middle):
        share = 100 * min(max((middle - low) / max(high - low, 1e-30), 0.0), 1.0)
        mark = (
            f"<div style='position:absolute;left:{share:.1f}%;top:-3px;width:2px;height:16px;"
            "background:#fff'></div>"
        )
        number = f"<span>median {middle:.3g}</span>"
    return (
        "<div style='font-size:12px;margin:4px 12px'>"
        f"<div style='position:relative;height:10px;border-radius:3px;"
        f"background:linear-gradient(90deg,{stops})'>{mark}</div>"
        "<div style='display:flex;justify-content:space-between;margin-top:4px'>"
        f"<span>{low:.3g}{unit}</span>{number}<span>{high:.3g}{unit}</span></div></div>"
    )


def swatch(colour: tuple[int, int, int], words: str) -> str:
    """A spot of a colour and what it means, as HTML."""
    r, g, b = colour
    return (
        "<div style='font-size:12px;margin:2px 12px'><span style='display:inline-block;width:10px;"
        f"height:10px;border-radius:2px;background:rgb({r},{g},{b})'></span> "
        f"{html.escape(words)}</div>"
    )


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Rows of text as an HTML table; a long one scrolls with its panel."""
    style = "padding:2px 5px;text-align:left"
    top = "".join(f"<th style='{style}'>{html.escape(cell)}</th>" for cell in head)
    body = "".join(
        "<tr>" + "".join(f"<td style='{style}'>{html.escape(cell)}</td>" for cell in row) + "</tr>"
        for row in rows
    )
    return (
        "<table style='font-size:12px;border-collapse:collapse;margin:4px 8px'>"
        f"<tr>{top}</tr>{body}</table>"
    )
