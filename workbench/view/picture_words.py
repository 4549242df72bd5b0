"""What designers read for the photographs that ship; pictures of their own keep their names."""

from __future__ import annotations

WORDS = {
    "geltip_idle_640x480.png": "photo of a GelTip",
    "elephant_bkg_640_480_real.png": "photo of a trunk",
    "elephant_bkg_640_480_1_real.png": "second photo of a trunk",
}
"""By file; what each shows stands in `designs/backgrounds/NOTICE.md`."""


def picture_words(name: str) -> str:
    """A picture in words."""
    return WORDS.get(name, name)
