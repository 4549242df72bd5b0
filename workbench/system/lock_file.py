"""A file that names the process which holds a folder; one process at a time.

The file is made whole under another name and linked to its own, so that of two that want it one
gets it. A holder whose process has ended, by whatever end, is taken over from. Of a process on
another machine that cannot be seen; its lock stands until somebody takes it over on purpose.
"""

from __future__ import annotations

import contextlib
import json
import os
import secrets
import socket
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path

from workbench.system.processes import is_alive, started
from workbench.system.unfinished import fresh_name

LOCK = "lock"


@dataclass(frozen=True, kw_only=True, slots=True)
class Holder:
    """A process that holds a folder."""

    pid: int
    host: str
    started: str = ""
    """When the process began, as the system counts: tells a number that is used again."""
    since: str = ""
    """When it took the folder, for people."""
    link: str = ""
    """Where it can be reached."""
    mark: str = field(default_factory=lambda: secrets.token_hex(8))
    """Tells two holds of one process apart."""

    @property
    def elsewhere(self) -> bool:
        """Whether it runs on another machine."""
        return self.host != socket.gethostname()

    @property
    def living(self) -> bool:
        """Whether the process is there still, as far as can be seen from here."""
        if self.elsewhere:
            return True
        same = not self.started or started(self.pid) in ("", self.started)
        return is_alive(self.pid) and same


class LockFile:
    """The lock of one folder."""

    def __init__(self, folder: Path, *, name: str = LOCK, link: str = "") -> None:
        self.path = folder / name
        pid = os.getpid()
        self.own = Holder(
            pid=pid,
            host=socket.gethostname(),
            started=started(pid),
            since=time.strftime("%Y-%m-%d %H:%M"),
            link=link,
        )

    def take(self) -> Holder | None:
        """Take the folder; who holds it if another living process does, else None.

        Raises:
            OSError: If the folder cannot be written.
        """
        self.path.parent.mkdir(parents=True, exist_ok=True)
        while not self._linked():
            holder = self._clear_dead()
            if holder is not None:
                return holder
        return None

    def seize(self) -> None:
        """Take the folder from whoever holds it: that process sees it in `is_own`.

        Raises:
            OSError: If the folder cannot be written.
        """
        self.path.parent.mkdir(parents=True, exist_ok=True)
        self._written().replace(self.path)

    @property
    def is_own(self) -> bool:
        """Whether this lock holds the folder."""
        return self.holder() == self.own

    def holder(self) -> Holder | None:
        """Who holds the folder, living or not; None where nobody does or the file is damaged."""
        return _read(self.path)

    def release(self) -> None:
        """Give the folder back, if it is held."""
        with contextlib.suppress(OSError):
            if self.is_own:
                self.path.unlink()

    def _written(self) -> Path:
        part = self.path.with_name(fresh_name())
        part.write_text(json.dumps(asdict(self.own)), encoding="utf-8")
        return part

    def _linked(self) -> bool:
        part = self._written()
        try:
            os.link(part, self.path)
        except FileExistsError:
            return False
        finally:
            part.unlink()
        return True

    def _clear_dead(self) -> Holder | None:
        """Remove the lock of a process that has ended; a living one's stays, and is returned."""
        aside = self.path.with_name(fresh_name())
        with contextlib.suppress(FileNotFoundError):
            holder = _read(self.path)
            if holder is not None and holder.living:
                return holder
            self.path.rename(aside)
            # Between reading and renaming, somebody else may have taken over the dead lock.
            holder = _read(aside)
            if holder is not None and holder.living:
                aside.rename(self.path)
                return holder
            aside.unlink()
        return None


def _read(path: Path) -> Holder | None:
    try:
        table = json.loads(path.read_bytes())
        known = {name: table[name] for name in Holder.__dataclass_fields__ if name in table}
        return Holder(**{**known, "pid": int(table["pid"]), "host": str(table["host"])})
    except (OSError, ValueError, KeyError, TypeError):
        return None
