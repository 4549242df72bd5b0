"""What rows are judged by: said in the table and in JSON, `itself` where it is the product."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from workbench.cli import validate_rooms
from workbench.cli.command_line import main
from workbench.proof.judge import Judge, judge, judged
from workbench.proof.row import Row, as_json, bounded


def _rows() -> list[Row]:
    return [
        bounded("hybrid", "c", 1.0, unit="1", limit=2.0),
        bounded("mitsuba_recorded", "c", 1.0, unit="1", limit=2.0),
        bounded("nobody_entered_this", "c", 1.0, unit="1", limit=2.0),
    ]


def test_rows_say_what_they_are_judged_by() -> None:
    """A row that nobody entered has none; the others their judge."""
    assert [row.against for row in judged(_rows())] == ["itself", "outside reference", None]
    with pytest.raises(KeyError):
        judge("nobody_entered_this")


def test_json_and_table_tell_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """`against` stands beside the keys of before; the table has a column."""
    monkeypatch.setitem(validate_rooms.ROOMS, "optics", _rows)
    words = ["validate", "optics", "--project", str(tmp_path)]
    assert main([*words, "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert [row["against"] for row in rows] == ["itself", "outside reference", None]
    assert {"name", "case", "value", "unit", "reference", "null", "limit", "ok"} <= set(rows[0])
    assert main(words) == 0
    head, hybrid, *_ = capsys.readouterr().out.splitlines()
    assert head.split()[:3] == ["row", "against", "case"]
    assert hybrid.split()[:3] == ["ok", "hybrid", "itself"]


def test_numpy_numbers_reach_json() -> None:
    """A verdict about one of them is a plain true or false."""
    row = bounded("hybrid", "c", lambda: np.float64(1.0), unit="1", limit=2.0)
    assert json.loads(as_json([row]))[0]["ok"] is True


@pytest.mark.parametrize("name", ["hybrid", "table", "raster", "ceiling", "cpu_gpu", "rest_image"])
def test_the_product_beside_itself_is_called_so(name: str) -> None:
    """Light models beside photons of the same tracer, drawing beside casting, half beside half."""
    assert judge(name) is Judge.ITSELF
