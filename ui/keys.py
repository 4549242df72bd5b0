"""All commands and their keys, read from where they are registered, so that no list goes stale.

viser keeps the commands of its palette; the keyboard map and the check for keys given twice read
them there.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any

PALETTE = "Ctrl + K"


@dataclass(frozen=True, kw_only=True, slots=True)
class Command:
    """An entry of the palette."""

    label: str
    keys: str
    """For people, for example `Ctrl + Shift + Z`; "" without a key."""


def registered(gui: Any) -> list[Command]:
    """All commands, in the order in which they were registered."""
    handles = list(gui._command_handle_from_uuid.values())
    return [
        Command(label=handle.label, keys=in_words(handle.hotkey, handle.modifier))
        for handle in handles
    ]


def in_words(hotkey: str | None, modifier: str | None) -> str:
    """A key with what is held, as it stands on a keyboard."""
    if hotkey is None:
        return ""
    parts = [*(modifier or "").split("+"), hotkey]
    names = {"cmd/ctrl": "Ctrl", "escape": "Esc"}
    return " + ".join(names.get(part, part.capitalize()) for part in parts if part)


def clashes(commands: list[Command]) -> list[str]:
    """Keys and names that more than one command has."""
    keys = Counter(command.keys for command in commands if command.keys)
    labels = Counter(command.label for command in commands)
    return [name for name, count in (keys + labels).items() if count > 1]


def keyboard_map(commands: list[Command]) -> str:
    """A table of all commands as Markdown, those with a key first."""
    ordered = sorted(commands, key=lambda command: (not command.keys, command.label))
    rows = [f"| {command.label} | {command.keys} |" for command in ordered]
    head = ["| Command | Key |", "|:--|:--|", f"| Find a command | {PALETTE} |"]
    return "\n".join([*head, *rows])
