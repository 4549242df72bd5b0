"""What designers read for the regions of a body; files keep the names of `region_masks`."""

from __future__ import annotations

import re

DRIVEN = re.compile(r"actuator_(\d+)")
WORDS = {"base": "base, held still"}


def region_words(name: str) -> str:
    """A region in words: driven parts are counted from 1, in files from 0."""
    found = DRIVEN.fullmatch(name)
    if found is not None:
        return f"driven part {int(found.group(1)) + 1}"
    return WORDS.get(name, name.replace("_", " "))
