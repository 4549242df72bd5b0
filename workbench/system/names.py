"""What a designer's things may be called, and the next free name.

A name is that of a file: it must be one on every system, and none of the program's own.
"""

from __future__ import annotations

from collections.abc import Collection

NONE = "-"
"""Stands for none in the lists of the front: nothing may be called so."""
AUTOSAVE = "autosave"
"""The design as it stands, which a restart brings back."""
LONGEST = 80
LONGEST_BYTES = 240
"""Of a file's name; a file system takes 255, and some go to its ending."""
LONGEST_STEM = 70
"""Of a name that gets a number."""


def is_name(name: str) -> bool:
    """Whether every file system takes a name, and no other file has it."""
    if not name or name != name.strip() or name[0] == "." or not name.isprintable():
        return False
    if len(name) > LONGEST or len(name.encode()) > LONGEST_BYTES or name == NONE:
        return False
    # Some disks do not tell capital letters from small ones.
    own = name.lower() == AUTOSAVE and name != AUTOSAVE
    return not own and not any(letter in name for letter in '/\\:*?"<>|')


def numbered(name: str, taken: Collection[str], *, first: int = 2) -> str:
    """The first free name like this one: `finger 2` after `finger`, `finger 3` after `finger 2`.

    Args:
        name: A name, with or without a number.
        taken: Names that are not free.
        first: The lowest number.
    """
    stem, _, last = name.rpartition(" ")
    stem = (stem if stem and last.isdigit() else name)[:LONGEST_STEM].rstrip()
    number = first
    while f"{stem} {number}" in taken:
        number += 1
    return f"{stem} {number}"
