"""The headline: standings by limits of either direction, own limits kept in a file, its HTML."""

from __future__ import annotations

from pathlib import Path

import pytest

from ui.page.headline_html import MARKS, headline_html
from workbench.core.base.errors import DesignError
from workbench.project.limits import FILE, read_limits, write_limits
from workbench.project.named_designs import load_design
from workbench.project.prices import FILE as PRICES
from workbench.project.prices import Prices, parts_cost, read_prices, write_prices
from workbench.view.headline import COST_RULE, HEADLINES, Bounds, Standing, headlines
from workbench.view.metric_rules import RULES, Better

CONTRAST, DENT, FORCE = "contact_contrast_1", "readable_dent_median_mm", "peak_normal_force_N"
COST = COST_RULE.name


def standing(figure: str, figures: dict[str, float], **own: Bounds) -> Standing:
    """How one of them stands."""
    shown = headlines(figures, own)
    return next(one.standing for one in shown if one.headline.figure == figure)


@pytest.mark.parametrize(
    ("bounds", "value", "expected"),
    [
        (Bounds(good=10.0, poor=3.0), 10.0, Standing.GOOD),
        (Bounds(good=10.0, poor=3.0), 9.9, Standing.FAIR),
        (Bounds(good=10.0, poor=3.0), 3.0, Standing.POOR),
        (Bounds(good=0.1, poor=0.5), 0.1, Standing.GOOD),
        (Bounds(good=0.1, poor=0.5), 0.3, Standing.FAIR),
        (Bounds(good=0.1, poor=0.5), 0.7, Standing.POOR),
    ],
)
def test_limits_hold_both_ways(bounds: Bounds, value: float, expected: Standing) -> None:
    """The ends belong to good and to poor, whether more or less is better."""
    assert bounds.standing(value) is expected
    assert standing(CONTRAST, {CONTRAST: value}, **{CONTRAST: bounds}) is expected


def test_our_limits_go_the_way_of_the_score_card() -> None:
    """A figure that is better when higher is good above poor; every headline has a rule."""
    for one in HEADLINES:
        if one.by_choice:
            continue
        better = RULES[one.figure].better
        if one.bounds is not None:
            assert (one.bounds.good > one.bounds.poor) == (better is Better.HIGHER)


def test_a_design_is_makeable_once_all_its_parts_are_checked() -> None:
    """A mould whose checks passed says nothing of a housing that is not made; a failed one does."""
    passed, failed = {"checks_bad": 0.0}, {"checks_bad": 1.0}
    unmade = ["the housing", "the casting"]

    def makeable(figures: dict[str, float], unmade: list[str]) -> tuple[str, Standing, str]:
        shown = headlines(figures, {}, unmade=unmade)
        found = next(one for one in shown if one.headline.figure == "checks_bad")
        return found.text, found.standing, found.reason

    assert makeable(passed, [])[:2] == ("yes", Standing.GOOD)
    text, standing, reason = makeable(passed, unmade)
    assert (text, standing) == ("so far", Standing.OPEN)
    assert "the housing and the casting not made yet: Make parts" in reason
    assert makeable(failed, unmade)[:2] == ("no", Standing.POOR)
    # What was known before an edit was known of all its parts.
    shown = headlines({}, {}, before=passed, unmade=unmade)
    assert next(one.text for one in shown if one.headline.figure == "checks_bad") == "yes"


def test_force_has_no_limit_until_the_designer_sets_one() -> None:
    """Stiff or soft is a choice; what is not known says what to run."""
    assert standing(FORCE, {FORCE: 3.0}) is Standing.PLAIN
    assert standing(FORCE, {FORCE: 3.0}, **{FORCE: Bounds(good=1.0, poor=2.0)}) is Standing.POOR
    assert standing(FORCE, {}) is Standing.OPEN
    assert "Run press" in headlines({}, {})[0].reason


@pytest.mark.parametrize(
    ("value", "text"), [(143.4, "143"), (100.0, "100"), (99.4, "99"), (0.0343, "0.034")]
)
def test_figures_are_brief(value: float, text: str) -> None:
    """Two digits, or whole numbers; never a power of ten."""
    assert headlines({DENT: value}, {})[3].text == f"{text} mm"


def test_a_dent_that_no_skin_has_is_none() -> None:
    """A white image: its figure is a division by no light at all, which is no length to show."""
    shown = headlines({DENT: 2e11}, {})[3]
    assert (shown.text, shown.standing) == ("none", Standing.POOR)
    assert "white" in shown.reason


