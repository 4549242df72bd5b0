"""Text of others inside Markdown stays text."""

from __future__ import annotations

import html

import pytest

from ui.page.plain import plain
from ui.panels.shape.intake import _summary
from workbench.core.design.imported import ImportedBody, body_file

EVIL = "<iframe srcdoc=\"&lt;img onerror='x'\">[x](javascript:alert(1)) `a` **b** {c}\n# d"


@pytest.mark.parametrize("sign", list("<>\"'`*_[]{}~|$\\\n"))
def test_no_sign_of_markup_is_left(sign: str) -> None:
    """Every sign of HTML and Markdown is gone, and the page shows what was written."""
    shown = plain(EVIL + sign)
    assert sign not in shown
    assert html.unescape(shown) == " ".join((EVIL + sign).split())


def test_plain_words_stay_as_they_are() -> None:
    """Numbers, units, dots and umlauts need no entity."""
    words = "Wand 0.4 mm, 3 × 2 (von 5): größer"
    assert plain(words) == words


def test_the_names_of_body_files_are_written_plainly() -> None:
    """A file named like a frame or a link is neither."""
    file = body_file(f"{EVIL}.stl", b"solid")
    shown = _summary(ImportedBody(outer=file, inner=file))
    assert "<" not in shown and "[" not in shown and shown.count("iframe") == 2
