"""What a live press asks for, and when: a desk that only notes it, and a clock that is set."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ui.desk import live_press as module
from ui.desk.live_press import READY_S, SETTLE_S, LivePressFollower
from workbench.live.requests import COMPLIANCE, LIVE, TOUCH


class Conductor:
    """Notes what is asked for; nothing runs unless a test says so."""

    def __init__(self) -> None:
        self.asked: list[str] = []
        self.works: set[str] = set()
        self.stops = 0

    @property
    def busy(self) -> bool:
        return bool(self.works)

    def press_live(self, design: Any, case: Any) -> None:
        self.asked.append(LIVE)

    def ask(self, job: str, design: Any, case: Any, call: Any) -> None:
        self.asked.append(job)

    def stop_live(self) -> None:
        """The press that runs hears of it between its steps: for a while it is on its way out."""

    def stop(self, job: str) -> None:
        self.works.discard(job)
        self.stops += 1

    def give_up(self, *jobs: str) -> None:
        self.works -= set(jobs)

    def cancels(self, job: str) -> int:
        return self.stops

    def works_on(self, job: str) -> bool:
        return job in self.works


class Bench:
    """A follower with a desk around it; `case` is what the designer's hand holds."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now_s = 0.0
        self.known = True
        self.nodes_there = True
        self.conductor = Conductor()
        self.said = ""
        self.shown: list[str] = []
        monkeypatch.setattr(
            module,
            "Gizmo",
            lambda *given, **named: SimpleNamespace(place=lambda pose: None, show=lambda on: None),
        )
        monkeypatch.setattr(module, "live_call", lambda design, case: ("settled", case))
        monkeypatch.setattr(module, "live_design", lambda design: design)
        monkeypatch.setattr(module, "touch_call", self._touch)
        session = SimpleNamespace(
            design="design",
            case=0,
            store=SimpleNamespace(has=lambda stage, key: self.nodes_there),
            result=lambda stage: SimpleNamespace(outer=None),
        )
        self.session = session
        scene = SimpleNamespace(
            api=None,
            object=SimpleNamespace(standing=np.zeros(7)),
            show_live=lambda skin, contact: None,
            clear_frames=lambda: None,
        )
        self.desk: Any = SimpleNamespace(
            scene=scene,
            editor=SimpleNamespace(edits=None),
            gizmos=[],
            on_turn=[],
            jobs=SimpleNamespace(on_preview={}, running={}, submit=self._submit),
            conductor=self.conductor,
            session=session,
            shown_results=SimpleNamespace(forget=lambda *names: None),
            changed=lambda: None,
            live=False,
            live_said=self._say,
            tell=lambda what, preview: self.shown.append(preview.words),
        )
        self.follower = LivePressFollower(self.desk, clock=lambda: self.now_s)
        self.follower.switch(True)

    def _touch(self, design: Any, case: Any) -> Any:
        if not self.known:
            return None
        return SimpleNamespace(skin="skin", nodes=SimpleNamespace(stage="s", key="k"))

    def _submit(self, job: str, *given: Any, **named: Any) -> None:
        self.conductor.asked.append(job)
        self.conductor.works.add(job)

    def _say(self, words: str) -> None:
        self.said = words

    def move(self) -> None:
        """The hand goes on."""
        self.session.case += 1
        self.follower.follow()

    def answer(self, job: str, case: int | None = None) -> None:
        """A lane answers."""
        contact = SimpleNamespace(normal_N=np.array([1.25]))
        case = self.session.case if case is None else case
        preview: Any = SimpleNamespace(contact=contact, words=f"{job} {case}")
        self.desk.jobs.on_preview[job](preview, SimpleNamespace(design="design", case=case))

    def after(self, seconds: float) -> None:
        """Time passes, and the pump turns."""
        self.now_s += seconds
        self.follower.turn()

    def asked(self) -> list[str]:
        """What was asked for since the last time."""
        found, self.conductor.asked = self.conductor.asked, []
        return found


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Bench:
    return Bench(monkeypatch)