def test_every_figure_says_what_makes_it_better() -> None:
    """Of one that is good too: a designer may want it twice as large."""
    shown = next(one for one in headlines({CONTRAST: 0.5}, {}) if one.headline.figure == CONTRAST)
    assert shown.standing is Standing.GOOD
    assert shown.headline.remedy in shown.reason


def test_makeable_counts_the_checks() -> None:
    """A failed one is poor, one to look at fair, none good; not checked is not known."""
    for bad, look_at, expected in (
        (1, 2, Standing.POOR),
        (0, 2, Standing.FAIR),
        (0, 0, Standing.GOOD),
    ):
        counts = {"checks_bad": float(bad), "checks_warning": float(look_at)}
        assert standing("checks_bad", counts) is expected
    assert standing("checks_bad", {}) is Standing.OPEN


def test_makeable_names_what_failed() -> None:
    """The first three by name, and how many more; nothing of the design before an edit."""
    names = ["draft (upper half)", "wall (membrane)", "room (housing)", "vent (mould)"]
    shown = headlines({"checks_bad": 4.0}, {}, checks=names)
    reason = next(one.reason for one in shown if one.headline.figure == "checks_bad")
    assert reason.endswith("draft (upper half), wall (membrane), room (housing) and 1 more.")
    before = headlines({}, {}, before={"checks_bad": 4.0}, checks=names)
    assert not any("draft" in one.reason for one in before)


def test_a_figure_of_before_an_edit_says_so() -> None:
    """It keeps its value, marked; one that is known anew is not marked."""
    shown = {
        one.headline.figure: one
        for one in headlines({FORCE: 2.0}, {}, before={FORCE: 1.0, CONTRAST: 0.2})
    }
    assert not shown[FORCE].old
    assert shown[FORCE].text == "2 N"
    assert shown[CONTRAST].old
    assert "before the last edits" in shown[CONTRAST].reason
    assert "(0.2)" in headline_html(tuple(shown.values()))


def test_own_limits_are_kept_and_bad_ones_refused(tmp_path: Path) -> None:
    """To the last digit and back; equal ends, words and broken files are said with the file."""
    assert read_limits(tmp_path) == {}
    kept = {CONTRAST: Bounds(good=0.123456789, poor=0.1), DENT: Bounds(good=0.1, poor=0.3)}
    write_limits(tmp_path, kept)
    assert read_limits(tmp_path) == kept
    with pytest.raises(DesignError, match="two different numbers"):
        write_limits(tmp_path, {DENT: Bounds(good=0.1, poor=0.1)})
    assert read_limits(tmp_path) == kept
    for text in ("[a\n", "[a]\ngood = 'x'\npoor = 1\n", "a = 3\n", "[a]\ngood = nan\npoor = 1\n"):
        (tmp_path / FILE).write_text(text)
        with pytest.raises(DesignError) as refused:
            read_limits(tmp_path)
        assert refused.value.hint


def test_parts_cost_what_the_designer_pays(tmp_path: Path) -> None:
    """By hand: 9 LEDs, a camera, 2 ml of 1.1 g/ml and the rest; without prices no figure stands."""
    assert read_prices(tmp_path) is None
    prices = Prices(led=0.4, camera=18.0, gram=0.05, base=6.0)
    write_prices(tmp_path, prices)
    assert read_prices(tmp_path) == prices
    design = load_design("geltip")
    design = design.replace("optics.ring.count", 9).replace("material.density_g_cm3", 1.1)
    cost = parts_cost(design, 2000.0, prices)
    assert cost == pytest.approx(9 * 0.4 + 18.0 + 2.2 * 0.05 + 6.0)
    words = [one.headline.word for one in headlines({COST: cost}, {})]
    assert words[-1] == "Parts" and "Parts" not in [one.headline.word for one in headlines({}, {})]
    with pytest.raises(DesignError, match="must be 0 or more"):
        write_prices(tmp_path, Prices(led=-1.0))
    for text in ("led = 'x'\n", "lamp = 3\n", "led\n", "led = nan\n"):
        (tmp_path / PRICES).write_text(text)
        with pytest.raises(DesignError) as refused:
            read_prices(tmp_path)
        assert refused.value.hint
    write_prices(tmp_path, None)
    assert read_prices(tmp_path) is None


def test_hue_is_not_the_only_carrier() -> None:
    """Good, fair, poor and not known have marks of different shapes, and words for a reader."""
    marks = [mark for mark, _ in MARKS.values()]
    assert len(set(marks)) == len(marks)
    text = headline_html(headlines({CONTRAST: 0.01}, {}))
    assert 'title="Contrast: 0.01, poor"' in text and ">, poor</em>" in text
    assert "■" in text
