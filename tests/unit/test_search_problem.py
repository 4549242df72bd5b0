"""The file of a search: what it may say, what is refused before anything runs, what is applied."""

from __future__ import annotations

from pathlib import Path

import pytest

from workbench.cli.command_line import main
from workbench.core.base.errors import DesignError
from workbench.planning.plan import plan
from workbench.project.prices import Prices, write_prices
from workbench.project.project import Project
from workbench.search.applying import base_parameters, state_of
from workbench.search.choice_fields import CHOICES
from workbench.search.problem import Goal, Limit, Problem, Want
from workbench.search.problem_file import read_problem
from workbench.search.search_figures import KNOWN, stages_of
from workbench.search.varied import known_path, read_vary
from workbench.search.wishes import WISHES

TILT = "design.optics.ring.tilt_deg"
VARY = f'[[vary]]\nfield = "{TILT}"\nlow = -10\nhigh = 10\n'
GOAL = '[[goal]]\nfigure = "light_evenness_p5_over_p95_1"\nwant = "max"\n'
WHOLE = f'base = "geltip"\n{VARY}{GOAL}'


def read(text: str, folder: Path = Path()) -> Problem:
    return read_problem(text, Project(folder / "project"), folder=folder)


def test_a_whole_file_is_read(tmp_path: Path) -> None:
    """Ranges, choices, whole numbers, links, wishes, limits, settings: each where it belongs."""
    problem = read(
        'base = "geltip"\nwishes = ["smallest that sees the tip", "robust to .3 mm"]\n'
        'draft = ["optics.baking.photons=100000"]\neven_light = true\nseed = 7\n'
        + VARY
        + '[[vary]]\nfield = "optics.ring.count"\nlow = 3\nhigh = 12\n'
        '[[vary]]\nfield = "optics.ring.mount"\nchoices = ["cavity", "shell"]\n'
        '[[link]]\nfield = "optics.ring.radius_mm"\nfollows = "shape.outer_radius_mm"\n'
        '[[limit]]\nfigure = "tip_seen_percent"\nat_least = 80\n[tolerances]\ntwins = 3\n',
        tmp_path,
    )
    tilt, count, mount = problem.vary
    assert (tilt.path, tilt.low, tilt.high, tilt.whole) == (TILT, -10.0, 10.0, False)
    assert count.whole and mount.choices == ("cavity", "shell")
    # The ring has 12.5 mm beside a body of 15: it keeps that distance.
    assert problem.links[0].offset == pytest.approx(12.5 - 15.0)
    assert problem.goals == (Goal(figure="membrane_ml", want=Want.MIN),)
    # The file's own limit takes the place of the wish's.
    assert problem.limits == (Limit(figure="tip_seen_percent", at_least=80.0),)
    assert (problem.tolerances.twins, problem.tolerances.led_mm) == (3, 0.3)
    assert problem.even_light and problem.seed == 7


def test_choices_may_be_words_or_numbers(tmp_path: Path) -> None:
    """The base's own, beside which they are told, is written as they are."""
    choices = 'choices = ["9", "12"]\n'
    text = f'{WHOLE}[[vary]]\nfield = "optics.ring.count"\n{choices}'
    text += '[[vary]]\nfield = "shape.outer_radius_mm"\nchoices = [12, 15]\n'
    problem = read(text, tmp_path)
    own = base_parameters(problem)
    assert (own["design.optics.ring.count"], own["design.shape.outer_radius_mm"]) == ("9", "15")
    assert problem.vary[1].span == "9, 12"
    few = state_of(problem, {"design.shape.outer_radius_mm": "12"}).design
    assert few.shape["outer_radius_mm"] == 12


def test_fields_of_words_take_all_that_the_page_offers(tmp_path: Path) -> None:
    """Of the design that stands; a choice that is none is refused."""
    base = read(WHOLE, tmp_path).base
    for choice in CHOICES.values():
        row = {"field": choice.path, "choices": list(choice.values)}
        assert read_vary(row, base).choices == choice.values


def test_the_projects_prices_count_where_the_cost_is_asked_for(tmp_path: Path) -> None:
    """A file's own take their place; a search that asks for no cost goes on when they change."""
    asked = f'{WHOLE}[[limit]]\nfigure = "parts_cost_1"\nat_most = 90\n'
    prices = Prices(led=0.4, camera=18.0)
    (tmp_path / "project").mkdir()
    write_prices(tmp_path / "project", prices)
    assert read(asked, tmp_path).prices == prices
    assert read(f"{asked}[prices]\nled = 2\n", tmp_path).prices == Prices(led=2.0)
    assert read(WHOLE, tmp_path).prices is None


def test_values_reach_the_design_and_links_follow(tmp_path: Path) -> None:
    """A radius of 13 mm: the ring follows to 10.5, the press is aimed at the lower tip."""
    problem = read(
        f'base = "geltip"\n{GOAL}[[vary]]\nfield = "shape.outer_radius_mm"\nlow = 12\nhigh = 15\n'
        '[[link]]\nfield = "optics.ring.radius_mm"\nfollows = "shape.outer_radius_mm"\n',
        tmp_path,
    )
    state = state_of(problem, {"design.shape.outer_radius_mm": 13.0})
    assert state.design.shape["outer_radius_mm"] == 13.0
    assert state.design.optics.ring.radius_mm == pytest.approx(10.5)
    assert state.case.press.target_mm[2] < problem.base.case.press.target_mm[2]
    drafted = state_of(problem, {}, draft=True)
    assert drafted.design.optics.baking.photons == 400_000
    assert drafted.case.settings.grid_mm == 0.75
    # No value at all is the base itself, to the key.
    same = state_of(problem, {})
    keys = [plan(s.design, s.case)["shoot"].key for s in (same, problem.base)]
    assert keys[0] == keys[1]


