"""What is shown while dragging is what a press of its own would give."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from sim.contact.live_contact import LiveContact, Way, one_frame
from sim.contact.press import press_membrane
from sim.contact.studies.specimens import flat_block
from workbench.core.base.errors import Cancelled
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter
from workbench.core.press.motion import slide
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.sensing import Contact

pytestmark = pytest.mark.usefixtures("taichi_device")

BLOCK = flat_block(width_mm=22.0, height_mm=2.0, grid_mm=0.5)
SOFT = Elastomer(friction=0.5)
BALL = Indenter()
SETTINGS = ContactSettings()
FORCE_TOLERANCE = 0.005
"""What a live press may differ by from one of its own, at another depth planned."""


def at(depth_mm: float, x_mm: float = 0.0, **rest: object) -> Press:
    """A press on the block."""
    path = Press(target_mm=(x_mm, 0.0, 2.0), depth_mm=depth_mm)
    return dataclasses.replace(path, **rest)  # pyright: ignore[reportArgumentType]


def case(press: Press) -> PressCase:
    """The ball, pressed like this."""
    return PressCase(indenter=BALL, press=press, settings=SETTINGS)


def fresh_N(press: Press) -> float:
    """Normal force of a press of one frame by itself [N]."""
    return float(alone(press).normal_N[-1])


def alone(press: Press) -> Contact:
    """A press of one frame, or two with shear."""
    return press_membrane(*BLOCK, SOFT, case(one_frame(press)))


def live_N(live: LiveContact, press: Press) -> float:
    """Normal force of a live frame [N]."""
    contact = live.press(*BLOCK, SOFT, case(press), key="block")
    assert len(contact.reaction_N) == len(contact.displacement_mm) == 1
    return float(contact.normal_N[0])


@pytest.mark.slow
def test_every_way_gives_the_force_of_a_fresh_press() -> None:
    """Deeper goes on, shallower keeps the region, aside begins anew: all within .5 % in force."""
    live = LiveContact()
    steps = [
        (at(0.6), Way.ANEW),
        (at(0.7), Way.GONE_ON),
        (at(0.8), Way.GONE_ON),
        (at(0.5), Way.SAME_REGION),
        (at(0.5, 1.5), Way.ANEW),
        (at(0.2, 1.5), Way.ANEW),
    ]
    for press, way in steps:
        force_N = live_N(live, press)
        assert live.way is way
        assert force_N == pytest.approx(fresh_N(press), rel=FORCE_TOLERANCE), press


@pytest.mark.slow
def test_shear_is_one_frame_after_the_approach() -> None:
    """The frame shown of a sheared press is its last; strokes are left out."""
    live = LiveContact()
    press = at(0.5, shear_mm=(0.3, 0.0), strokes=(slide(1.0, 0.0),))
    contact = live.press(*BLOCK, SOFT, case(press), key="block")
    fresh = alone(press)
    assert contact.reaction_N.shape == (1, 3)
    # The same problem from the same rest: nothing but the last bits may differ.
    np.testing.assert_allclose(contact.reaction_N[0], fresh.reaction_N[-1], rtol=1e-6)
    np.testing.assert_allclose(contact.indenter_pose[0], fresh.indenter_pose[-1])


@pytest.mark.slow
def test_a_live_frame_is_near_the_full_press() -> None:
    """Ten frames at mu .5, live at once and live by steps: one number, within .5 %."""
    full = press_membrane(*BLOCK, SOFT, case(at(0.6)))
    live = LiveContact()
    assert live_N(live, at(0.6)) == pytest.approx(full.normal_N[-1], rel=5e-3)
    dragged = LiveContact()
    stepped_N = [live_N(dragged, at(depth_mm)) for depth_mm in (0.4, 0.5, 0.6)]
    assert dragged.way is Way.GONE_ON
    assert stepped_N[-1] == pytest.approx(full.normal_N[-1], rel=5e-3)


@pytest.mark.slow
def test_a_stopped_request_leaves_nothing_to_go_on_from() -> None:
    """After a cancel in the middle the next request starts from rest and is right."""
    live = LiveContact()
    live_N(live, at(0.5))
    calls = 0

    def stop(fraction: float, note: str = "") -> None:
        nonlocal calls
        calls += 1
        if calls > 3:
            raise Cancelled("superseded")

    with pytest.raises(Cancelled):
        live.press(*BLOCK, SOFT, case(at(0.6)), key="block", monitor=stop)
    force_N = live_N(live, at(0.65))
    assert live.way is Way.SAME_REGION
    assert force_N == pytest.approx(fresh_N(at(0.65)), rel=FORCE_TOLERANCE)


@pytest.mark.slow
def test_another_key_begins_anew() -> None:
    """Another elastomer under another key does not meet the kept region."""
    live = LiveContact()
    soft_N = live_N(live, at(0.5))
    stiff = dataclasses.replace(SOFT, young_MPa=2.0 * SOFT.young_MPa)
    contact = live.press(*BLOCK, stiff, case(at(0.5)), key="stiff")
    assert live.way is Way.ANEW
    # Twice the energy at every strain is twice the force.
    assert contact.normal_N[0] == pytest.approx(2.0 * soft_N, rel=5e-3)
