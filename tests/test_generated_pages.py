"""Pages that are made from the program are those of today, and name everything that there is."""

from __future__ import annotations

import ast
import dataclasses
import functools
import re
from collections.abc import Iterator
from typing import Any

import pytest

import workbench as wb
from docs.generate import PAGES
from docs.generate_trust import ROOMS
from docs.trust_record import records
from tests.pages import DOCS, ROOT, page
from workbench.cli import validate_rooms as validate
from workbench.core.design.design import SensorDesign
from workbench.core.design.lighting import LightModel
from workbench.edit.typed_fields import with_typed
from workbench.learning.dataset.cases import Split
from workbench.proof.judge import judge

ROWS = [(record.room, row) for record in records() for row in record.rows]
SPECIFIC = 8
"""Letters that the pattern of a name must begin with, to say anything."""


@pytest.mark.parametrize("name", PAGES)
def test_a_page_is_what_the_program_says_today(name: str) -> None:
    """Else run `make docs`."""
    assert (DOCS / name).read_text(encoding="utf-8") == PAGES[name]()


@pytest.mark.parametrize("name", wb.__all__)
def test_every_stable_name_is_on_the_page(name: str) -> None:
    """With a heading of its own; the version is no object."""
    text = page("api")
    assert f"`wb.{name}`" in text
    assert name == "__version__" or f"\n## `wb.{name}`\n" in text


def leaves(part: Any, at: str = "") -> Iterator[tuple[str, Any]]:
    """Every field of a design that holds a value, by its dotted name."""
    for item in dataclasses.fields(part):
        value, name = getattr(part, item.name), f"{at}{item.name}"
        if dataclasses.is_dataclass(value):
            yield from leaves(value, f"{name}.")
        elif item.name not in ("shape", "body", "schema"):
            yield name, value


@pytest.mark.parametrize(("name", "value"), leaves(SensorDesign()))
def test_every_field_of_a_design_is_on_the_page(name: str, value: Any) -> None:
    """Under the heading of its table, unless it is a list of tables; numbers with their default."""
    table, _, field = name.rpartition(".")
    text = page("fields")
    if name in ("optics.cameras", "optics.lamps", "material.inclusions"):
        assert f"\n## `[[{name}]]`\n" in text
        return
    title = f"`[{table}]`" if table else "At the head"
    (chapter,) = re.findall(rf"^## {re.escape(title)}\n(.*?)(?=^## |\Z)", text, re.M | re.S)
    (told,) = re.findall(rf"^\| `{field}` \| (.*?) \|", chapter, re.MULTILINE)
    if isinstance(value, int | float) and not isinstance(value, bool):
        assert float(told) == value


def test_the_way_to_set_a_field_works() -> None:
    """As the head of the page shows it."""
    (typed,) = re.findall(r"`--set ([^`]+)`", page("fields"))
    assert with_typed(SensorDesign(), [typed]).optics.ring.count == 6


def test_every_room_of_the_validation_is_on_the_page() -> None:
    """In the order of the program."""
    assert list(ROOMS) == list(validate.ROOMS)


@functools.cache
def names_in_the_product() -> tuple[set[str], list[re.Pattern[str]]]:
    """Texts in the sources of the validation, and patterns of those that are put together."""
    plain, patterns = {model.value for model in LightModel}, []
    for path in (ROOT / "workbench" / "proof").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                plain.add(node.value)
            elif isinstance(node, ast.JoinedStr):
                parts = [
                    re.escape(part.value) if isinstance(part, ast.Constant) else r"\w+"
                    for part in node.values
                    if not isinstance(part, ast.Constant) or isinstance(part.value, str)
                ]
                if len(parts[0]) >= SPECIFIC and parts[0] != r"\w+":
                    patterns.append(re.compile("".join(parts)))
    return plain, patterns


def of_a_split(name: str, plain: set[str]) -> bool:
    """Whether a name is one that the sources give, and the part of a data set that it is about."""
    first, _, last = name.rpartition("_")
    return last in set(Split) and first in plain


@pytest.mark.parametrize("room", [record.room for record in records()])
def test_rows_of_a_record_exist_in_the_product(room: str) -> None:
    """Each name is given by a source of the validation, and somebody said what it is judged by."""
    plain, patterns = names_in_the_product()
    for of, row in ROWS:
        name = row["name"]
        if of == room:
            made = any(pattern.fullmatch(name) for pattern in patterns)
            assert name in plain or made or of_a_split(name, plain), name
            assert judge(name, row["case"])


def test_every_row_that_a_source_names_has_its_judge() -> None:
    """Of the rooms that no record has too: who adds a row says what it is judged by."""
    kinds = ("compared", "bounded", "stated", "failed")
    for path in (ROOT / "workbench" / "proof" / "validation").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") in kinds and node.args:
                name = node.args[0]
                if isinstance(name, ast.Constant):
                    assert judge(str(name.value)), path
                elif isinstance(name, ast.JoinedStr) and isinstance(name.values[0], ast.Constant):
                    assert judge(f"{name.values[0].value}of_a_case"), path


@pytest.mark.parametrize("room", [record.room for record in records()])
def test_verdicts_of_a_record_follow_from_its_numbers(room: str) -> None:
    """`ok` is what value, reference and limit say, so that no record flatters.

    What code of another day found is not met, whatever it found.
    """
    for of, row in ROWS:
        if of != room:
            continue
        if row.get("stale"):
            assert not row["ok"], row
            continue
        value, limit, error = row["value"], row["limit"], row["error"]
        if error is not None:
            scale = abs(row["reference"]) if row["error_kind"] == "relative" else 1.0
            assert error == pytest.approx(abs(value - row["reference"]) / scale)
            assert row["ok"] == (error <= limit), row
        elif limit is not None:
            assert row["ok"] == (value <= limit if row["sense"] == "max" else value >= limit), row
        else:
            assert row["ok"] == (value is not None), row


def test_the_page_hides_no_row_that_was_missed() -> None:
    """Each is named in its chapter, and the table of rooms counts those that are met."""
    (chapter,) = re.findall(r"^## Not met\n(.*?)(?=^## )", page("trust"), re.M | re.S)
    for record in records():
        missed = [row["name"] for row in record.rows if not row["ok"]]
        assert re.findall(rf"^- `(\w+)` of `{record.room}`", chapter, re.M) == missed
        good = sum(row["ok"] for row in record.rows)
        assert f"[{good} of {len(record.rows)} rows met](#room-{record.room})" in page("trust")
