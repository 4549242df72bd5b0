"""What a browser's system prefers, dark or light, which viser does not tell the server.

A piece of HTML writes it into the browser's storage, at each visit, where viser's server can ask
for it (`client.local_storage`).
"""

from __future__ import annotations

from ui.patches.image_click import script_in_html

SYSTEM = "workbench-system"
"""Name of what is stored: "light" or "dark"."""
TELL = """
localStorage.setItem('viser-user:SYSTEM',
  matchMedia('(prefers-color-scheme: light)').matches ? 'light' : 'dark')
""".replace("SYSTEM", SYSTEM)
"""viser puts its own name before those of a server's."""


def system_theme() -> str:
    """What is laid into the page, as HTML; it is seen nowhere."""
    return script_in_html(TELL)
