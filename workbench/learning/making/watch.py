"""How far a data set is: counts samples while it is made, and keeps what ended cases say."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from workbench.learning.dataset.cases import Case
from workbench.learning.dataset.folder import FAILED, TIMES, DataSet
from workbench.learning.dataset.json_lines import append_row
from workbench.learning.making.worker_messages import Report


@dataclass(frozen=True, kw_only=True, slots=True)
class SetProgress:
    """How far a data set is."""

    done: int
    """Samples that there are."""
    total: int
    """Samples that are asked for and can still come: those of failed cases are left out."""
    failed: int
    """Cases that failed."""
    eta_s: float | None
    """Time that remains at the pace of this run [s]; None while nothing is done in it."""


Tell = Callable[[SetProgress], None]


class Watch:
    """Counts samples, and keeps what ended cases say."""

    def __init__(
        self,
        data: DataSet,
        cases: Sequence[Case],
        done: dict[str, int],
        failed: int,
        tell: Tell,
    ) -> None:
        self._data = data
        self._cases = {case.id: case for case in cases}
        self._done = done
        self._failed = failed
        self._tell = tell
        self._first = sum(done.values())
        self._total = sum(case.frames for case in cases)
        self._begun_s = time.monotonic()

    def ended(self, case: Case, report: Report) -> None:
        """Keep how a case ended."""
        self._done[case.id] = len(self._data.frames(case))
        if report.error:
            self._failed += 1
            self._total -= case.frames - self._done[case.id]
            append_row(self._data.folder / FAILED, {"id": case.id, **report.error})
        elif report.written == case.frames:
            # A case that was begun before and ended now would have too few images in its time.
            own = dataclasses.asdict(report)
            del own["error"], own["written"]
            append_row(self._data.folder / TIMES, {**own, "frames": case.frames})

    def look(self, running: Iterable[Case]) -> None:
        """Count the samples of running cases and tell."""
        for case in running:
            self._done[case.id] = len(self._data.frames(case))
        done = sum(self._done.values())
        new, spent_s = done - self._first, time.monotonic() - self._begun_s
        eta_s = (self._total - done) * spent_s / new if new else None
        self._tell(SetProgress(done=done, total=self._total, failed=self._failed, eta_s=eta_s))
