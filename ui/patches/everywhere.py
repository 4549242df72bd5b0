"""What holds for the whole page from its beginning: scripts and rules of several of the patches."""

from __future__ import annotations

from typing import Any

from ui.patches import keyboard, leading, remembering, software_note
from ui.patches.image_click import script_in_html


def mend_everywhere(gui: Any) -> None:
    """Lay all of them into the page; they are seen nowhere themselves."""
    scripts = (
        leading.LEAD,
        keyboard.mend_keyboard(),
        remembering.remember(),
        software_note.close_software_note(),
    )
    sheet = f"<style>{leading.SHEET}{keyboard.SHEET}</style>"
    gui.add_html(sheet + "".join(script_in_html(script) for script in scripts))
