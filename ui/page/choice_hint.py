"""Says in a drop-down's hint what its choice is called in files and on the command line."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def told_with_name(handle: Any, hint: str, names: Mapping[str, str]) -> None:
    """Let the hint follow the choice.

    Args:
        handle: Of the drop-down.
        hint: What it says of all choices.
        names: Technical names by what stands in the list; of those that it lacks none is told.
    """

    def tell(event: Any) -> None:
        name = names.get(handle.value, "")
        text = f"{hint}. In files: {name}" if name not in ("", handle.value) else hint
        if handle.hint != text:
            handle.hint = text

    handle.on_update(tell)
    tell(None)
