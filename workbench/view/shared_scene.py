"""The saved 3D scene as a page: its title and the name of its file. Drawing is the front's."""

from __future__ import annotations

import html
import re

TITLE = re.compile(r"<title>.*?</title>", re.DOTALL)
LONGEST = 60
"""Letters of a design's name that a file name keeps."""


def titled(page: str, name: str) -> str:
    """A page of viser that says which design it shows, in its title and above the scene.

    Args:
        page: The page as viser writes it.
        name: Name of the design, as the designer typed it.
    """
    safe = html.escape(name)
    caption = (
        "<div style='position:fixed;left:12px;top:10px;z-index:9;color:#ddd;pointer-events:none;"
        f"font:15px sans-serif'>{safe}</div>"
    )
    head = page.index("</head>")
    # The scene's data stand in the head too: only what comes before them is searched.
    start = page[: min(head, 4000)]
    begin = TITLE.sub("", start) + page[len(start) : head]
    rest = page[head:].replace("</body>", caption + "</body>", 1)
    return f"{begin}<title>{safe}</title>{rest}"


def file_name(name: str) -> str:
    """A file name for the scene of a design, safe on every system."""
    plain = re.sub(r"[^A-Za-z0-9_-]+", "_", name).strip("_")[:LONGEST]
    return f"{plain or 'design'}_scene.html"
