"""Mesh: how finely the body is divided, and how good the cells are."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser
from viser import uplot

from ui.desk.desk import Desk
from ui.page.colours import BLUE, GREEN
from ui.page.plain import plain
from ui.panels.page import Page
from ui.scene.views import Mark
from workbench.core.base.units import volume_ml
from workbench.core.result.quality import MeshQuality, QualityReport
from workbench.system.names import NONE
from workbench.view.scene_shapes import clear_view, judged, mesh_edges

NOTHING = "No numbers yet: press *Check mesh*."
JOBS = ("mesh", "tetrahedra")
"""Requests after which the edges stay on show."""
CLOSE = 25.0
"""Distance of the eye from a cell over the cell's diagonal."""
KINDS = {8: "hexahedra", 4: "tetrahedra", 3: "triangles"}


class MeshPanel:
    """Widgets of the second tab."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui, fields = desk.server.gui, desk.fields
        hint = "Edge of a cell of the body (a hexahedron) and of a triangle of its skin"
        fields.slider("Cell size mm", "design.meshing.hex_mm", span=(0.2, 1.5, 0.05), hint=hint)
        hint = "Edge of a tetrahedron; halving it takes four times as long"
        fields.slider("Tetrahedra mm", "design.meshing.tet_mm", span=(0.6, 4.0, 0.1), hint=hint)
        check = gui.add_button(
            "Check mesh",
            icon=viser.Icon.CHART_HISTOGRAM,
            hint="Quality and edge lengths as histograms, the worst cell in 3D",
        )
        check.on_click(desk.guarded(lambda event: self._run("mesh", "quality")))
        hint = "Conforming tetrahedra for other solvers; a minute or so, Cancel stops it"
        tets = gui.add_button("Tetrahedra", icon=viser.Icon.PYRAMID, hint=hint)
        tets.on_click(desk.guarded(lambda event: self._run("tetrahedra", "tets")))
        desk.reports.beside(*JOBS)
        self.found: dict[str, MeshQuality] = {}
        self.notice = ""
        self.choice = gui.add_dropdown(
            "Mesh shown", (NONE,), visible=False, hint="Whose cells are judged and drawn"
        )
        self.choice.on_update(desk.guarded(lambda event: self._tell()))
        hint = "Of the mesh shown, on the body at rest"
        self.edges = gui.add_checkbox("Show edges", False, visible=False, hint=hint)
        self.edges.on_update(desk.guarded(lambda event: self._draw()))
        self.drawn = ""
        """Name and key of the mesh whose edges are drawn."""
        self.numbers = gui.add_markdown(NOTHING)
        self.measure = self._plot("% of cells", BLUE)
        self.lengths = self._plot("% of edges", GREEN)
        self.worst = gui.add_button(
            "Show worst cell",
            icon=viser.Icon.ZOOM_IN,
            visible=False,
            hint="Flies to it and marks it",
        )
        self.worst.on_click(desk.guarded(lambda event: self._fly()))

    def _run(self, job: str, stage: str) -> None:
        self.edges.value = True
        self.desk.run(job, (stage,))

    def _plot(self, label: str, colour: str) -> Any:
        return self.desk.server.gui.add_uplot(
            (np.zeros(2), np.zeros(2)),
            (
                uplot.Series(label="at"),
                uplot.Series(label=label, stroke=colour, fill=f"{colour}55"),
            ),
            scales={"x": uplot.Scale(time=False)},
            aspect=1.9,
            visible=False,
        )

    def _offer(self) -> None:
        names = tuple(self.found) or (NONE,)
        if tuple(self.choice.options) != names:
            self.choice.options = names
        for handle in (self.choice, self.edges, self.measure, self.lengths, self.worst):
            handle.visible = bool(self.found)
        self._tell()

    def _chosen(self) -> MeshQuality | None:
        return self.found.get(self.choice.value)

    def _tell(self) -> None:
        quality = self._chosen()
        self._draw()
        if quality is None:
            if self.desk.scene.marks.marked:
                self.desk.scene.marks.clear_cell()
            self.numbers.content = NOTHING
            return
        name = self.choice.value
        self.numbers.content = numbers(quality, self.notice)
        self.measure.title = f"{name}: {measure_name(quality)}"
        self.measure.data = steps(quality.measure_borders, quality.measure_counts)
        self.lengths.title = f"{name}: edge length [mm]"
        self.lengths.data = steps(quality.edge_borders_mm, quality.edge_counts)
        if self.desk.scene.marks.marked:
            # The mark follows the mesh that is chosen.
            self._fly()

    def _draw(self) -> None:
        """Draw the edges of the chosen mesh, or none."""
        scene, name = self.desk.scene, self.choice.value
        if not self.edges.value or name not in self.found:
            self.drawn = ""
            scene.marks.show_edges(None)
            self.desk.cover("edges", False)
            return
        stage = "tets" if name == "tetrahedra" else "mesh"
        drawn = f"{name} {self.desk.session.calls()[stage].key}"
        mesh = None if drawn == self.drawn else self.desk.session.result(stage)
        if mesh is not None:
            self.drawn = drawn
            scene.marks.show_edges(mesh_edges(_member(mesh, name)))
            scene.show_frame(0)
            self.desk.cover("edges", True)

    def _fly(self) -> None:
        """Look at the worst cell of the chosen mesh."""
        quality, solid = self._chosen(), self.desk.scene.body.solid
        if quality is None or solid is None:
            return
        self.desk.put_parts_away()
        corners = np.asarray(quality.worst_mm)
        scene, middle = self.desk.scene, corners.mean(axis=0)
        size_mm = float(np.linalg.norm(np.ptp(corners, axis=0)))
        distance_mm = CLOSE * size_mm
        membrane = solid.membrane
        toward = clear_view(membrane.points_mm, membrane.faces, middle, distance_mm)
        scene.show_frame(0)
        scene.marks.show_cell(corners)
        text = f"worst cell: {quality.measure[0]:.3g}"
        scene.views.fly_to(middle, toward, distance_mm, Mark(text, ball=False))
        x, y, z = middle
        self.desk.log(
            f"looking at the worst cell of {self.choice.value}: {x:.1f}, {y:.1f}, {z:.1f} mm"
        )

    def refresh(self) -> None:
        """Forget numbers of a mesh that is no longer the design's."""
        stale = [
            name
            for name in self.found
            if not self.desk.current("tets" if name == "tetrahedra" else "quality")
        ]
        for name in stale:
            del self.found[name]
        if stale:
            self._offer()

    def show(self, stage: str, result: Any) -> None:
        """Follow results."""
        if stage == "press" or (stage == "run" and str(result) not in JOBS):
            self.edges.value = False
        elif stage == "build":
            self.found.clear()
            self.drawn = ""
            self._offer()
        elif stage == "quality":
            self._take(result)
        elif stage == "tets":
            solid = self.desk.session.result("build")
            self.found["tetrahedra"] = judged(result, solid.volume_mm3)
            self._offer()
            self.choice.value = "tetrahedra"
            self.desk.log(f"{len(result.cells)} tetrahedra, {volume_ml(result.volume_mm3):.2f} ml")

    def _take(self, report: QualityReport) -> None:
        tets = {name: q for name, q in self.found.items() if name == "tetrahedra"}
        volume = {} if report.volume is None else {"hexahedra": report.volume}
        self.found = {**volume, "outer skin": report.outer, "inner skin": report.inner, **tets}
        self.notice = report.notice
        self._offer()


