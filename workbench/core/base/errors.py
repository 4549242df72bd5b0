"""Errors raised on purpose: each says what is wrong (value, limit, unit), what to do, and where.

`at` names the field, for example `layers.elastomer_mm`, so that the browser can show the message
beside the widget and the command line can print it.
"""

from __future__ import annotations

import re
from typing import Any, TypedDict, Unpack

LONGEST_ECHO = 80
"""Characters of a value that a message repeats: a file may hold 100 KB where a number is due."""
LONGEST_WORD = 300
"""Words of a message that are longer are cut: longer than the paths that people have."""
HEAD, TAIL = 50, 27


def shown(value: object) -> str:
    """A value as Python writes it, for a message; of a long one 80 characters of both ends.

    The end stays because it is what tells one path from another.
    """
    return shortened(repr(value))


def shortened(text: str) -> str:
    """A text of at most 80 characters: a longer one loses its middle."""
    return text if len(text) <= LONGEST_ECHO else f"{text[:HEAD]}...{text[-TAIL:]}"


def _without_endless_words(text: str) -> str:
    """A text whose words are no longer than a path that the system takes: a name may be a file."""
    return re.sub(rf"\S{{{LONGEST_WORD},}}", lambda word: shortened(word[0]), text)


class Advice(TypedDict, total=False):
    """What an error says besides its message."""

    hint: str
    """What to do."""
    at: str
    """The field that it is about."""


class WorkbenchError(Exception):
    """Base of every error we raise on purpose."""

    exit_code = 3
    """Process exit status of the command line: 2 bad input, 3 failed computation or device."""

    def __init__(self, message: str, *, hint: str = "", at: str = "") -> None:
        super().__init__(message)
        self.message = _without_endless_words(message)
        self.hint = _without_endless_words(hint)
        self.at = shortened(at)

    def __reduce__(self) -> tuple[Any, ...]:
        # Exceptions with keyword fields lose them across a process boundary unless told how.
        return _rebuild, (type(self), self.message, self.hint, self.at, dict(vars(self)))

    def as_dict(self) -> dict[str, str]:
        """The error as the command line prints it with `--json`."""
        return {
            "error": type(self).__name__,
            "message": self.message,
            "hint": self.hint,
            "at": self.at,
        }


def _rebuild(
    cls: type[WorkbenchError], message: str, hint: str, at: str, state: dict[str, Any]
) -> WorkbenchError:
    error = cls(message, hint=hint, at=at)
    vars(error).update(state)
    return error


class DesignError(WorkbenchError):
    """A value the designer chose is outside what can be built or simulated."""

    exit_code = 2
    repair: Any = None
    """What a repair would do, a `core.design.imported.RepairOffer`, where one is on offer."""


class GeometryError(WorkbenchError):
    """The CAD kernel did not return the body that was asked for."""


class MeshingError(WorkbenchError):
    """No usable mesh came out of a valid body."""


class OpticsError(WorkbenchError):
    """An image cannot be formed."""


class SolveError(WorkbenchError):
    """The contact solver did not reach equilibrium.

    Attributes:
        frame: Frame that failed, counted from 0.
        residual: Relative residual that was reached.
        last_good: Last frame that settled, -1 when none did.
        partial: The result of the frames that settled, until a store has taken it, else None.
        kept: Key under which a store keeps those frames, or "".
    """

    def __init__(
        self,
        message: str,
        *,
        frame: int = -1,
        residual: float = float("nan"),
        last_good: int = -1,
        partial: Any = None,
        **advice: Unpack[Advice],
    ) -> None:
        super().__init__(message, **advice)
        self.frame = frame
        self.residual = residual
        self.last_good = last_good
        self.partial = partial
        self.kept = ""


class DeviceError(WorkbenchError):
    """A compute device is missing or ran out of memory."""


class StoreError(WorkbenchError):
    """A result could not be written or read (disk full, read-only, damaged)."""


class DamagedError(StoreError):
    """A stored result cannot be read; it has been set aside, so that it is computed again.

    `at` is its stage.
    """


class LaneError(WorkbenchError):
    """A worker process ended while it was computing."""


class Cancelled(WorkbenchError):
    """The user asked to stop."""

    exit_code = 130


class Stopped(Cancelled):
    """The user stopped a press of which frames had settled.

    Attributes:
        partial: The result of those frames, until a store has taken it, else None.
        kept: Key under which a store keeps them, or "".
    """

    def __init__(self, message: str, *, hint: str = "", at: str = "", partial: Any = None) -> None:
        super().__init__(message, hint=hint, at=at)
        self.partial = partial
        self.kept = ""
