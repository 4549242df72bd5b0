"""Advice on sources of forces says what was measured of presses like one, and nothing else."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import pytest

from sim.forces.contact_kind import ContactKind, Touch, Width, kind_of_press
from tests.unit.test_chosen_weights import case_with, force_file
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.motion import slide, twist
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.core.press.texture import Pattern, Texture
from workbench.pipeline.advice import Asked, ForceSource, Measured, Table, advice, row_table, table
from workbench.planning.advised import advised, asked
from workbench.planning.plan import plan
from workbench.project.named_designs import load_design
from workbench.system.record import Record

EDGED = ContactKind(touch=Touch.EDGED, width=Width.MIDDLE, sheared=False)
TRUTH, LIMITS = "finite elements of 0.45 mm", "converged limits"


def row(source: ForceSource, total: float, **fields: Any) -> Measured:
    """What was measured of edged objects."""
    known = {"kind": EDGED, "seen": None, "presses": 9, "against": TRUTH}
    return Measured(source=source, total=total, **(known | fields))


LEARNED = row(ForceSource.LEARNED, 0.012, field=0.13, peak_bias=-0.1, seen=False, presses=21)
KNOWN = row(ForceSource.LEARNED, 0.01, field=0.11, peak_bias=0.0, seen=True)
MPM = row(ForceSource.MPM, 0.082, field=0.3, peak_bias=0.29, presses=36)
DRAFT = row(ForceSource.DRAFT, 0.05, field=0.2, peak_bias=0.05)
QUALITY = row(ForceSource.QUALITY, 0.03, against=LIMITS, presses=1)
TABLE = Table(
    rows=(LEARNED, KNOWN, MPM, DRAFT, QUALITY),
    network="net.weights",
    grid_mm=0.5,
    place="a finger",
)
PRESS = Asked(kind=EDGED, network="net.weights", seen=False, grid_mm=0.5)


def doctored(**rows: Measured) -> Table:
    """The table with some rows of its sources replaced."""
    kept = [one for one in TABLE.rows if one.source.name.lower() not in rows]
    return dataclasses.replace(TABLE, rows=(*kept, *rows.values()))


def test_errors_are_told_with_the_number_of_presses() -> None:
    """13 and 30 % of the force field, on 21 and 36 presses, against one truth."""
    said = advice(PRESS, TABLE).text
    assert said.startswith("Errors measured on edged objects of 4 to 8 mm, pressed into a finger. ")
    learned = "learned force field 13 %, total force 1.2 %, peak pressure -10 % (21 presses of "
    assert f"Against {TRUTH}: {learned}unseen objects); contact solver force field 30 %" in said
    assert "Nearest: learned." in said
    assert f"Against {LIMITS}: finite elements of 0.45 mm total force 3 % (1 press)." in said


@pytest.mark.parametrize(
    ("better", "nearest"),
    [
        ({"mpm": dataclasses.replace(MPM, field=0.05, total=0.005)}, "contact solver"),
        ({"draft": dataclasses.replace(DRAFT, field=0.01, total=0.001)}, "finite elements of 0.9"),
    ],
)
def test_another_table_is_another_advice(better: dict[str, Measured], nearest: str) -> None:
    """Errors that are smaller than the network's make their source the nearest."""
    assert f"Nearest: {nearest}" in advice(PRESS, doctored(**better)).text


def test_field_and_total_may_have_different_sources() -> None:
    """The network has the better field, the contact solver the better total."""
    said = advice(PRESS, doctored(mpm=dataclasses.replace(MPM, total=0.001))).text
    assert "Nearest in the force field: learned; in total force: contact solver." in said


def test_errors_against_other_truths_are_not_compared() -> None:
    """Limits have another error than finite elements of the data: one row has no nearest."""
    exact = dataclasses.replace(QUALITY, total=0.0)
    assert "Nearest: learned." in advice(PRESS, doctored(quality=exact)).text


@pytest.mark.parametrize(
    ("press", "missing"),
    [
        (dataclasses.replace(PRESS, foreign=True), ForceSource.LEARNED),
        (dataclasses.replace(PRESS, network="mine.weights"), ForceSource.LEARNED),
        (dataclasses.replace(PRESS, grid_mm=0.36), ForceSource.MPM),
    ],
    ids=["another membrane", "other weights", "another grid"],
)
def test_what_was_not_measured_is_said_so(press: Asked, missing: ForceSource) -> None:
    """Its source is named as not measured and is no advice."""
    found = advice(press, TABLE)
    assert found.missing == (missing,) and missing not in {one.source for one in found.rows}
    assert f"Not measured on such a press: {missing.value}." in found.text
    assert f"Nearest: {missing.value}" not in found.text


def test_objects_of_the_training_have_errors_of_their_own() -> None:
    """11 % where the network knew the object, 13 % where not."""
    assert "force field 11 %" in advice(dataclasses.replace(PRESS, seen=True), TABLE).text


def test_without_finite_elements_none_are_named() -> None:
    """A soft object is for the contact solver alone."""
    found = advice(dataclasses.replace(PRESS, solvable=False), TABLE)
    assert {one.source for one in found.rows} == {ForceSource.LEARNED, ForceSource.MPM}


