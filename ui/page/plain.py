"""Text that is not our own inside Markdown: shown as it was written, whatever it holds.

viser does not sanitise Markdown, which may hold HTML and links with scripts. Signs of both become
entities: unlike a backslash, those are read as text inside HTML, too.
"""

from __future__ import annotations

import html
import re

SIGNS = re.compile(r"[\\`*_\[\]{}~|#$]")


def plain(text: str) -> str:
    """The text as one line of Markdown, or of HTML, without markup."""
    escaped = html.escape(" ".join(text.split()), quote=False)
    # The quotes' own entities hold one of the signs.
    signs = SIGNS.sub(lambda found: f"&#{ord(found[0])};", escaped)
    return signs.replace('"', "&quot;").replace("'", "&#39;")
