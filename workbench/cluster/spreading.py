"""Many things side by side: a thread for each under way, while the cluster does the work."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import TypeVar

from workbench.planning.plan import Runner

Thing = TypeVar("Thing")
Made = TypeVar("Made")


@dataclass(frozen=True, kw_only=True, slots=True)
class Spread:
    """Who runs calls for many things."""

    runner: Runner
    width: int
    """How many are under way at once."""
    stop: Callable[[], None] = lambda: None
    """Makes all that runs raise `Cancelled` soon."""


def spread(
    work: Callable[[Thing], Made], things: Iterable[Thing], on: Spread
) -> Iterator[tuple[Thing, Made]]:
    """Work on things, several at once, and yield each with what was made of it as it ends.

    One at a time needs no thread, and is stopped as any other work is.

    Raises:
        Exception: What `work` raised first; what runs is stopped then, and nothing more begins.
    """
    if on.width == 1:
        yield from ((thing, work(thing)) for thing in things)
        return
    waiting = iter(things)
    running: dict[Future[Made], Thing] = {}
    with ThreadPoolExecutor(max_workers=on.width) as pool:
        try:
            while True:
                while len(running) < on.width:
                    try:
                        thing = next(waiting)
                    except StopIteration:
                        break
                    running[pool.submit(work, thing)] = thing
                if not running:
                    return
                ended, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in ended:
                    yield running.pop(future), future.result()
        finally:
            if running:
                on.stop()
            for future in running:
                future.cancel()