def test_fast_contact_follows_and_what_rests_is_settled(bench: Bench) -> None:
    """Three moves are three touches; the solver is asked once, when the last has rested."""
    bench.asked()
    for _ in range(3):
        bench.move()
        bench.answer(TOUCH)
        bench.after(0.5 * SETTLE_S)
    assert bench.asked() == [TOUCH, TOUCH, TOUCH]
    bench.after(SETTLE_S)
    assert bench.asked() == [LIVE]
    bench.answer(LIVE)
    bench.after(0.1)
    assert bench.asked() == []
    assert bench.said.startswith("**1.250 N**")


def test_what_rests_is_settled_although_the_press_before_is_still_being_stopped(
    bench: Bench,
) -> None:
    """The hand goes on while a press is settled, and is followed before that has stopped; so too
    where fast contact refuses."""
    bench.move()
    bench.answer(TOUCH)
    bench.after(SETTLE_S)
    bench.conductor.works.add(LIVE)
    bench.asked()
    bench.move()
    bench.answer(TOUCH)
    bench.after(SETTLE_S)
    assert bench.asked() == [TOUCH, LIVE]
    bench.move()
    bench.follower.touch_failed()
    assert bench.asked() == [TOUCH, LIVE]


def test_the_solver_is_asked_once_for_a_press(bench: Bench) -> None:
    """Asked beside the nodes, it is not asked again for a touch that comes before its answer, and
    not for one that comes after the press was refused."""
    bench.nodes_there = False
    bench.move()
    bench.asked()
    bench.answer(TOUCH)
    bench.after(SETTLE_S)
    bench.follower.failed()
    bench.answer(TOUCH)
    bench.after(SETTLE_S)
    assert bench.asked() == []


def test_what_has_settled_is_not_covered_by_a_later_touch(bench: Bench) -> None:
    """A touch that comes after the settled frame of the same press, or a settled frame after the
    hand moved on, is not shown."""
    bench.move()
    bench.answer(LIVE)
    bench.answer(TOUCH)
    bench.move()
    bench.answer(LIVE, case=bench.session.case - 1)
    assert bench.shown == ["live 1"]


def test_a_press_that_fast_contact_does_not_know_is_settled_at_each_move(bench: Bench) -> None:
    """Soft objects are not asked for at all; a refusal counts for its skin."""
    bench.known = False
    bench.asked()
    bench.move()
    assert bench.asked() == [LIVE]
    bench.known = True
    bench.move()
    bench.follower.touch_failed()
    bench.move()
    assert bench.asked() == [TOUCH, LIVE, LIVE]


def test_the_first_time_the_solver_is_asked_beside_the_nodes(bench: Bench) -> None:
    """Until the nodes are there nobody waits for them alone."""
    bench.asked()
    bench.nodes_there = False
    bench.move()
    assert bench.asked() == [LIVE, TOUCH]


def test_the_skin_is_made_ready_in_the_quiet_and_not_against_a_persons_will(bench: Bench) -> None:
    """It begins once nothing runs, stops at a move, goes on later; a person's cancel holds."""
    bench.move()
    bench.answer(LIVE)
    bench.asked()
    bench.after(READY_S + 0.1)
    assert bench.asked() == [COMPLIANCE]
    bench.desk.jobs.running[COMPLIANCE] = SimpleNamespace(fraction=0.25)
    bench.after(0.1)
    assert bench.said.endswith("; skin 25% ready for quick touches")
    del bench.desk.jobs.running[COMPLIANCE]
    bench.move()
    assert not bench.conductor.works_on(COMPLIANCE)
    bench.answer(LIVE)
    bench.after(READY_S + 0.1)
    assert bench.asked() == [TOUCH, COMPLIANCE]
    bench.conductor.stop(COMPLIANCE)
    bench.move()
    bench.answer(LIVE)
    bench.after(READY_S + 0.1)
    assert bench.asked() == [TOUCH]
