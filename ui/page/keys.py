"""All commands and their keys, read from where they are registered, so that no list goes stale.

viser keeps the commands of its palette; the keyboard map and the check for keys given twice read
them there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

PALETTE = "Ctrl + K"
TASKS = (
    *("Start page", "Gallery", "Save design", "Undo", "Redo"),
    *("Run press", "Live press", "Render image", "Update results", "Cancel what runs"),
    *("Play or pause", "Previous frame", "Next frame", "Image"),
    *("Fit view", "Look from", "Section", "Measure distance", "End measuring"),
    *("Keyboard map", "Tour", "Help on"),
)
"""Beginnings of names in the order of the work: the design, the press, its frames, the view, help.
Commands of one beginning stand by their keys."""


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


def by_task(commands: list[Command]) -> list[Command]:
    """Commands in the order of the work; what belongs to no task comes last, by name."""

    def place(command: Command) -> tuple[int, str, str]:
        found = (k for k, start in enumerate(TASKS) if command.label.startswith(start))
        return next(found, len(TASKS)), command.keys, command.label

    return sorted(commands, key=place)


def keyboard_map(commands: list[Command]) -> str:
    """A table of all commands as Markdown, in two columns, each read downward."""
    cells = [f" {c.label} | {c.keys} " for c in by_task(commands)]
    cells.insert(0, f" Find a command | {PALETTE} ")
    half = (len(cells) + 1) // 2
    right = [*cells[half:], *([" | "] * (2 * half - len(cells)))]
    rows = [f"|{a}|{b}|" for a, b in zip(cells[:half], right, strict=True)]
    return "\n".join(["| Command | Key | Command | Key |", "|:--|:--|:--|:--|", *rows])
