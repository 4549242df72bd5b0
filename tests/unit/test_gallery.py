"""Cards of the gallery say whole words."""

from __future__ import annotations

from ui.page.gallery import shortened


def test_a_line_is_cut_behind_a_word() -> None:
    """Of 16 letters "a soft membrane of" keeps "a soft membrane" and the sign of more."""
    assert shortened("a soft membrane of", 16) == "a soft membrane\N{HORIZONTAL ELLIPSIS}"


def test_no_line_is_longer_than_it_may_be() -> None:
    """For every length, also where one word alone is too long, and with the sign of more."""
    words = "silicone, three lights; oneverylongwordwithoutanend"
    for longest in range(2, len(words)):
        assert len(shortened(words, longest)) <= longest
    assert shortened(words, len(words)) == words


def test_no_comma_stands_before_the_sign_of_more() -> None:
    """What is cut ends with a letter."""
    assert shortened("silicone, three lights", 12) == "silicone\N{HORIZONTAL ELLIPSIS}"
