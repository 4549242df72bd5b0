"""The keyboard map follows the work and is half as high as there are commands."""

from __future__ import annotations

from ui.page.keys import Command, by_task, keyboard_map

COMMANDS = [
    Command(label=label, keys=keys)
    for label, keys in (
        ("Help on Shape", ""),
        ("Look from: Right", "2"),
        ("Another", "Z"),
        ("Look from: Front", "1"),
        ("Run press", "R"),
        ("Undo", "Ctrl + Z"),
    )
]


def test_commands_stand_by_task_not_as_they_were_registered() -> None:
    """Design, press, view, help; the views by their keys, and what is unknown comes last."""
    assert [command.label for command in by_task(COMMANDS)] == [
        *("Undo", "Run press", "Look from: Front", "Look from: Right"),
        *("Help on Shape", "Another"),
    ]


def test_two_columns_name_every_command_with_its_key() -> None:
    """Six commands and the palette's own make four rows under the two of the head."""
    text = keyboard_map(COMMANDS)
    assert len(text.splitlines()) == 2 + 4
    for command in COMMANDS:
        assert f"| {command.label} | {command.keys} |" in text
