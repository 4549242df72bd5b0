"""The journal of a search, `study.jsonl`: opened by several processes, mended after a kill.

It is Optuna's own (`JournalStorage` on a file), so that its dashboard opens it. What a process
killed in the middle of a line left is cut off, since no line after it could be read; the trial that
it was at is noted as failed, once it is known to be gone.
"""

from __future__ import annotations

import contextlib
import os
import socket
import sys
import warnings
from collections.abc import Generator, Sequence
from pathlib import Path
from typing import Any, Literal

from workbench.core.base.digest import digest
from workbench.core.base.errors import DesignError, StoreError
from workbench.search.judged import Judged, from_journal
from workbench.search.problem import Problem, Want
from workbench.system.lock_file import Holder
from workbench.system.processes import started

NAME = "search"
FILE = "study.jsonl"
JUDGED, BY, SAMPLER = "judged", "by", "sampler"
"""Attributes of a trial: what came of it, whose it is, who proposed it."""
BASE, OF = "base", "problem"
"""Attributes of the study: the base's figures, and the digest of the problem."""


def open_study(problem: Problem, path: Path) -> Any:
    """The study of a problem in a journal, made where there is none; an `optuna.Study`.

    Raises:
        DesignError: If the journal is that of another problem.
        StoreError: If the file cannot be read as one.
    """
    import optuna
    from optuna.storages import JournalStorage
    from optuna.storages.journal import JournalFileBackend

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    path.parent.mkdir(parents=True, exist_ok=True)
    _mend(path)
    try:
        storage = JournalStorage(JournalFileBackend(str(path), _lock(path)))
        study = optuna.create_study(
            study_name=NAME,
            storage=storage,
            directions=[_direction(goal.want) for goal in problem.goals],
            load_if_exists=True,
        )
        with warnings.catch_warnings():
            # Its dashboard names the axes by it; that this is new is no news to the designer.
            warnings.simplefilter("ignore")
            if study.metric_names is None:
                study.set_metric_names([goal.figure for goal in problem.goals])
    except (ValueError, KeyError, OSError) as error:
        raise StoreError(
            f"{path} cannot be read: {error}", hint="remove it, or name another --out", at=str(path)
        ) from error
    _expect_same(study, problem, path)
    fail_dead(study)
    return study


def _direction(want: Want) -> Literal["minimize", "maximize"]:
    return "maximize" if want is Want.MAX else "minimize"


def _expect_same(study: Any, problem: Problem, path: Path) -> None:
    now = problem_digest(problem)
    before = study.user_attrs.get(OF)
    if before is None:
        study.set_user_attr(OF, now)
    elif before != now:
        raise DesignError(
            f"{path} belongs to another search: its base, fields, goals or limits differ",
            hint="name another --out, or remove the folder",
            at="--out",
        )


def problem_digest(problem: Problem) -> str:
    """What the trials of two problems must share to stand in one journal."""
    same = (problem.base, problem.vary, problem.goals, problem.limits, problem.links)
    return digest((*same, problem.draft, problem.even_light, problem.prices))


def own_mark() -> dict[str, Any]:
    """Which process a trial belongs to."""
    pid = os.getpid()
    return {"pid": pid, "host": socket.gethostname(), "started": started(pid)}


def fail_dead(study: Any) -> list[int]:
    """Note trials of processes that are gone as failed; returns their numbers.

    One without a mark is none of ours.
    """
    gone = []
    for trial in _running(study):
        mark = trial.user_attrs.get(BY)
        if mark is None or not Holder(**mark).living:
            # Another process may have noted it first.
            with contextlib.suppress(ValueError, RuntimeError):
                study.tell(trial.number, state=_states().FAIL)
                gone.append(trial.number)
    return gone


def _states() -> Any:
    from optuna.trial import TrialState

    return TrialState


def _running(study: Any) -> Sequence[Any]:
    return study.get_trials(deepcopy=False, states=(_states().RUNNING,))


def ended_trials(study: Any) -> list[tuple[Any, Judged]]:
    """Trials that have ended, each with what came of it, in their order."""
    trials: Sequence[Any] = study.get_trials(deepcopy=False, states=(_states().COMPLETE,))
    return [(t, from_journal(t.user_attrs[JUDGED])) for t in trials if JUDGED in t.user_attrs]


def running_count(study: Any) -> int:
    """Trials that some living process is at."""
    marks = [trial.user_attrs.get(BY) for trial in _running(study)]
    return sum(mark is not None and Holder(**mark).living for mark in marks)


def _mend(path: Path) -> None:
    """Cut off what a killed writer left of a line; no other writes meanwhile."""
    if not path.exists() or not _torn(path):
        return
    with _locked(path):
        content = path.read_bytes()
        if content and not content.endswith(b"\n"):
            with path.open("r+b") as file:
                file.truncate(content.rfind(b"\n") + 1)


def _torn(path: Path) -> bool:
    with path.open("rb") as file:
        size = file.seek(0, os.SEEK_END)
        if not size:
            return False
        file.seek(size - 1)
        return file.read(1) != b"\n"


def _lock(path: Path) -> Any:
    """Optuna's own lock of the file, which takes over from a writer that was killed.

    By a symbolic link, which works on shared folders, but on Windows asks for a right of its own.
    """
    from optuna.storages.journal import JournalFileOpenLock, JournalFileSymlinkLock

    kind = JournalFileOpenLock if sys.platform == "win32" else JournalFileSymlinkLock
    return kind(str(path))


@contextlib.contextmanager
def _locked(path: Path) -> Generator[None]:
    """The file for one writer."""
    lock = _lock(path)
    lock.acquire()
    try:
        yield
    finally:
        lock.release()