@pytest.mark.parametrize("kind", [None, dataclasses.replace(EDGED, sheared=True)])
def test_nothing_is_said_where_nothing_was_measured(kind: ContactKind | None) -> None:
    """No row for the kind: no number and no source."""
    found = advice(dataclasses.replace(PRESS, kind=kind), TABLE)
    assert found.rows == () and found.text.startswith("Nothing was measured of forces on ")
    assert "%" not in found.text and "Nearest" not in found.text


def test_an_old_table_says_that_it_is_old() -> None:
    """Numbers of another program are still told, but not as today's."""
    said = advice(PRESS, dataclasses.replace(TABLE, stale=True)).text
    assert said.endswith("These are errors of an earlier program or network.")


def test_a_record_gives_back_its_rows(tmp_path: Path) -> None:
    """Through JSON; a stale one is marked, a missing one is an empty table."""
    record = Record(path=tmp_path / "e.json", command="c", sources=("workbench.core.base.units",))
    assert table(dataclasses.replace(record, path=tmp_path / "none.json")) == Table()
    rows = [row_table(one) for one in TABLE.rows]
    record.make(
        lambda: {"network": "net.weights", "grid_mm": 0.5, "place": "a finger", "rows": rows}
    )
    assert table(record) == TABLE
    old = dataclasses.replace(record, path=tmp_path / "old.json")
    old.path.write_text(json.dumps({**record.figures(), "code": "else"}), encoding="utf-8")
    assert table(old) == dataclasses.replace(TABLE, stale=True)


def test_the_advice_as_plain_values() -> None:
    """For `run --sources --json`."""
    said = advice(dataclasses.replace(PRESS, foreign=True), TABLE).as_json()
    assert said["not_measured"] == ["learned"]
    assert said["measured"][0]["source"] == "contact solver"
    assert said["measured"][0]["field"] == 0.3 and said["measured"][0]["presses"] == 36


@pytest.mark.parametrize(
    ("indenter", "press", "words"),
    [
        (Indenter(), Press(), "smooth objects of 4 to 8 mm, pressed"),
        (Indenter(kind=IndenterKind("cube"), size_mm=3.0), Press(), "edged objects below 4 mm, pr"),
        (
            Indenter(kind=IndenterKind("diamond")),
            Press(shear_mm=(0.2, 0.0)),
            "pointed objects of 4 ",
        ),
        (Indenter(kind=IndenterKind("cone"), size_mm=9.0), Press(), "pointed objects above 8 mm"),
        (
            Indenter(kind=IndenterKind("cube"), turn_deg=(0.0, 0.0, 45.0)),
            Press(),
            "edged objects of 4 to 8 mm, pressed",
        ),
        (Indenter(), Press(strokes=(slide(0.1, 0.0),)), "smooth objects of 4 to 8 mm, sheared"),
    ],
)
def test_the_kind_of_a_press(indenter: Indenter, press: Press, words: str) -> None:
    """By what touches, its width and its path."""
    found = kind_of_press(indenter, press)
    assert found is not None and found.words.startswith(words)


@pytest.mark.parametrize(
    ("indenter", "press"),
    [
        (Indenter(kind=IndenterKind("cube"), turn_deg=(45.0, 0.0, 0.0)), Press()),
        (Indenter(texture=Texture(pattern=Pattern.DOTS)), Press()),
        (Indenter(), Press(strokes=(twist(5.0),))),
    ],
    ids=["tilted", "textured", "twisted"],
)
def test_what_is_of_no_kind(indenter: Indenter, press: Press) -> None:
    """A corner that points down, a pattern, a twist: nothing of the kind was held out."""
    assert kind_of_press(indenter, press) is None


def test_a_planned_press_is_asked_of_as_its_network_knows_it(tmp_path: Path) -> None:
    """An unseen object is measured; a thinner membrane, or what only the result tells, is not."""
    finger = load_design("finger")
    case = case_with(force_file(tmp_path, indenters=["sphere"]))
    known = asked(case, plan(finger, case))
    assert known.seen and not known.foreign and known.network.endswith(".weights")
    cube = dataclasses.replace(case, indenter=Indenter(kind=IndenterKind("cube")))
    calls = plan(finger, cube)
    new = asked(cube, calls)
    assert not new.seen and not new.foreign and new.kind == EDGED
    assert asked(cube, calls, notice="the skin moves by 3 mm").foreign
    layers = dataclasses.replace(finger.layers, elastomer_mm=1.5)
    thin = dataclasses.replace(finger, layers=layers)
    assert asked(case, plan(thin, case)).foreign
    table = dataclasses.replace(TABLE, network=new.network)
    assert "21 presses of unseen objects" in advised(cube, calls, known=table).text


def test_a_press_without_a_network_is_advised_of_the_others() -> None:
    """The network is not offered."""
    plain = PressCase(indenter=Indenter(kind=IndenterKind("cube")))
    calls = {n: c for n, c in plan(load_design("finger"), plain).items() if n != "learned"}
    found = advised(plain, calls, known=TABLE)
    assert {one.source for one in found.rows} == set(ForceSource) - {ForceSource.LEARNED}
