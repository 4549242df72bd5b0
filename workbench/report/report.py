"""One self-contained HTML page of a run: images, force curve, numbers, mould, every parameter."""

from __future__ import annotations

import html
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from workbench.core.base.errors import DeviceError
from workbench.core.base.mapping import to_table
from workbench.core.design.design import SensorDesign
from workbench.core.press.press import Press
from workbench.core.result.results import MembraneMesh, Picture, Skin, Solid
from workbench.core.result.sensing import Contact, Shot
from workbench.project.design_toml import design_table
from workbench.report.html_page import figure, page, table
from workbench.report.image_files import png_bytes
from workbench.view.forces import slip_columns
from workbench.view.press_figures import frame_depths_mm

NO_RENDERER = "<p>No drawing: this machine has no off-screen renderer (libegl1).</p>"
EXPLODED = (
    "Exploded view. Left the mould: outer parts and core. Right the sensor, from the top: "
    "membrane, support, LED ring holder, base, camera mount."
)


@dataclass(frozen=True, kw_only=True, slots=True)
class Drawings:
    """PNG files drawn for the report; None where nothing can render."""

    membrane: bytes | None
    pressed: bytes | None
    """Displacement on the pressed membrane."""
    parts: bytes | None
    """Exploded view of mould and sensor."""


def report_html(
    design: SensorDesign,
    path: Press,
    summary: Mapping[str, Any],
    shot: Shot,
    contact: Contact,
    drawings: Drawings,
) -> str:
    """The report as one page without outside links."""
    force = summary["contact"]
    title = f"{design.name} ({design.family})"
    pressed = (
        f"Pressed {path.depth_mm:g} mm: <b>{force['normal_N']:.3f} N</b> along the normal, "
        f"residual {force['residual']:.1e}, force balance {100 * force['force_balance']:.2f} %, "
        f"penetration {1e3 * force['penetration_mm']:.0f} um; {force['particles']} material "
        f"points on a {force['grid_mm']:g} mm grid, {force['substeps']} substeps, computed on "
        f"{html.escape(summary['device'])} in {force['seconds']:.1f} s."
    )
    sections = [
        f"<h1>{html.escape(title)}</h1><p>{pressed}</p>",
        "<h2>Tactile image</h2>" + _images(shot),
        "<h2>Force against depth</h2>" + _force_curve(path, contact),
        _drives(path, contact),
        "<h2>Displacement</h2>" + _drawn(drawings.pressed, "Outer skin in the last frame"),
        "<h2>Score card</h2>" + table(sorted(summary["metrics"].items())),
        "<h2>Mould and sensor</h2>" + _drawn(drawings.parts, EXPLODED),
        table(
            (m["file"], f"{m['volume_mm3']:.0f} mm3, {'closed' if m['watertight'] else 'OPEN'}")
            for m in summary["moulds"]
        ),
        "<h2>Design</h2>" + _drawn(drawings.membrane, "Membrane", width=310),
        table([*_flat(design_table(design)), *_constants(design)]),
        "<h2>Press</h2>" + table(_flat(_press_table(path))),
        "<h2>Files beside this page</h2>" + table(_files(contact)),
        "<h2>Stages</h2>"
        + table(
            (s["stage"], f"{'cached' if s['cached'] else format(s['seconds'], '.2f') + ' s'}")
            for s in summary["stages"]
        ),
    ]
    return page(title, "\n".join(sections))


def _drives(path: Press, contact: Contact) -> str:
    """What the drives and the object feel in each frame; nothing where nothing is driven."""
    if not path.actuations:
        return ""
    names = [actuation.region for actuation in path.actuations]
    head = [
        "frame",
        *(f"{name} x, y, z [N]" for name in names),
        "object x, y, z [N]",
        "pressed [N]",
    ]
    lines = []
    for k, reaction in enumerate(contact.reaction_N):
        vectors = (*contact.actuator_N[k], reaction)
        cells = [", ".join(f"{x:.3f}" for x in np.round(v, 3) + 0.0) for v in vectors]
        row = (str(k + 1), *cells, f"{contact.pressing_N[k]:.3f}")
        lines.append("<tr>" + "".join(f"<td class='n'>{cell}</td>" for cell in row) + "</tr>")
    heading = "".join(f"<th>{html.escape(text)}</th>" for text in head)
    return f"<h2>Driven parts</h2><table><tr>{heading}</tr>{''.join(lines)}</table>"


def _files(contact: Contact) -> list[tuple[str, str]]:
    """The files that hold the press, and what is in them."""
    rows = [
        ("forces.csv", "forces, moments, penetration and residual of every frame"),
        ("slip.csv", "tangential over normal force against the way sideways"),
        ("poses.csv", "poses of what moved"),
        ("contact.npz", "fields of every frame as arrays"),
        ("contact.pvd", "the same fields for ParaView, one contact_*.vtp for each frame"),
        ("summary.json", "numbers and checks for programs"),
    ]
    return [row for row in rows if row[0] != "slip.csv" or slip_columns(contact) is not None]


