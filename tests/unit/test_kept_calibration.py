"""A calibration stays: read where it is of the same, fitted anew where it is not or is damaged."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import pytest

from workbench.core.base.errors import SolveError
from workbench.core.design.design import SensorDesign
from workbench.planning.stage_table import STAGES
from workbench.project.design_toml import design_table
from workbench.project.named_designs import load_design
from workbench.tasks.kept import kept_key
from workbench.tasks.kept.kept_calibration import kept_calibration

POWERS = (2.0 / 3.0, 0.1 + 0.2, *(1.0,) * 10)
TOLD = {"fitted": "all", "photos": 20, "error_grey": 0.1 + 0.2, "null_grey": 7.0}


def built_sensor() -> SensorDesign:
    """A design whose light no decimal tells exactly, as a built sensor with its file."""
    from tests.unit.test_drawn_design import calibrated

    design = calibrated("pad")
    ring = dataclasses.replace(design.optics.ring, powers=POWERS)
    return dataclasses.replace(design, optics=dataclasses.replace(design.optics, ring=ring))


class Fitter:
    """Fits, and counts how often."""

    def __init__(self) -> None:
        self.asked = 0

    def __call__(self) -> tuple[SensorDesign, dict[str, Any]]:
        self.asked += 1
        return built_sensor(), TOLD


def test_what_was_fitted_is_read_again(tmp_path: Path) -> None:
    """The same light to the last digit, with the sensor's own file; nothing is fitted twice."""
    fit = Fitter()
    first, again = (kept_calibration(tmp_path / "kept", ["photos"], fit) for _ in range(2))
    assert fit.asked == 1
    assert again == first
    assert again[0].optics.unit is not None
    assert again[0].optics.ring.powers == POWERS
    # Another command takes it by its path.
    other = load_design(tmp_path / "kept" / "design.toml")
    assert design_table(other) == design_table(first[0])


@pytest.mark.parametrize("what", ["photos", "code", "stage", "design", "told", "unit"])
def test_what_is_of_something_else_or_damaged_is_fitted_anew(
    what: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And kept in its place."""
    fit = Fitter()
    kept_calibration(tmp_path, ["photos"], fit)
    rests_on: list[object] = ["others"] if what == "photos" else ["photos"]
    if what == "stage":
        raised = dataclasses.replace(STAGES["bake"], version=99)
        monkeypatch.setitem(kept_key.STAGES, "bake", raised)
    if what == "code":
        monkeypatch.setattr(kept_key, "code_digest", lambda sources: "of another day")
    if what in ("design", "told"):
        for path in tmp_path.glob(f"{what}.*"):
            path.write_bytes(path.read_bytes()[:40])
    if what == "unit":
        for path in tmp_path.glob("*/*.npz"):
            path.write_bytes(b"rubbish")
    for _ in range(2):
        found = kept_calibration(tmp_path, rests_on, fit)
        assert found == (built_sensor(), TOLD)
    assert fit.asked == 2


def test_nothing_is_kept_of_photographs_that_cannot_be_calibrated_to(tmp_path: Path) -> None:
    """The reason is told each time."""

    def fit() -> tuple[SensorDesign, dict[str, Any]]:
        raise SolveError("no ball is seen", hint="press deeper", at="photos")

    for _ in range(2):
        with pytest.raises(SolveError, match="no ball"):
            kept_calibration(tmp_path / "kept", [], fit)
    assert not (tmp_path / "kept").exists()
