"""Free names: one rule for copies, sweeps, and what comes back from the trash."""

from __future__ import annotations

from pathlib import Path

from workbench.system.names import LONGEST, is_name, numbered
from workbench.system.whole_files import free_path


def test_copies_get_free_names() -> None:
    """finger, finger 2, finger 3; a copy of finger 2 is finger 3 too."""
    assert numbered("finger", ["finger"]) == "finger 2"
    assert numbered("finger", ["finger", "finger 2"]) == "finger 3"
    assert numbered("finger 2", ["finger", "finger 2"]) == "finger 3"


def test_numbers_begin_where_asked_and_fill_gaps() -> None:
    """The first sweep of a field has number 1; a name that is a number alone keeps it."""
    assert numbered("elastomer_mm", [], first=1) == "elastomer_mm 1"
    assert numbered("wall", ["wall 2", "wall 4"]) == "wall 3"
    assert numbered("7", ["7"]) == "7 2"


def test_a_number_makes_no_name_too_long() -> None:
    """The longest name with a number is a name still."""
    assert is_name("x" * LONGEST)
    assert is_name(numbered("x" * LONGEST, ["x" * LONGEST]))


def test_a_free_path_keeps_its_ending(tmp_path: Path) -> None:
    """crash.txt, crash 2.txt, crash 3.txt; another ending takes no name away."""
    for name in ("crash.txt", "crash 2.txt", "crash 3.toml"):
        (tmp_path / name).touch()
    assert free_path(tmp_path / "crash.txt").name == "crash 3.txt"
    assert free_path(tmp_path / "other.txt").name == "other.txt"
