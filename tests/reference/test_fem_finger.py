"""Finite elements on the default finger: recorded figures, mirror images, the wider cut-out."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from workbench.core.base.errors import StoreError
from workbench.core.base.version import VERSION
from workbench.core.press.fem import DRAFT_MM
from workbench.core.press.indenter import IndenterKind
from workbench.proof.validation.fem import fem_matrix
from workbench.proof.validation.fem.fem_cases import (
    FAMILIES,
    MatrixCase,
    body_digest,
    every_case,
    object_of,
    press_of,
)
from workbench.proof.validation.fem.fem_presses import (
    FRAMES,
    MIRROR,
    Case,
    finger,
    mirrored_finger,
    solved,
)
from workbench.system.record import Record


@pytest.mark.slow
def test_force_on_the_published_mesh() -> None:
    """A prototype with its own mesher found 1.424 N at 0.9 mm; meshes differ by half a percent."""
    found = solved(Case(radius_mm=7.0, halvings=0))
    assert found.normal_N[-1] == pytest.approx(1.424, rel=0.01)
    assert found.converged.all()
    assert (found.residual <= 1e-6).all()


@pytest.mark.slow
def test_mirrored_shear_mirrors() -> None:
    """The mirror image of the finger sheared to the other side has the mirrored forces."""
    here = solved(Case(kind=IndenterKind.CUBE, shear_mm=(0.0, 0.3), radius_mm=7.0))
    there = solved(Case(kind=IndenterKind.CUBE, shear_mm=(0.0, -0.3), radius_mm=7.0, mirrored=True))
    size_N = np.abs(here.contact_force_N[-1]).max()
    mirrored_N = there.contact_force_N[-1] * MIRROR
    assert np.abs(here.contact_force_N[-1] - mirrored_N).max() < 1e-4 * size_N
    assert np.abs(here.reaction_N[-1, 1]) > 0.05 * here.normal_N[-1]


@pytest.mark.slow
def test_a_mirrored_mesh_has_cells_the_right_way_round() -> None:
    """Same volumes, all positive: the corners of each cell are renumbered."""
    from sim.fem.elements import make_elements

    volumes = []
    for mesh in (finger(DRAFT_MM), mirrored_finger(DRAFT_MM)):
        assert mesh.hexes is not None
        elements = make_elements(mesh.hexes.points_mm, mesh.hexes.cells, shear_MPa=1, bulk_MPa=1)
        volumes.append(elements.volume_mm3)
    np.testing.assert_allclose(volumes[0], volumes[1], rtol=1e-9)


@pytest.mark.slow
def test_a_case_of_the_matrix_completes_and_says_so() -> None:
    told = fem_matrix.solve_case(
        MatrixCase(family="finger", thing="sphere", place=1, hex_mm=DRAFT_MM)
    )
    assert told["ok"], told["why"]
    assert told["frames"] == 2 * FRAMES + 12
    assert told["worst_residual"] <= 1e-6
    assert told["left_mm"] < 1e-6
    json.dumps(told)


def test_a_case_that_cannot_begin_says_why() -> None:
    """A family that does not exist is a case that failed, not a crash."""
    case = MatrixCase(family="no such family", thing="sphere", place=0)
    told = fem_matrix.solve_case(case)
    assert not told["ok"]
    assert told["why"]


def test_the_matrix_is_eight_objects_at_four_places_of_three_membranes() -> None:
    cases = every_case()
    assert len({case.name for case in cases}) == len(cases) == 96
    path = press_of(cases[0])
    assert path.frame_count == 32
    roof = object_of("wedge").mesh
    assert roof is not None
    corners = roof.points_mm[roof.faces]
    volume = np.einsum("fi,fi->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
    # Outward triangles enclose half of 6 x 3 x 6.
    assert volume == pytest.approx(54.0)


def record_of(tmp_path: Path, **changes: object) -> Record:
    told = {
        "ok": True,
        "why": "",
        "cpu_s": 5.0,
        "worst_residual": 1e-7,
        "solver": "PARDISO",
        "reaction_N": [[0, 0, 1]],
    }
    record: dict[str, object] = {
        "code": fem_matrix.RECORD.code(),
        "version": "0",
        "made": "2000-01-01",
        "conditions": fem_matrix.conditions(),
        "bodies": {family: body_digest(family) for family in FAMILIES},
        "cases": {case.name: told for case in every_case()},
    }
    kept = kept_in(tmp_path)
    kept.path.write_text(json.dumps(record | changes))
    return kept


def kept_in(tmp_path: Path, name: str = "record.json") -> Record:
    """The record of the matrix in another place."""
    return dataclasses.replace(fem_matrix.RECORD, path=tmp_path / name)


def test_without_a_record_the_rows_fail_and_say_why(tmp_path: Path) -> None:
    none = kept_in(tmp_path, "none.json")
    rows = fem_matrix.recorded_rows(none)
    assert [row.ok for row in rows] == [False] * 3
    assert "there is none" in rows[0].case
    assert not any(row.ok for row in fem_matrix.repeated_rows(none))


def test_a_record_of_another_body_is_none(tmp_path: Path) -> None:
    """Of three families one was reshaped since: its row fails, the others stand."""
    bodies = {family: body_digest(family) for family in FAMILIES} | {"trunk": "another"}
    rows = fem_matrix.recorded_rows(record_of(tmp_path, bodies=bodies))
    (row,) = [row for row in rows if row.name == "fem_matrix" and not row.ok]
    assert "not recorded since" in row.case and row.case.startswith("trunk")
    assert not any(row.case.startswith("trunk") for row in rows if row.ok)


def test_times_on_a_gpu_are_not_taken_for_those_of_a_processor(tmp_path: Path) -> None:
    """A family that a GPU solved has no such row; nothing fails for it."""
    kept = record_of(tmp_path)
    path, record = kept.path, kept.figures()
    for name, told in record["cases"].items():
        if name.startswith("trunk"):
            told["solver"] = "dense factors on the GPU"
    path.write_text(json.dumps(record))
    rows = fem_matrix.recorded_rows(kept)
    assert all(row.ok for row in rows)
    timed = [row.case for row in rows if row.name == "fem_matrix_cpu"]
    assert [case.split(":")[0] for case in timed] == ["finger", "paw"]


def test_a_damaged_record_is_refused(tmp_path: Path) -> None:
    kept = kept_in(tmp_path)
    for text in ("[1, 2", "[]", '{"cases": {}}'):
        kept.path.write_text(text)
        with pytest.raises(StoreError):
            fem_matrix.read_record(kept)


def test_a_full_record_passes_and_a_poor_one_does_not(tmp_path: Path) -> None:
    """31 of 32 is enough, 30 are not; what failed is named."""
    kept = record_of(tmp_path)
    assert all(row.ok for row in fem_matrix.recorded_rows(kept))
    path, record = kept.path, kept.figures()
    names = [case.name for case in every_case() if case.family == "finger"]
    for count, good in ((1, True), (2, False)):
        for name in names[:count]:
            record["cases"][name] = {"ok": False, "why": "stuck"}
        path.write_text(json.dumps(record))
        row = next(row for row in fem_matrix.recorded_rows(kept) if row.name == "fem_matrix")
        assert row.value == 32 - count
        assert row.ok is good
        assert f"{names[0]}: stuck" in row.case


def test_a_record_of_other_settings_is_refused(tmp_path: Path) -> None:
    rows = fem_matrix.recorded_rows(record_of(tmp_path, conditions="else"))
    assert not any(row.ok for row in rows)
    assert "other settings" in rows[0].case


def test_a_record_of_other_code_is_stale(tmp_path: Path) -> None:
    """Its figures stand, and no row is met; a runner does not mix them with those of today."""
    kept = record_of(tmp_path, code="else", version=VERSION)
    rows = fem_matrix.recorded_rows(kept)
    assert all(row.stale and not row.ok and row.value is not None for row in rows)
    assert "--jobs 16 --out FILE" in rows[0].case
    with pytest.raises(StoreError, match="other code"):
        fem_matrix.solve_all([], kept.path, 1, every_case()[0].hex_mm)


def test_a_runner_goes_on_where_it_was_stopped(tmp_path: Path) -> None:
    """Cases that the file holds are not solved again; a file of other settings is not touched."""
    path = record_of(tmp_path, version=VERSION).path
    before = path.read_bytes()
    record = fem_matrix.solve_all(every_case(), path, 1, every_case()[0].hex_mm)
    assert len(record["cases"]) == 96
    assert path.read_bytes() == before
    with pytest.raises(StoreError, match="other code, settings"):
        fem_matrix.solve_all([], path, 1, DRAFT_MM)


def test_a_case_that_no_longer_completes_is_no_repetition(monkeypatch: pytest.MonkeyPatch) -> None:
    case = every_case()[0]
    told = {"ok": True, "reaction_N": [[0.0, 0.0, 2.0]]}
    monkeypatch.setattr(fem_matrix, "solve_case", lambda case: told | {"ok": False})
    assert fem_matrix._difference(case, told) == float("inf")
    monkeypatch.setattr(
        fem_matrix, "solve_case", lambda case: told | {"reaction_N": [[0.0, 0.0, 2.1]]}
    )
    assert fem_matrix._difference(case, told) == pytest.approx(0.05)
