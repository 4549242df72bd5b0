"""What stands on the page is in a designer's words, and fits its box; read in the generated index.

That the index is the page of today is held by `tests/test_generated_pages.py`.
"""

from __future__ import annotations

import enum
import re

import pytest

from tests.pages import page
from workbench.core.design.lighting import LightModel
from workbench.project.photos import shipped_photos
from workbench.view.choice_words import WORDS, words
from workbench.view.image_views import View
from workbench.view.picture_words import picture_words
from workbench.view.region_words import region_words

MOST_CHOICE = 45
"""Letters: a list is 235 px wide inside at 11.1 px, in the narrowest dock; an average is 4.9 px."""
MOST_LABEL, MOST_HINT = 36, 160
"""A button is 344 px wide inside, a hint wraps to three lines."""
INDEX = page("page-words").partition("## Texts")[0]
CONTROLS = re.findall(r"^- \*\*(.*?)\*\*: (.*)$", INDEX, re.MULTILINE)
CHOICES = [c for row in re.findall(r"^  - (.*)$", INDEX, re.M) for c in row.split("; ")]
ENUMS = (*WORDS, LightModel)


def bare(choice: enum.StrEnum) -> bool:
    """Whether its technical name is none that designers read."""
    return words(choice) != choice.value


def test_the_index_lists_the_whole_page() -> None:
    """Some 250 controls; with less the walk has missed pages."""
    assert len(CONTROLS) > 220
    assert len(CHOICES) > 150


def test_no_identifier_is_shown() -> None:
    """Underscores stand in the technical name at the end of a hint only."""
    texts = page("page-words").partition("## Texts")[2]
    shown = [label for label, _ in CONTROLS] + CHOICES + texts.splitlines()
    shown += [hint.partition(". In files: ")[0] for _, hint in CONTROLS]
    assert [text for text in shown if "_" in text] == []


def test_no_technical_name_is_a_choice() -> None:
    """Of the enumerations with words the words stand in the lists, not the values."""
    names = {str(m.value) for kind in ENUMS for m in kind if bare(m)}
    # The tactile image is a view of its own, besides the picture of a texture.
    assert names & set(CHOICES) == {View.IMAGE.value}


def test_every_string_fits_its_box() -> None:
    """Choices, labels and hints."""
    assert [c for c in CHOICES if len(c) > MOST_CHOICE] == []
    assert [label for label, _ in CONTROLS if len(label) > MOST_LABEL] == []
    assert [hint for _, hint in CONTROLS if len(hint) > MOST_HINT] == []


@pytest.mark.parametrize("kind", ENUMS, ids=lambda kind: kind.__name__)
def test_choices_have_words_of_their_own(kind: type[enum.StrEnum]) -> None:
    """No two of a list read alike; no member is without."""
    said = [words(member) for member in kind]
    assert len(set(said)) == len(said)
    if kind in WORDS:
        assert set(WORDS[kind]) == set(kind)


def test_shipped_photographs_and_regions_have_words() -> None:
    """No file name, and the first driven part is number 1."""
    assert not [name for name in shipped_photos() if picture_words(name) == name]
    assert region_words("actuator_0") == "driven part 1"
    assert region_words("base") == "base, held still"