def _member(mesh: Any, name: str) -> Any:
    """The mesh of that name in a result of its stage."""
    members = {"hexahedra": "hexes", "outer skin": "outer", "inner skin": "inner"}
    return getattr(mesh, members[name]) if name in members else mesh


def measure_name(quality: MeshQuality) -> str:
    """What a mesh is judged by, with its unit."""
    return "smallest angle [deg]" if len(quality.worst_mm) == 3 else "scaled Jacobian [1]"


def numbers(quality: MeshQuality, notice: str) -> str:
    """Counts, worst and middle cell, edges and volume."""
    kind = KINDS[len(quality.worst_mm)]
    worst, _, five, middle, _, _ = quality.measure
    short, _, _, edge, _, long = quality.edge_mm
    lines = [
        f"**{quality.cells:,}** {kind}, {quality.nodes:,} nodes",
        f"{measure_name(quality)}: worst **{worst:.3g}**, 5 % below {five:.3g}, "
        f"median {middle:.3g}",
        f"edges: {short:.3g} to {long:.3g} mm, median {edge:.3g} mm",
    ]
    if np.isfinite(quality.volume_ratio):
        lines.append(f"volume: {100 * quality.volume_ratio:.2f} % of the CAD body's")
    if notice and kind == "triangles":
        lines.append(plain(notice))
    return "\n\n".join(lines)


def steps(borders: np.ndarray, counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A histogram as the outline of its bars: x, and y in percent of all, shape (2 B + 2,)."""
    percent = 100.0 * np.asarray(counts) / max(int(np.sum(counts)), 1)
    return np.repeat(np.asarray(borders, dtype=float), 2), np.r_[0.0, np.repeat(percent, 2), 0.0]


PAGE = Page(place=2, label="Mesh", build=MeshPanel)