def _constants(design: SensorDesign) -> list[tuple[str, float]]:
    """The elastomer as finite element programs ask for it."""
    from sim.material import elastic_solid

    solid = elastic_solid(design.material)
    return [("elastomer C10 [MPa]", solid.c10_MPa), ("elastomer D1 [1/MPa]", solid.d1_per_MPa)]


def _images(shot: Shot) -> str:
    rgb = shot.frames.rgb
    change = np.abs(rgb[-1].astype(np.int16) - rgb[0].astype(np.int16)).astype(np.uint8)
    gain = 1 if change.max() == 0 else min(8, 255 // int(change.max()))
    images = [
        (rgb[0], "Background: nothing touches"),
        (rgb[-1], f"Frame {len(rgb) - 1} of {len(rgb) - 1}"),
        (change * np.uint8(gain), f"Absolute difference, x {gain}"),
    ]
    figures = (figure(png_bytes(image), text, width=310) for image, text in images)
    return f"<div class='images'>{''.join(figures)}</div>"


def _drawn(png: bytes | None, caption: str, *, width: int = 640) -> str:
    return NO_RENDERER if png is None else figure(png, caption, width=width)


def drawings(
    solid: Solid, mesh: MembraneMesh, contact: Contact, drawing: Picture | None
) -> Drawings:
    """Everything drawn for a report; the exploded view comes from its own stage."""
    from geometry.drawing.sensor_drawings import membrane_drawing

    parts = None if drawing is None else drawing.png.tobytes()
    try:
        membrane = membrane_drawing(solid).tobytes()
        return Drawings(membrane=membrane, pressed=_displacement_png(mesh, contact), parts=parts)
    except DeviceError:
        return Drawings(membrane=None, pressed=None, parts=parts)


def _displacement_png(mesh: MembraneMesh, contact: Contact) -> bytes:
    """The pressed membrane coloured by how far its skin moved.

    Seen from 35 degrees beside the outward normal at the target.
    """
    from geometry.drawing.sensor_drawings import skin_field

    moved_mm = contact.displacement_mm[-1].astype(np.float64)
    skin = mesh.outer
    pressed = Skin(points_mm=skin.points_mm + moved_mm, faces=skin.faces, normals=skin.normals)
    beside = np.cross(contact.normal, contact.tangent_u)
    eye = contact.normal + 0.5 * contact.tangent_u + 0.5 * beside
    values = np.linalg.norm(moved_mm, axis=1)
    return skin_field(pressed, values, "displacement [mm]", eye=eye).tobytes()


def _force_curve(path: Press, contact: Contact) -> str:
    """Normal force of the approach frames as an inline SVG with labelled axes.

    A trajectory has no approach: all of its frames, against how far the skin was pushed in.
    """
    frames = path.frames if path.trajectory is None else path.frame_count
    depth = np.r_[0.0, frame_depths_mm(path, contact)[:frames]]
    force = np.r_[0.0, contact.normal_N[:frames]]
    width, height, left, bottom = 560, 260, 60, 40
    top = max(float(force.max()), 1e-9)
    across = max(float(depth.max()), 1e-9)
    x = left + (width - left - 20) * depth / across
    y = (height - bottom) - (height - bottom - 20) * force / top
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
    dots = "".join(
        f"<circle cx='{a:.1f}' cy='{b:.1f}' r='3'><title>{d:.3g} mm: {f:.4g} N</title></circle>"
        for a, b, d, f in zip(x, y, depth, force, strict=True)
    )
    axis = height - bottom
    return (
        f"<svg width='{width}' height='{height}' role='img' aria-label='force against depth'>"
        f"<path d='M{left},15 V{axis} H{width - 15}' fill='none' stroke='#888'/>"
        f"<polyline points='{points}' fill='none' stroke='#2563eb' stroke-width='2'/>"
        f"<g fill='#2563eb'>{dots}</g><g font-size='12' fill='#333'>"
        f"<text x='{left - 6}' y='24' text-anchor='end'>{top:.3g} N</text>"
        f"<text x='{left - 6}' y='{axis}' text-anchor='end'>0</text>"
        f"<text x='{width - 20}' y='{axis + 18}' text-anchor='end'>{across:.3g} mm</text>"
        f"<text x='{(left + width) / 2}' y='{axis + 32}' text-anchor='middle'>depth from first "
        "touch</text></g></svg>"
    )


def _press_table(path: Press) -> dict[str, Any]:
    """A press without the rows of its trajectory, which stand in poses.csv."""
    table = to_table(path)
    table["actuations"] = ", ".join(actuation.region for actuation in path.actuations) or "none"
    if path.strokes:
        table["strokes"] = ", ".join(stroke.text for stroke in path.strokes)
    if path.trajectory is not None:
        trajectory = path.trajectory
        table["trajectory"] = f"{len(trajectory.poses)} rows, {trajectory.duration_s:g} s"
    return table


def _flat(table: Mapping[str, Any], prefix: str = "") -> Iterable[tuple[str, Any]]:
    for name, value in table.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value
