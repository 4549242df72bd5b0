"""Rows of readings from records: limits where something is asked, and a null beside each error."""

from __future__ import annotations

import dataclasses
import json
from argparse import Namespace
from pathlib import Path
from typing import Any

import numpy as np

from tests.unit.test_dataset_cases import flat_skin
from workbench.proof.judge import Judge, judge
from workbench.proof.row import Row
from workbench.proof.validation.reading import relit_figures, renders, room, twin_figures
from workbench.system.record import Record
from workbench.twin.twin_plan import Light, Solver

SCORES: dict[str, float | None] = {
    "count": 9.0,
    "depth_mm": 0.025,
    "depth_null_mm": 0.3,
    "depth_ceiling_mm": 0.01,
    "normal_deg": 2.0,
    "normal_null_deg": 12.0,
    "contact_iou": 0.9,
    "within_sigma": 0.6,
    "force_error": None,
}
PLAN = {
    "seed": 1,
    "contact": "fem",
    "photons_millions": 64,
    "width_px": 320,
    "calibration": 20,
    "presses": 140,
    "failed": 0,
    "refine": "all",
}


def kept(record: Record, folder: Path, figures: dict[str, Any]) -> Record:
    """The record with these figures, made by today's code."""
    own = dataclasses.replace(record, path=folder / record.path.name)
    own.path.write_text(json.dumps({**own.head(), **figures}))
    return own


def of_renders(folder: Path, millions: int) -> dict[str, Row]:
    ways = dict.fromkeys(room.WORDS, SCORES)
    figures = {"photons_millions": millions, "designs": {"pad": ways, "trunk": ways}}
    rows = room.render_rows(kept(renders.RECORD, folder, figures))
    assert len({(row.name, row.case) for row in rows}) == len(rows)
    return {f"{row.name} {row.case.partition(':')[0]}": row for row in rows}


def test_limits_of_renders_are_those_of_the_design(tmp_path: Path) -> None:
    """.025 mm is too much for the pad and good enough for the trunk, whose limit is .03."""
    rows = of_renders(tmp_path, 64)
    assert not rows["reading_renders pad"].ok
    assert rows["reading_renders trunk"].ok
    assert rows["reading_noise pad"].ok
    assert rows["reading_renders pad"].null == 0.3
    assert rows["reading_renders pad"].ceiling == 0.01
    assert rows["reading_renders_normals pad"].limit == room.NORMAL_LIMIT_DEG


def test_nothing_is_asked_of_images_with_few_photons(tmp_path: Path) -> None:
    """Their noise is the photons'; with 64 million the limit holds."""
    assert of_renders(tmp_path, 4)["reading_photons pad"].limit is None
    row = of_renders(tmp_path, 64)["reading_photons pad"]
    assert row.limit == room.PHOTON_LIMIT_MM
    assert "64 million photons" in row.case


def test_twins_are_asked_only_after_calibration(tmp_path: Path) -> None:
    """And have a null beside every score; a design that tells no force has no row of it."""
    figures = {
        "designs": {
            "pad": {
                "plan": PLAN,
                "uncalibrated": {**SCORES, "depth_mm": 0.2, "force_error": 0.4},
                "calibrated": {**SCORES, "depth_mm": 0.09},
            }
        }
    }
    rows = {row.name: row for row in room.twin_rows(kept(twin_figures.RECORD, tmp_path, figures))}
    assert rows["reading_twin_uncalibrated"].limit is None
    assert rows["reading_twin_calibrated"].limit == room.TWIN_LIMIT_MM
    assert not rows["reading_twin_calibrated"].ok
    assert rows["reading_twin_uncalibrated_force"].null == 1.0
    assert "reading_twin_calibrated_force" not in rows
    for name, row in rows.items():
        assert row.null is not None or row.reference is not None
        assert judge(name) is Judge.ITSELF


