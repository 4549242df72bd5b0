"""The sources of the forces of one press: totals and disagreement in closed form, and in words."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from tests.unit.test_force_peaks import flat
from ui.page.imaging import legend
from ui.panels.results.source_words import doubt_text, sources_text
from workbench.core.result.force_field import ForceField, Source
from workbench.view.force_sources import PAIRS, Forces, Shown, choices, disagreement, totals

SKIN = flat(1.0)
"""A square of 10 mm; the forces below act in its middle, where a vertex stands for 1 mm2."""
MIDDLE = len(SKIN.points_mm) // 2


def field(moved_mm: float, force_N: float, source: Source = Source.FEM) -> ForceField:
    """One frame: the skin's middle vertex moves and carries a force, in -Z and X."""
    displacement = np.zeros((1, len(SKIN.points_mm), 3), np.float32)
    displacement[0, MIDDLE, 2] = -moved_mm
    force = np.zeros((1, len(SKIN.points_mm), 3), np.float32)
    force[0, MIDDLE] = (0.25 * force_N, 0.0, -force_N)
    return ForceField(
        source=source,
        displacement_mm=displacement,
        contact_force_N=force,
        reaction_N=-force.sum(axis=1).astype(np.float64),
        target_mm=np.zeros(3),
        normal=np.array([0.0, 0.0, 1.0]),
        tangent_u=np.array([1.0, 0.0, 0.0]),
        indenter_pose=np.zeros((1, 7)),
        residual=np.array([1e-7]),
        balance=np.zeros(1),
        converged=np.ones(1, bool),
    )


def test_totals_split_the_reaction() -> None:
    """2 N inward with 0.5 N along X: normal 2, tangential 0.5; peaks are those of the skin."""
    given = field(0.0, 2.0)
    found = totals(Source.FEM, given, 0, SKIN)
    assert found.normal_N == pytest.approx(2.0)
    assert found.tangential_N == pytest.approx(0.5)
    # On the vertex's 1 mm2, along the normal of a skin that has not moved.
    assert found.peak_MPa == pytest.approx(2.0, rel=1e-6)
    # All of it acts within 1 mm of the vertex but for the corners of six triangles.
    assert 0.8 * np.hypot(2.0, 0.5) < found.peak_disc_N < np.hypot(2.0, 0.5)
    assert found.residual == pytest.approx(1e-7)


def test_the_source_s_own_pressure_is_its_peak() -> None:
    """0.3 MPa where it says so; without forces of vertices there is no peak, and no error."""
    count = len(SKIN.points_mm)
    own = np.full((1, count), 0.3, np.float32)
    told = dataclasses.replace(field(1.0, 2.0), pressure_MPa=own)
    assert totals(Source.FEM, told, 0, SKIN).peak_MPa == pytest.approx(0.3)
    none = dataclasses.replace(field(1.0, 2.0), contact_force_N=np.zeros((0, 0, 3), np.float32))
    found = totals(Source.MPM, none, 0, SKIN)
    assert np.isnan(found.peak_MPa) and np.isnan(found.peak_disc_N)
    assert found.normal_N == pytest.approx(2.0)


def test_disagreement_is_relative_to_the_second() -> None:
    """1.1 against 1.0 mm and 1.8 against 2 N: 0.1 mm of one vertex that moves, -10 %."""
    found = disagreement(field(1.1, 1.8, Source.MPM), field(1.0, 2.0), 0)
    assert found.displacement_mm == pytest.approx(0.1, rel=1e-5)
    assert found.farthest_mm == pytest.approx(1.0)
    assert found.normal_share == pytest.approx(-0.1)


def test_a_skin_at_rest_says_nothing() -> None:
    """Nothing moves and nothing presses: no difference, and no share of nothing."""
    found = disagreement(field(0.0, 0.0), field(0.0, 0.0), 0)
    assert found.displacement_mm == found.farthest_mm == 0.0
    assert np.isnan(found.normal_share)


def test_the_reaction_of_learned_forces_has_no_residual() -> None:
    """NaN stands for what is not solved for."""
    learned = dataclasses.replace(field(1.0, 2.0, Source.LEARNED), residual=np.array([np.nan]))
    assert np.isnan(totals(Source.LEARNED, learned, 0, SKIN).residual)


