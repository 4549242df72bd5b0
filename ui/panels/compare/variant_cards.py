"""The list of variants as HTML: all that they hold was typed by somebody, and is escaped."""

from __future__ import annotations

import base64
import html
from collections.abc import Sequence
from pathlib import Path

from ui.page.colours import AMBER, RED
from ui.patches.leading import empty_state
from workbench.pipeline.store import Store
from workbench.variants.variant_files import Entry
from workbench.variants.variants import Variant, stored_keys

NOTHING = empty_state(
    "No variant yet: one keeps the design as it stands, with its press, images and figures.",
    "Save the first variant",
    press="Save variant",
)
MOST_THUMBNAILS = 40
"""Thumbnails in the list; each is some 30 KB of the page."""


def cards_html(entries: Sequence[Entry], store: Store) -> str:
    """All variants, or a word where there is none."""
    if not entries:
        return NOTHING
    shown = "".join(
        _card(entry, store, drawn=number < MOST_THUMBNAILS) for number, entry in enumerate(entries)
    )
    # Two or three stand in the list at once: what comes below must not be out of reach.
    box = "margin:4px 8px;font-size:12px;max-height:330px;overflow-y:auto"
    return f"<div style='{box}'>{shown}</div>"


def _card(entry: Entry, store: Store, *, drawn: bool) -> str:
    """One variant."""
    name, variant = html.escape(entry.name), entry.variant
    box = "<div style='border-top:1px solid #8885;padding:6px 0;overflow-wrap:anywhere'>"
    if variant is None:
        reason = html.escape(entry.reason)
        return f"{box}<b>{name}</b> <span style='color:{RED}'>broken: {reason}</span></div>"
    thumbnail = ""
    if drawn and entry.thumbnail is not None:
        thumbnail = thumbnail_html(entry.thumbnail, entry.name)
    pill = "background:#8884;border-radius:8px;padding:0 6px"
    tags = "".join(f" <span style='{pill}'>{html.escape(t)}</span>" for t in variant.tags)
    note = f"<div style='white-space:pre-wrap'>{html.escape(variant.note)}</div>"
    when = html.escape(f"{variant.state.design.family} · {variant.saved}".rstrip(" ·"))
    head = f"<b>{name}</b> <span style='opacity:.65'>{when}</span>{tags}"
    gone = _gone(variant, stored_keys(store, variant.keys, entry.planned))
    return f"{box}{head}{note if variant.note else ''}{gone}{thumbnail}</div>"


def _gone(variant: Variant, keys: dict[str, str]) -> str:
    """Why there is no image; nothing where there is one."""
    if "shoot" in keys:
        return ""
    lost = any(stage not in keys for stage in variant.keys)
    why = "its results were cleared from the store" if lost else "it was never pressed"
    return f"<div style='color:{AMBER}'>No image: {why}. Run what is missing.</div>"


def thumbnail_html(path: Path, name: str) -> str:
    """The thumbnail of a variant as HTML; nothing where its file is gone."""
    try:
        data = base64.b64encode(path.read_bytes()).decode()
    except OSError:
        return ""
    words = html.escape(f"{name}: at rest, pressed, image", quote=True)
    return (
        f"<img src='data:image/png;base64,{data}' alt='{words}' title='{words}' "
        "style='width:100%;min-width:0;border-radius:4px;margin-top:4px;display:block'>"
    )
