"""Parts have names that a maker reads, and no two the same."""

from __future__ import annotations

import pytest

from workbench.view.part_words import part_label, part_words

NAMES = (
    *("half_a", "half_b", "part_a", "part_b", "part_c", "part_d", "core"),
    *("support", "led_ring_holder", "camera_mount", "housing_base", "slider_1", "slider_2"),
)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("half_a", "mould half A"),
        ("part_c", "outer mould part C"),
        ("core", "mould core"),
        ("led_ring_holder", "LED ring holder"),
        ("slider_12", "actuator rod 12"),
        ("camera_mount", "camera mount"),
        ("half_of_it", "half of it"),
    ],
)
def test_parts_are_named_in_words(name: str, words: str) -> None:
    """The letter or number of a part is kept; a name that is not known loses its underscores."""
    assert part_words(name) == words


def test_labels_begin_with_a_capital_and_differ() -> None:
    """Each part of a mould and a housing has a label of its own; abbreviations stay."""
    labels = [part_label(name) for name in NAMES]
    assert len(set(labels)) == len(NAMES)
    assert all(label[0].isupper() and "_" not in label for label in labels)
    assert part_label("led_ring_holder") == "LED ring holder"