MPM = field(1.0, 1.8, Source.MPM)
FEM = field(1.0, 2.0)
LEARNED = dataclasses.replace(
    field(1.1, 2.1, Source.LEARNED), residual=np.array([np.nan]), solver="net on cpu, 7 ms a frame"
)
DIFFERENCES = (Shown.FEM_DIFFERENCE, Shown.LEARNED_DIFFERENCE, Shown.LEARNED_CONTACT)


@pytest.mark.parametrize(
    ("others", "offered"),
    [
        ((), [Shown.MPM]),
        ((FEM,), [Shown.MPM, Shown.FEM, Shown.FEM_DIFFERENCE]),
        ((LEARNED,), [Shown.MPM, Shown.LEARNED, Shown.LEARNED_CONTACT]),
        (
            (FEM, LEARNED),
            [Shown.MPM, Shown.FEM, Shown.LEARNED, Shown.FEM_DIFFERENCE, Shown.LEARNED_DIFFERENCE],
        ),
    ],
)
def test_sources_and_their_differences_are_offered(
    others: tuple[ForceField, ...], offered: list[Shown]
) -> None:
    """The network is held against finite elements where they are, else the contact solver."""
    found: dict[Source, Forces] = {one.source: one for one in (MPM, *others)}
    assert choices(found) == offered
    for shown in offered:
        source, against = PAIRS[shown]
        assert source in found and (against is None or against in found)
        assert (against is not None) == (shown in DIFFERENCES)


def test_all_sources_stand_in_the_table_and_are_held_against_finite_elements() -> None:
    """1.8 and 2.1 against 2 N: -10 % and +5 %, and the network is named."""
    text = sources_text({Source.MPM: MPM, Source.FEM: FEM, Source.LEARNED: LEARNED}, 0, SKIN)
    rows = [line for line in text.splitlines() if line.startswith("| ")]
    assert [row.split("|")[1].strip() for row in rows] == [
        *("source", "contact solver", "finite elements", "learned"),
    ]
    assert "| learned | 2.100 | 0.525 |" in text
    assert "| peak kPa | 2 mm disc mN |" in text
    assert "The contact solver's normal force is -10.0 % from that of finite elements" in text
    assert "The network's normal force is +5.0 % from that of finite elements" in text
    assert "its displacement 100 µm (rms) of 1000" in text
    assert "net on cpu, 7 ms a frame" in text and "nan" not in text


def test_without_finite_elements_the_network_is_held_against_the_contact_solver() -> None:
    """2.1 against 1.8 N: +16.7 %; its displacement is the solver's own."""
    learned = dataclasses.replace(LEARNED, displacement_mm=MPM.displacement_mm, note="E doubled")
    text = sources_text({Source.MPM: MPM, Source.LEARNED: learned}, 0, SKIN)
    assert "+16.7 % from that of the contact solver, its displacement is the contact" in text
    assert "Note: E doubled" in text


def test_advice_stands_below_the_table() -> None:
    """Where no doubt above it says the same."""
    found = {Source.MPM: MPM, Source.LEARNED: LEARNED}
    text = sources_text(found, 0, SKIN, advice="Nearest: learned.")
    assert text.endswith("<small>Nearest: learned.</small>")
    assert "Nearest" not in sources_text(found, 0, SKIN)


def test_what_is_of_an_earlier_press_is_marked() -> None:
    """Each by what would bring it up to date."""
    text = sources_text(
        {Source.MPM: MPM, Source.FEM: FEM, Source.LEARNED: LEARNED},
        0,
        SKIN,
        stale=(Source.FEM, Source.LEARNED),
    )
    assert text.startswith(
        "**stale**: finite elements are of an earlier design or press; solve again\n\n"
        "**stale**: learned forces are of an earlier design or press; predict again\n\n|"
    )


def test_a_doubt_is_plain_text_whatever_it_holds() -> None:
    """The name of a file of weights is somebody else's."""
    text = doubt_text("<script> is soft", "Nothing was measured")
    assert "Not known to the network" in text and "<script>" not in text
    assert text.endswith("\n\nNothing was measured")
    badge = legend("Pressure", 1.0, "kPa", (1, 2, 3), badge="not <known>")
    assert "not &lt;known&gt;" in badge
    assert "padding" not in legend("Pressure", 1.0, "kPa", (1, 2, 3))
