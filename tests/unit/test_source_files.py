"""`workbench run --sources`: which are asked for, and their totals side by side."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from sim.forces.network.spec import Target
from tests.made_weights import tiny_weights, write_tiny
from tests.unit.test_force_sources import field
from workbench.core.base.errors import DesignError, StoreError
from workbench.core.press.press_case import PressCase
from workbench.core.result.force_field import Source
from workbench.pipeline import shipped
from workbench.report.source_files import asked_sources, last_frame, source_columns, with_weights

MPM, FEM = field(1.0, 1.8, Source.MPM), field(1.0, 2.0)
LEARNED = dataclasses.replace(field(1.1, 2.1, Source.LEARNED), notice="deep", note="E doubled")


def test_sources_are_asked_for_by_name() -> None:
    """In our order, spaces and empty parts left out; a misspelt one is refused."""
    assert asked_sources("") == ()
    assert asked_sources("learned, mpm,") == (Source.MPM, Source.LEARNED)
    with pytest.raises(DesignError, match="no source 'fen' of forces") as caught:
        asked_sources("mpm,fen")
    assert caught.value.hint == "did you mean 'fem'?" and caught.value.at == "--sources"


def test_a_network_that_is_asked_for_must_be_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing ships and no file is given: refused at once; a file of forces is taken."""
    monkeypatch.setattr(shipped, "FOLDER", tmp_path / "shipped")
    case = PressCase()
    assert with_weights(case, None, (Source.MPM,)) == case
    with pytest.raises(StoreError, match="no trained network for force"):
        with_weights(case, None, (Source.LEARNED,))
    path = write_tiny(tmp_path, tiny_weights())
    assert with_weights(case, path, (Source.LEARNED,)).learned.weights == str(path)
    moved = write_tiny(tmp_path, tiny_weights(target=Target.DISPLACEMENT))
    with pytest.raises(StoreError, match="predicts displacement"):
        with_weights(case, moved, (Source.LEARNED,))


def test_columns_are_named_by_their_source() -> None:
    """Normal and tangential force of each, and the largest of a vertex: 2 and 0.5 N by FEM."""
    columns = source_columns({Source.MPM: MPM, Source.FEM: FEM}, np.array([1.0]))
    assert list(columns) == [
        *("frame", "depth_mm", "mpm_normal_N", "mpm_tangential_N", "mpm_peak_N"),
        *("fem_normal_N", "fem_tangential_N", "fem_peak_N"),
    ]
    assert columns["frame"].tolist() == [1]
    assert columns["fem_normal_N"] == pytest.approx([2.0])
    assert columns["mpm_tangential_N"] == pytest.approx([0.45])
    assert columns["fem_peak_N"] == pytest.approx([np.hypot(2.0, 0.5)])


def test_the_last_frame_is_held_against_finite_elements() -> None:
    """-10 % and +5 %; without finite elements nothing is held against anything."""
    rows = last_frame({Source.MPM: MPM, Source.FEM: FEM, Source.LEARNED: LEARNED})
    assert [row["source"] for row in rows] == ["mpm", "fem", "learned"]
    assert rows[0]["normal_share"] == pytest.approx(-0.1)
    assert rows[2]["normal_share"] == pytest.approx(0.05)
    assert rows[2]["displacement_rms_mm"] == pytest.approx(0.1, rel=1e-5)
    assert (rows[2]["notice"], rows[2]["note"]) == ("deep", "E doubled")
    assert "normal_share" not in last_frame({Source.MPM: MPM, Source.LEARNED: LEARNED})[0]
