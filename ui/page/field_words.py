"""Which widget a message is about, and the message in the words that stand on the page."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from ui.page.colours import RED
from ui.page.plain import plain
from workbench.core.base.errors import WorkbenchError

NUMBER = re.compile(r"\[\d+\]$")


@dataclass(kw_only=True)
class Field:
    """One widget and the field it edits."""

    path: str
    """Dotted field of the session's state, for example `design.layers.elastomer_mm`."""
    label: str
    handle: Any
    """None where another widget than a bound one gives the value, for example an upload."""
    to_field: Callable[[Any], Any]
    to_widget: Callable[[Any], Any]
    complaint: Any
    """Hidden markdown under the widget, shown when a value is refused."""


def find_field(fields: Mapping[str, Field], at: str) -> Field | None:
    """The field of that name, else the place for messages about all of its table.

    Args:
        fields: By their paths in the session's state.
        at: A field of the design or the press as an error names it.
    """
    while at:
        names = (f"design.{at}", f"case.{at}", at.replace("contact.", "case.settings.", 1))
        found = next((fields[name] for name in names if name in fields), None)
        if found is not None:
            return found
        # A lamp or camera that is not on show has its messages at the list of all.
        at = NUMBER.sub("", at) if NUMBER.search(at) else at.rpartition(".")[0]
    return None


def in_words(fields: Mapping[str, Field], text: str, at: str = "") -> str:
    """A message with the labels of widgets in place of the names of fields.

    Args:
        fields: By their paths in the session's state.
        text: The message.
        at: The field it is about: a name without its path is taken from the same part of the
            design, for example `radius_mm` from the ring.
    """
    labels = {
        path: f"\N{LEFT DOUBLE QUOTATION MARK}{field.label}\N{RIGHT DOUBLE QUOTATION MARK}"
        for path, field in fields.items()
    }
    for path in sorted(labels, key=lambda path: -len(path)):
        short = path.split(".", 1)[1].replace("settings.", "contact.", 1)
        text = text.replace(short, labels[path])
    about = find_field(fields, at)
    part = about.path.rpartition(".")[0] if about is not None else ""
    for path, label in labels.items():
        parent, _, name = path.rpartition(".")
        if part and parent == part:
            # A name that is a common word counts only where a value follows.
            ends = r"(?![\w.])" if "_" in name else r"(?= = )"
            text = re.sub(rf"(?<![\w.]){re.escape(name)}{ends}", label, text)
    return text


def refused_html(
    fields: Mapping[str, Field], field: Field, error: WorkbenchError, kept: Any
) -> str:
    """An error as it stands under the widget of its field.

    Args:
        fields: By their paths in the session's state.
        field: What the error is about.
        error: Why the value was refused.
        kept: The design's value as the widget would show it, None where it shows none.
    """
    parts = [in_words(fields, text, error.at) for text in (error.message, error.hint)]
    if isinstance(kept, (int, float)) and kept != field.handle.value:
        parts.append(f"still using {kept:g}")
    words = plain("; ".join(part for part in parts if part))
    return f"<span style='color:{RED}'>{words}</span>"