def test_nothing_is_asked_of_another_reality(tmp_path: Path) -> None:
    """Its rows say whose photons they are; the learned reader stands beside the others."""
    plan = {**PLAN, "contact": "gent", "light": "mitsuba", "photons_millions": 16}
    ways = dict.fromkeys(("uncalibrated", "learned", "calibrated"), SCORES)
    figures = {"designs": {"pad-other": {"plan": plan, **ways}}}
    rows = {row.name: row for row in room.twin_rows(kept(twin_figures.RECORD, tmp_path, figures))}
    assert rows["reading_twin_calibrated"].limit is None
    assert "by gent and 16 million photons of Mitsuba" in rows["reading_twin_learned"].case
    assert "photographs of a ball" not in rows["reading_twin_learned"].case


def test_relit_readings_are_asked_what_a_learned_reader_is(tmp_path: Path) -> None:
    """Depth, contact and force have limits; what the photographs as they are gave is told."""
    plain = {**SCORES, "depth_mm": 0.186, "force_error_median": 0.4}
    relit = {**SCORES, "depth_mm": 0.05, "force_error_median": 0.05}
    figures = {"designs": {"pad": {"plan": PLAN, "as_it_is": plain, "relit": relit}}}
    record = kept(relit_figures.RECORD, tmp_path, figures)
    rows = {row.name: row for row in room.relit_rows(record)}
    depth = rows["reading_twin_relit"]
    assert (depth.ok, depth.limit, depth.null) == (False, room.RELIT_LIMIT_MM, 0.3)
    assert "as they are 0.186 mm" in depth.case
    assert rows["reading_twin_relit_contact"].ok
    assert rows["reading_twin_relit_force"].ok
    assert rows["reading_twin_relit_sigma"].reference == 0.68
    assert all(judge(name) is Judge.ITSELF for name in rows)


def test_one_command_makes_twins_of_both_realities(tmp_path: Path) -> None:
    """Each in its folder; where presses are by the contact solver, only the light is other."""
    words: dict[str, Any] = {
        **{"folder": tmp_path, "designs": ["pad", "geltip"], "seed": 1, "calibration": 20},
        **{"presses": 140, "photons": 0, "other": 50, "width": 320, "jobs": 8, "refine": "all"},
    }
    runs = {run.key: run for run in twin_figures._runs(Namespace(**words, contact="fem"))}
    assert list(runs) == ["pad", "geltip", "pad-other", "geltip-other"]
    assert runs["pad"].plan.light is Light.PHOTONS
    other = runs["geltip-other"]
    assert (other.plan.light, other.plan.contact) == (Light.MITSUBA, Solver.GENT)
    assert (other.plan.presses, other.name, other.folder.name) == (50, "geltip", other.key)
    quick = list(twin_figures._runs(Namespace(**words, contact="mpm")))
    assert [run.plan.contact for run in quick] == [Solver.MPM] * 4
    alone = list(twin_figures._runs(Namespace(**(words | {"other": 0}), contact="fem")))
    assert [run.key for run in alone] == ["pad", "geltip"]


def test_without_a_record_rows_fail_and_say_how_to_make_it(tmp_path: Path) -> None:
    """None counts as met."""
    for record, rows in (
        (renders.RECORD, room.render_rows),
        (twin_figures.RECORD, room.twin_rows),
        (relit_figures.RECORD, room.relit_rows),
    ):
        (row,) = rows(dataclasses.replace(record, path=tmp_path / "none.json"))
        assert not row.ok
        assert row.value is None


def test_a_record_by_other_code_is_stale(tmp_path: Path) -> None:
    """And its rows are not met, whatever they say."""
    ways = {"pad": {"renders": {**SCORES, "depth_mm": 0.001}}}
    record = kept(renders.RECORD, tmp_path, {"photons_millions": 64, "designs": ways})
    told = json.loads(record.path.read_text()) | {"code": "another"}
    record.path.write_text(json.dumps(told))
    assert all(row.stale and not row.ok for row in room.render_rows(record))


def test_what_is_known_of_a_dent_is_its_surface() -> None:
    """No force is claimed: its error is unknown, not 0."""
    skin = flat_skin(12.0, 0.5)
    moved = np.tile([0.0, 0.0, -0.6], (len(skin.points_mm), 1))
    truth = renders.known(skin, moved, "d")
    np.testing.assert_allclose((truth.rest_mm - truth.displaced_mm)[:, 2], 0.6)
    assert np.isnan(truth.force_N).all()
