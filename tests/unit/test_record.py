"""Records of figures: stale once the code that made them computes otherwise, and not before."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import pytest

from workbench.core.base.errors import StoreError
from workbench.proof.row import Row, as_text, bounded, compared, stated
from workbench.system import record as module
from workbench.system.record import Record, code_digest

SOLVER = '''"""What it solves."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim.words import Word

LIMIT = 0.5
"""Largest of them."""


def solved(value: float) -> float:
    """A law."""
    from sim.law import law

    # Why it is so.
    return law(value) + LIMIT
'''
LAW = "def law(value):\n    return 2.0 * value\n"
FILES = {"sim/solver.py": SOLVER, "sim/law.py": LAW, "sim/words.py": "Word = str\n"}
CHANGES = {
    "a comment": ("# Why it is so.", "# Another reason."),
    "a docstring": ('"""A law."""', '"""A law, in other words."""'),
    "the docstring of a constant": ('"""Largest of them."""', '"""The largest."""'),
    "layout": ("law(value) + LIMIT", "(law(value)\n            + LIMIT)"),
    "what type checkers import": ("import Word", "import Word as W"),
}


def copied(folder: Path, name: str = "", before: str = "", after: str = "") -> Path:
    """A copy of the small program, one file of it changed."""
    for path, text in FILES.items():
        if path == name:
            assert before in text
            text = text.replace(before, after)
        place = folder / path
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(text, encoding="utf-8")
    (folder / "sim/__init__.py").write_text("", encoding="utf-8")
    return folder


def digest_of(root: Path, *apart: str) -> str:
    return code_digest(("sim.solver",), apart, root=root)


@pytest.mark.parametrize("change", CHANGES)
def test_what_computes_nothing_leaves_the_digest(change: str, tmp_path: Path) -> None:
    """The same program in other words is the same code."""
    was = digest_of(copied(tmp_path / "was"))
    assert digest_of(copied(tmp_path / "now", "sim/solver.py", *CHANGES[change])) == was


@pytest.mark.parametrize(
    ("name", "before", "after"),
    [
        ("sim/solver.py", "+ LIMIT", "- LIMIT"),
        ("sim/solver.py", "LIMIT = 0.5", "LIMIT = 0.6"),
        ("sim/law.py", "2.0", "2.1"),
    ],
    ids=["a sign", "a number", "a number of what is imported inside a function"],
)
def test_what_computes_otherwise_is_other_code(
    name: str, before: str, after: str, tmp_path: Path
) -> None:
    """One number in the module or in what it imports lazily makes another digest."""
    was = digest_of(copied(tmp_path / "was"))
    assert digest_of(copied(tmp_path / "now", name, before, after)) != was


def test_what_is_apart_takes_no_part(tmp_path: Path) -> None:
    """A module that no figure depends on may change."""
    was = digest_of(copied(tmp_path / "was"), "sim.law")
    changed = copied(tmp_path / "now", "sim/law.py", "2.0", "2.1")
    assert digest_of(changed, "sim.law") == was != digest_of(changed)


def test_a_package_stands_for_its_modules(tmp_path: Path) -> None:
    """Another file in a package of the sources is other code."""
    root = copied(tmp_path / "was")
    was = code_digest(("sim",), root=root)
    more = copied(tmp_path / "now")
    (more / "sim/more.py").write_text("MORE = 1\n", encoding="utf-8")
    assert code_digest(("sim",), root=more) != was


def test_sources_that_are_nowhere_are_refused(tmp_path: Path) -> None:
    """A record that names a module that was moved cannot be vouched for."""
    with pytest.raises(StoreError, match=r"there is no module sim\.elsewhere"):
        code_digest(("sim.elsewhere",), root=copied(tmp_path))


def record_in(folder: Path, *sources: str) -> Record:
    return Record(path=folder / "one.json", command="python -m one", sources=sources)


def test_a_record_is_fresh_when_made_and_stale_of_other_code(tmp_path: Path) -> None:
    """A changed digest is told with the command that makes the record anew."""
    record = record_in(tmp_path, "workbench.core.base.units")
    record.make(lambda: {"force_N": 1.5})
    assert record.stale() == "" and record.figures()["force_N"] == 1.5
    held = json.loads(record.path.read_text(encoding="utf-8"))
    record.path.write_text(json.dumps({**held, "code": "else"}), encoding="utf-8")
    assert "made by other code; make it anew: python -m one" in record.stale()


@pytest.mark.parametrize("text", ["", "[]", '{"made": "2026-11-23", "force_N": 1.5}'])
def test_what_nobody_vouches_for_is_stale(text: str, tmp_path: Path) -> None:
    """A record that is damaged, or does not say which code made it, is not fresh."""
    record = record_in(tmp_path, "workbench.core.base.units")
    assert record.stale().startswith("stale: ")
    record.path.write_text(text, encoding="utf-8")
    assert record.stale().startswith("stale: ") and "python -m one" in record.stale()


def test_other_data_make_a_record_stale(tmp_path: Path) -> None:
    """Figures that rest on a file are those of its bytes."""
    data = tmp_path / "data.npz"
    data.write_bytes(b"one")
    record = dataclasses.replace(record_in(tmp_path, "workbench.core.base.units"), files=(data,))
    record.make(dict)
    assert record.stale() == ""
    data.write_bytes(b"other")
    assert "by other code or from other data" in record.stale()


def test_rows_that_rest_on_a_stale_record_are_not_met(tmp_path: Path) -> None:
    """Within its limit, measured, and yet not ok: the row says what makes the record anew."""
    record = record_in(tmp_path, "workbench.core.base.units")
    record.make(lambda: {"force_N": 2.0})

    def rows() -> list[Row]:
        return [
            compared("a", "c", 2.0, 2.0, unit="N", limit=0.1, record=record),
            bounded("b", "c", 0.0, unit="N", limit=0.1, record=record),
            stated("d", "c", 2.0, unit="N", record=record),
        ]

    assert all(row.ok and not row.stale for row in rows())
    held = record.figures()
    record.path.write_text(json.dumps({**held, "code": "else"}), encoding="utf-8")
    for row in rows():
        assert row.stale and not row.ok and row.value is not None
        assert row.case.endswith("make it anew: python -m one")
    assert as_text(rows()).count("STALE") == 3


def test_code_that_is_not_installed_cannot_have_been_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A record of a program in `tests` is believed where that folder is not."""
    record = record_in(tmp_path, "tests.unit.test_record")
    record.path.write_text('{"code": "as released"}', encoding="utf-8")
    assert "other code" in record.stale()
    monkeypatch.setattr(module, "ROOT", tmp_path)
    assert record.stale() == ""
