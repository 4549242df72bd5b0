"""Which of several servers writes a project: one; the others show it until they take it over.

Two servers would write the same autosave over each other. The first holds the lock of the project
folder; one that comes later tells its tabs where the project is open, lets none of them edit, and
writes nothing. *Take over* takes the lock from the holder, which sees that at its next turn, writes
no more, and shows the project in its turn. The lock of a server that has ended is free.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable
from pathlib import Path

from ui.desk.session import Session
from ui.page.colours import AMBER
from ui.page.editor import Editor
from ui.page.plain import plain
from workbench.core.base.errors import StoreError
from workbench.system.lock_file import Holder, LockFile

LOCK = "server.lock"
LOOK_S = 1.0
"""Time between two looks at the lock [s]."""


class Tenancy:
    """This server's hold of its project."""

    def __init__(self, folder: Path, session: Session, *, link: str) -> None:
        self.lock = LockFile(folder, name=LOCK, link=link)
        self.session = session
        self.on_entered: Callable[[], None] = lambda: None
        """Called when this server begins to write the project again, with its state read anew."""
        self._editor: Editor | None = None
        self._looked = 0.0
        self._told = ""
        # A lock that nobody holds, because its file is gone or unreadable, forbids nothing: a write
        # that fails is told, one that is left out is not.
        session.may_write = lambda: self.lock.holder() in (None, self.lock.own)

    def enter(self) -> Holder | None:
        """Take the project, or learn which server has it.

        Raises:
            StoreError: If the folder cannot be written.
        """
        try:
            return self.lock.take()
        except OSError as error:
            raise self._unwritable(error) from error

    def follow(self, editor: Editor, holder: Holder | None) -> None:
        """Let tabs edit only while this server has the project, from now on."""
        self._editor = editor
        if holder is not None:
            self._shut(holder)

    def turn(self) -> None:
        """See whether another server has taken the project; called by the pump."""
        now = time.monotonic()
        if self._editor is None or now - self._looked < LOOK_S:
            return
        self._looked = now
        holder = self.lock.holder()
        if holder == self.lock.own:
            return
        if self._editor.is_shut:
            self._shut(holder)
        elif holder is None or not holder.living:
            # Somebody deleted the file, or took over and died: nobody writes but this server.
            with contextlib.suppress(StoreError):
                # A folder that cannot be written is told by whoever writes the design.
                self.enter()
        else:
            self._shut(holder)

    def leave(self) -> None:
        """Give the project back."""
        self.lock.release()

    def _shut(self, holder: Holder | None) -> None:
        """Let no tab edit; what all read is renewed where the holder has changed or ended."""
        assert self._editor is not None
        words = _words(holder)
        if words != self._told:
            self._told = words
            self._editor.shut(words, self._seize)

    def _seize(self) -> None:
        """Take the project over, as it stands on disk: the other server may have edited it."""
        try:
            self.lock.seize()
        except OSError as error:
            raise self._unwritable(error) from error
        self._told = ""
        self.session.open(None)
        self.on_entered()

    def _unwritable(self, error: OSError) -> StoreError:
        return StoreError(
            f"cannot write to {self.lock.path.parent}: {error.strerror or error}",
            hint="check the folder's permissions, or choose another one with --project",
            at="project",
        )


def _words(holder: Holder | None) -> str:
    if holder is None or not holder.living:
        words = "**Only shown here:** the workbench that had this project has ended."
        return f"<span style='color:{AMBER}'>{words}</span>"
    where = f" on {holder.host}" if holder.elsewhere else ""
    words = f"process {holder.pid}{where}, since {holder.since}"
    link = f" [Open it there]({holder.link})." if holder.link.startswith("http") else ""
    return (
        f"<span style='color:{AMBER}'>**Only shown here:** another workbench has this project "
        f"({plain(words)}).</span>{link}"
    )
