"""Variants on disk and their score card, without a browser."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import pytest

from sim.optics.maps.map_kind import map_kinds
from workbench.core.base.errors import DesignError
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.project.state import State, fresh_state
from workbench.variants.comparison import changes, parameter_differences, press_notice, tally
from workbench.variants.comparison_tables import card_table, change_table, parameter_table, remedies
from workbench.variants.score_card import card, figures, sorted_by
from workbench.variants.variant_files import (
    Shelf,
    delete_variant,
    duplicate_variant,
    list_variants,
    next_name,
    rename_variant,
    restore_variant,
)
from workbench.variants.variants import load_variant, planned_keys, save_variant
from workbench.view.metric_rules import RULES, Better


@pytest.fixture
def project(tmp_path: Path) -> Project:
    return Project(tmp_path / "project")


def finger(wall_mm: float = 2.0) -> State:
    design = load_design("finger").replace("layers.elastomer_mm", wall_mm)
    return fresh_state(design)


def test_a_variant_comes_back_as_it_was_kept(project: Project) -> None:
    """Design, press, tags and note; of figures without results only the depth."""
    state = finger(2.5)
    save_variant(project, "thick", state, tags=("wall", "wall", " a b "), note="<b>\nsecond line")
    found = load_variant(project, "thick")
    assert dataclasses.replace(found.state.design, name="geltip") == dataclasses.replace(
        state.design, name="geltip"
    )
    assert found.state.case == state.case
    assert found.tags == ("wall", "a b")
    assert found.note == "<b>\nsecond line"
    assert found.metrics == {"press_depth_mm": 1.0}


def test_a_file_of_the_first_version_is_read(project: Project) -> None:
    """It had a shoot_key, a name and figures, NaN among them, and nothing else."""
    save_variant(project, "old", finger())
    path = project.folder / "variants" / "old.toml"
    head = path.read_text().split("[variant]")[0]
    path.write_text(
        f'{head}[variant]\nname = "old"\nshoot_key = "abc123"\n'
        "[variant.metrics]\nnormal_force_N = 1.5\nglare_percent = nan\n"
    )
    found = load_variant(project, "old")
    assert found.keys == {"shoot": "abc123"}
    assert found.metrics == {"normal_force_N": 1.5}
    assert (found.tags, found.note) == ((), "")


def test_broken_files_are_listed_with_their_reason_and_spoil_no_other(project: Project) -> None:
    """Nonsense, a newer schema, a hostile name, a path as key: the good one stays."""
    save_variant(project, "good", finger())
    folder = project.folder / "variants"
    text = (folder / "good.toml").read_text()
    (folder / "broken.toml").write_text("this is = not [toml")
    (folder / "newer.toml").write_text(text.replace("schema = 1", "schema = 99"))
    (folder / "plain.toml").write_text("x = 1\n")
    (folder / "binary.toml").write_bytes(b"\xff\xfe\x00")
    (folder / "key.toml").write_text(
        text.replace("[variant.keys]", '[variant.keys]\nshoot = "../../x"')
    )
    (folder / "<script>alert(1)<script>.toml").write_text(text)
    (folder / "number.toml").write_text(
        text.replace("press_depth_mm = 1.0", 'press_depth_mm = "x"')
    )
    entries = {entry.name: entry for entry in Shelf(project).entries()}
    assert entries.pop("good").variant is not None
    assert len(entries) == 7
    assert all(entry.variant is None and entry.reason for entry in entries.values())
    assert "schema 99" in entries["newer"].reason
    delete_variant(project, "<script>alert(1)<script>")
    assert "<script>alert(1)<script>" not in list_variants(project)


@pytest.mark.parametrize("name", ["<script>alert(1)</script>", "", "-", "a/b", "x ", "a\nb", ".x"])
def test_names_that_cannot_be_files_are_refused(project: Project, name: str) -> None:
    """Nothing is written."""
    with pytest.raises(DesignError):
        save_variant(project, name, finger())
    assert not list_variants(project)


def test_rename_copy_delete_and_restore_lose_nothing(project: Project) -> None:
    """The thumbnail goes along; a restored name that is taken meanwhile gets a number."""
    save_variant(project, "v1.2", finger())
    thumbnail = project.folder / "variants" / "v1.2.png"
    thumbnail.write_bytes(b"thumbnail")
    rename_variant(project, "v1.2", "v1.3")
    copy = duplicate_variant(project, "v1.3")
    assert list_variants(project) == ["v1.3", "v1.3 2"] and copy == "v1.3 2"
    with pytest.raises(DesignError, match="already"):
        rename_variant(project, "v1.3", copy)
    kept = delete_variant(project, "v1.3")
    save_variant(project, "v1.3", finger(3.0))
    assert restore_variant(project, kept) == "v1.3 3"
    assert load_variant(project, "v1.3 3").state.design.layers.elastomer_mm == 2.0
    assert load_variant(project, "v1.3").state.design.layers.elastomer_mm == 3.0
    assert (project.folder / "variants" / "v1.3 3.png").read_bytes() == b"thumbnail"
    with pytest.raises(DesignError):
        delete_variant(project, "never")


def test_a_shelf_follows_a_file_that_changed(project: Project) -> None:
    """Edited by hand into nonsense, the file is broken at the next look, and good again after."""
    shelf = Shelf(project)
    save_variant(project, "a", finger())
    path = project.folder / "variants" / "a.toml"
    text = path.read_text()
    assert shelf.entries()[0].variant is not None
    path.write_text("nonsense")
    assert shelf.entries()[0].variant is None
    path.write_text(text)
    assert shelf.entries()[0].variant is not None


def test_a_list_plans_what_changed_alone(project: Project, monkeypatch: pytest.MonkeyPatch) -> None:
    """Three variants: planned once each; then, one of them written anew, that one alone."""
    for number in range(3):
        save_variant(project, f"wall {number}", finger(1.0 + number))
    planned: list[float] = []

    def counted(state: State) -> dict[str, str]:
        planned.append(state.design.layers.elastomer_mm)
        return planned_keys(state)

    monkeypatch.setattr("workbench.variants.variant_files.planned_keys", counted)
    shelf = Shelf(project)
    first = shelf.entries()
    assert shelf.entries() == first
    assert planned == [1.0, 2.0, 3.0]
    save_variant(project, "wall 1", finger(2.5), replace=True)
    assert shelf.entries()[1].planned == planned_keys(finger(2.5))
    assert planned == [1.0, 2.0, 3.0, 2.5]


def test_next_name_is_free() -> None:
    """After Z come numbers, none of which is taken."""
    letters = [f"variant {chr(65 + k)}" for k in range(26)]
    assert next_name([]) == "variant A"
    assert next_name([*letters, "variant 2"]) == "variant 3"


def test_figures_of_results_that_are_gone_are_left_out(project: Project) -> None:
    """A key whose result was swept gives no figure and no error."""
    assert figures(project.store, finger(), {"shoot": "gone", "build": "gone"}) == {
        "press_depth_mm": 1.0
    }


def test_every_score_of_the_maps_has_a_rule_of_the_same_direction() -> None:
    """The maps declare more or less; the score card says the same, and none has a name twice."""
    kinds = map_kinds()
    assert len(kinds) >= 9 and len({kind.figure for kind in kinds.values()}) == len(kinds)
    for kind in kinds.values():
        wanted = Better.HIGHER if kind.more_is_better else Better.LOWER
        assert RULES[kind.figure].better is wanted
        assert RULES[kind.figure].stage == "maps"


def test_best_is_marked_by_the_rule_and_missing_says_what_to_run() -> None:
    """More grey is best, less glare is best, force is neutral; a tie of all has no best."""
    shown = card(
        [
            ("a", {"contact_change_mean_grey": 3.0, "glare_percent": 5.0, "membrane_g": 2.0}),
            ("b", {"contact_change_mean_grey": 4.0, "peak_normal_force_N": 1.0, "membrane_g": 2.0}),
            ("c", {"contact_change_mean_grey": 4.0, "glare_percent": 1.0, "membrane_g": 2.0}),
        ]
    )
    lines = {line.rule.name: line.cells for line in shown.lines}
    assert [cell.best for cell in lines["contact_change_mean_grey"]] == [False, True, True]
    assert [cell.best for cell in lines["glare_percent"]] == [False, False, True]
    assert not any(cell.best for cell in lines["membrane_g"])
    assert not any(cell.best for cell in lines["peak_normal_force_N"])
    assert lines["glare_percent"][1].remedy == "Measure maps"
    # The press of a ran and left the force out: running it again would not help.
    assert lines["peak_normal_force_N"][0].remedy == ""
    assert "Measure maps (b)" in remedies(shown)


def test_sorting_puts_the_best_first_and_missing_last() -> None:
    """Higher is better for grey, lower for glare; NaN is missing."""
    designs = [
        ("a", {"contact_change_mean_grey": 3.0, "glare_percent": 2.0}),
        ("b", {"contact_change_mean_grey": math.nan}),
        ("c", {"contact_change_mean_grey": 5.0, "glare_percent": 1.0}),
    ]
    by_grey = [name for name, _ in sorted_by(designs, "contact_change_mean_grey")]
    assert by_grey == ["c", "a", "b"]
    assert [name for name, _ in sorted_by(designs, "glare_percent")] == ["c", "a", "b"]


def test_only_what_differs_is_listed_by_group_with_units() -> None:
    """Wall and press depth differ; a shape value left out equals its default."""
    a, b = finger(2.0), finger(2.5)
    press = dataclasses.replace(b.case.press, depth_mm=1.5)
    b = State(design=b.design, case=dataclasses.replace(b.case, press=press))
    rows = [(r.group, r.label, r.unit, r.a, r.b) for r in parameter_differences(a, b)]
    assert rows == [
        ("Layers", "elastomer", "mm", "2", "2.5"),
        ("Press", "depth", "mm", "1", "1.5"),
    ]
    assert "depth 1 and 1.5" in press_notice(a, b)
    assert press_notice(a, finger(3.0)) == ""


def test_presses_at_two_places_are_told() -> None:
    """The target counts, unless both stand where their family aims."""
    a = finger(2.0)
    aside = dataclasses.replace(a.case.press, target_mm=(0.0, 14.0, 20.0))
    b = State(design=a.design, case=dataclasses.replace(a.case, press=aside))
    assert "target" in press_notice(a, b)
    assert press_notice(a, fresh_state(load_design("thumb"))) == ""


def test_a_family_with_other_parameters_compares() -> None:
    """Parameters that one has not are a dash."""
    rows = parameter_differences(finger(), fresh_state(load_design("trunk")))
    assert any(row.group == "Shape" and row.a == "–" for row in rows)
    assert any(row.label == "family" for row in rows)


def test_changes_speak_for_b_or_against_it() -> None:
    """Percent is against A, of either sign; neutral and missing figures speak for neither."""
    found = changes(
        {"contact_change_mean_grey": 4.0, "glare_percent": 0.0, "stiffness_N_per_mm": 1.0},
        {"contact_change_mean_grey": 5.0, "glare_percent": 1.0, "new_thing_mm": 2.0},
    )
    by_name = {change.rule.name: change for change in found}
    grey = by_name["contact_change_mean_grey"]
    assert (grey.verdict, grey.percent) == ("better", 25.0)
    assert (by_name["glare_percent"].verdict, by_name["glare_percent"].percent) == ("worse", None)
    assert by_name["stiffness_N_per_mm"].verdict == ""
    assert by_name["new_thing_mm"].rule.better is Better.NEUTRAL
    assert tally(found) == (1, 1)


def test_tables_escape_names(project: Project) -> None:
    """A hostile name is text wherever it is shown."""
    hostile = "<script>alert('1')</script>"
    rows = parameter_differences(finger(), finger(3.0))
    shown = card([(hostile, {"glare_percent": 1.0})])
    pages = (
        card_table(shown),
        parameter_table(rows, hostile, hostile),
        change_table(changes({"glare_percent": 1.0}, {"glare_percent": 2.0}), hostile, hostile),
    )
    for page in pages:
        assert "<script" not in page and "&lt;script" in page and "alert('1')" not in page