REFUSED = {
    "a misspelt field": (WHOLE.replace("tilt_deg", "tild_deg"), "tilt_deg"),
    "a misspelt press": (WHOLE.replace(TILT, "case.press.dept_mm"), "case.press.depth_mm"),
    "a misspelt figure": (WHOLE.replace("evenness", "eveness"), "light_evenness_p5_over_p95_1"),
    "a misspelt word": (WHOLE.replace("[[goal]]", "[[goals]]"), "goal"),
    "a misspelt wish": (f'wishes = ["brightest and even"]\n{WHOLE}', "brightest and most even"),
    "an empty range": (WHOLE.replace("high = 10", "high = -10"), "less than high"),
    "a range that no design takes": (WHOLE.replace("-10", "200").replace("10\n", "300\n"), ""),
    "a field that is no number": (WHOLE.replace("tilt_deg", "mount"), "choices"),
    "a choice that is refused": (
        f'base = "geltip"\n{GOAL}[[vary]]\nfield = "optics.ring.mount"\nchoices = ["shell", "lid"]',
        "",
    ),
    "no goal": (f'base = "geltip"\n{VARY}', "goal"),
    "nothing that varies": (f'base = "geltip"\n{GOAL}', "vary"),
    "a goal without a way": (WHOLE.replace('"max"', '"most"'), "max, min or target"),
    "a target without a value": (WHOLE.replace('"max"', '"target"'), "value"),
    "a limit without an end": (f'{WHOLE}[[limit]]\nfigure = "checks_bad"', "at_least"),
    "limits that exclude each other": (
        f'{WHOLE}[[limit]]\nfigure = "checks_bad"\nat_least = 2\nat_most = 1',
        "at_least",
    ),
    "a limit that the base breaks by construction": (
        f'{WHOLE}[[limit]]\nfigure = "led_count_1"\nat_most = 3',
        "optics.ring.count",
    ),
    "costs without prices": (f'{WHOLE}[[limit]]\nfigure = "parts_cost_1"\nat_most = 3', "prices"),
    "a field set twice": (WHOLE + VARY, "vary it"),
    "settings that are none": (f'draft = ["fast"]\n{WHOLE}', "draft ="),
    "an unknown base": (WHOLE.replace('"geltip"', '"geltib"'), "geltip"),
    "broken TOML": ("base =", "line"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_cannot_be_searched_is_refused_with_a_remedy(what: str, tmp_path: Path) -> None:
    """Before anything is computed; the hint has the nearest name, or what to write."""
    text, remedy = REFUSED[what]
    with pytest.raises(DesignError) as raised:
        read(text, tmp_path)
    assert raised.value.hint and remedy in raised.value.hint
    assert not (tmp_path / "project" / "store").exists()


def test_a_figure_that_the_light_model_has_not_is_refused(tmp_path: Path) -> None:
    """Photons traced for each frame have no maps; the paper's fields no evenness."""
    for model in ("photons", "linear"):
        base = tmp_path / "base.toml"
        base.write_text(f'family = "finger"\n[optics]\nlight_model = "{model}"\n')
        with pytest.raises(DesignError, match="does not exist for the base"):
            read(WHOLE.replace("geltip", "base.toml"), tmp_path)


def test_the_command_says_what_is_wrong_and_ends_with_2(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Exit code 2, the field and the nearest one."""
    file = tmp_path / "search.toml"
    file.write_text(WHOLE.replace("tilt_deg", "tild_deg"))
    words = ["search", str(file), "--out", str(tmp_path / "out"), "--project", str(tmp_path)]
    assert main(words) == 2
    said = capsys.readouterr().err
    assert "tild_deg" in said and "tilt_deg" in said
    assert not (tmp_path / "out").exists()
    file.write_text(WHOLE)
    assert main([*words, "--trials", "0"]) == 2


@pytest.mark.parametrize("words", WISHES)
def test_every_wish_names_figures_that_there_are(words: str) -> None:
    """And those come from stages."""
    wish = WISHES[words]
    for each in (*wish.goals, *wish.limits):
        assert each.figure in KNOWN
    assert wish.goals or wish.tolerances
    assert isinstance(stages_of(tuple(goal.figure for goal in wish.goals)), tuple)


def test_a_limit_says_how_far_beyond_a_figure_is() -> None:
    """Over the limit's own size; 0 and less is allowed."""
    both = Limit(figure="x", at_least=2.0, at_most=4.0)
    assert both.excess(5.0) == pytest.approx(0.25)
    assert both.excess(1.0) == pytest.approx(0.5)
    assert both.excess(3.0) < 0.0
    assert Limit(figure="x", at_most=0.0).excess(2.0) == pytest.approx(2.0)
    assert Goal(figure="x", want=Want.TARGET, value=3.0).loss(1.0) == 2.0
    assert Goal(figure="x", want=Want.MAX).loss(1.0) == -1.0


def test_fields_may_be_written_short(tmp_path: Path) -> None:
    """With or without `design`; the press by its own name."""
    base = read(WHOLE, tmp_path).base
    assert known_path("optics.ring.tilt_deg", base, "") == TILT
    assert known_path("press.depth_mm", base, "") == "case.press.depth_mm"
    assert known_path("optics.ring.emission_exponent", base, "").startswith("design.")
