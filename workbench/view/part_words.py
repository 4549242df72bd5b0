"""What a maker calls the parts to print; their files keep the plain names of `FabricationPart`.

Known are the names that the mould and the housing give. Of any other name the underscores go.
"""

from __future__ import annotations

import re

KINDS: tuple[tuple[str, str], ...] = (
    (r"half_([a-d])", "mould half {}"),
    (r"part_([a-d])", "outer mould part {}"),
    (r"core", "mould core"),
    (r"housing_base", "base of the housing"),
    (r"led_ring_holder", "LED ring holder"),
    (r"slider_(\d+)", "actuator rod {}"),
)
"""Patterns of names, and their words, into which the letter or number of a part goes."""


def part_words(name: str) -> str:
    """The name of a part in words, as it stands in the middle of a sentence."""
    for pattern, words in KINDS:
        found = re.fullmatch(pattern, name)
        if found is not None:
            return words.format(*(mark.upper() for mark in found.groups()))
    return name.replace("_", " ")


def part_label(name: str) -> str:
    """The name of a part in words, as it stands alone."""
    words = part_words(name)
    return words[:1].upper() + words[1:]
