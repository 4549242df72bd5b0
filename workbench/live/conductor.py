"""Runs the pipeline behind the browser: one thread per topic, newest request wins.

A topic is what the designer waits for: `shape` (the body that follows the sliders), `press`,
`image`, `maps`, `mesh`, `tetrahedra`, `parts`, `import`, `object`, and what follows the hand:
those that `requests` names.
Widget callbacks call `submit` and return; the browser's pump reads `events`. Nothing here touches
a widget, and nothing heavy runs in these threads: they wait for the lanes.
"""

from __future__ import annotations

import contextlib
import queue
import threading
from collections.abc import Sequence

from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.live.live_press import live_call, live_design
from workbench.live.preview_call import PreviewCall
from workbench.live.request_thread import Runner, Topic
from workbench.live.requests import LIVE, Event, Request
from workbench.pipeline.store import Store


class Conductor:
    """Keeps one thread per topic and the lanes they share."""

    def __init__(self, store: Store, runner: Runner) -> None:
        self.store = store
        self.events: queue.Queue[Event] = queue.Queue()
        self.runner = runner
        self._topics: dict[str, Topic] = {}
        self._guard = threading.Lock()

    def submit(
        self, topic: str, design: SensorDesign, case: PressCase, wanted: Sequence[str]
    ) -> Request:
        """Ask for stages; a request of the same topic that has not begun is replaced.

        One that runs is stopped, except in topics that follow the hand: it is done before a person
        could wait for it, and a slider that moves on would otherwise never see a body.
        """
        return self._submit(topic, Request(design=design, case=case, wanted=tuple(wanted)))

    def press_live(self, design: SensorDesign, case: PressCase) -> None:
        """Ask for a live press; the one that runs is stopped, and none ever waits in line."""
        self.ask(LIVE, live_design(design), case, live_call(design, case))

    def ask(self, topic: str, design: SensorDesign, case: PressCase, call: PreviewCall) -> Request:
        """Ask for a preview and what it needs; a request of the same topic is replaced."""
        request = Request(design=design, case=case, wanted=call.needs, preview=call)
        return self._submit(topic, request)

    def stop_live(self) -> None:
        """Stop the live press that runs, if any."""
        self.stop(LIVE)

    def stop(self, topic: str) -> None:
        """Stop what one topic computes, and forget what waits in it."""
        with self._guard:
            if topic in self._topics:
                self._topics[topic].cancel()

    def cancels(self, topic: str) -> int:
        """How often a topic was told to stop; who asks for one thing after another compares it."""
        with self._guard:
            return self._topics[topic].cancels if topic in self._topics else 0

    def _submit(self, topic: str, request: Request) -> Request:
        with self._guard:
            if topic not in self._topics:
                self._topics[topic] = Topic(topic, self.runner, self.events)
            self._topics[topic].submit(request)
        return request

    def wait(self, seconds: float) -> list[Event]:
        """All events that have come, after at most that time without any [s]."""
        found: list[Event] = []
        with contextlib.suppress(queue.Empty):
            found.append(self.events.get(timeout=seconds))
            while True:
                found.append(self.events.get_nowait())
        return found

    def cancel(self, *, following: bool = False) -> None:
        """Stop what runs and forget what waits; what follows the hand only when it takes long."""
        with self._guard:
            for topic in self._topics.values():
                if following or not topic.spared:
                    topic.cancel()

    def works_on(self, topic: str) -> bool:
        """Whether a request of this topic runs or waits."""
        with self._guard:
            return topic in self._topics and self._topics[topic].busy

    def give_up(self, *topics: str) -> None:
        """Nobody waits for these any more: what waits is forgotten, what takes long is stopped."""
        with self._guard:
            for name in topics:
                if name in self._topics:
                    self._topics[name].give_up()

    @property
    def busy(self) -> bool:
        """Whether anything runs or waits."""
        with self._guard:
            return any(topic.busy for topic in self._topics.values())

    def close(self) -> None:
        """Stop everything and end the worker processes."""
        self.cancel(following=True)
        self.runner.close()
