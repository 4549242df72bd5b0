"""Widgets bound to fields of the session: edits go in, refused ones get a message underneath."""

from __future__ import annotations

import dataclasses
import html
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from workbench.core.errors import WorkbenchError


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


class Fields:
    """All bound widgets of a desk."""

    def __init__(self, server: Any, read: Callable[[str], Any], edit: Callable[..., None]) -> None:
        self.gui = server.gui
        self._read = read
        self._edit = edit
        self._fields: dict[str, Field] = {}
        self._refused: set[str] = set()

    def slider(
        self,
        label: str,
        path: str,
        *,
        span: tuple[float, float, float],
        hint: str = "",
        whole: bool = False,
    ) -> Any:
        """A slider with a number box; `span` is minimum, maximum and step."""
        low, high, step = span
        kind = int if whole else float
        value = min(max(kind(self._read(path)), low), high)
        handle = self.gui.add_slider(label, low, high, step, kind(value), hint=hint or None)
        span_text = f"this slider goes from {low:g} to {high:g}"

        def ended(value: Any) -> str:
            # The page cuts what is typed beyond the ends; nothing else tells the designer.
            return span_text if value in (low, high) else ""

        return self._bind(path, handle, kind, lambda v: min(max(kind(v), low), high), remark=ended)

    def number(self, label: str, path: str, *, step: float, hint: str = "") -> Any:
        """A number box without limits of its own; the design refuses what is wrong."""
        handle = self.gui.add_number(label, float(self._read(path)), step=step, hint=hint or None)
        return self._bind(path, handle, float, float)

    def choice(self, label: str, path: str, options: Sequence[Any], *, hint: str = "") -> Any:
        """A drop-down over the members of an enumeration."""
        return self.options(label, path, {str(m.value): m for m in options}, hint=hint)

    def options(self, label: str, path: str, named: Mapping[str, Any], *, hint: str = "") -> Any:
        """A drop-down over values with names for people."""
        names = {value: name for name, value in named.items()}
        now = names[self._read(path)]
        handle = self.gui.add_dropdown(label, tuple(named), initial_value=now, hint=hint or None)
        return self._bind(path, handle, named.__getitem__, names.__getitem__)

    def check(self, label: str, path: str, *, hint: str = "") -> Any:
        """A check box."""
        handle = self.gui.add_checkbox(label, bool(self._read(path)), hint=hint or None)
        return self._bind(path, handle, bool, bool)

    def point(self, label: str, path: str, *, step: float, hint: str = "") -> Any:
        """Three numbers in mm."""
        handle = self.gui.add_vector3(label, tuple(self._read(path)), step=step, hint=hint or None)
        return self._bind(path, handle, lambda v: tuple(float(x) for x in v), tuple)

    def anchor(self, label: str, path: str) -> None:
        """A place for messages about a field that another widget gives."""
        self._fields[path] = Field(
            path=path,
            label=label,
            handle=None,
            to_field=lambda value: value,
            to_widget=lambda value: value,
            complaint=self.gui.add_markdown("", visible=False),
        )

    def _bind(
        self,
        path: str,
        handle: Any,
        to_field: Callable[[Any], Any],
        to_widget: Callable[[Any], Any],
        remark: Callable[[Any], str] = lambda value: "",
    ) -> Any:
        complaint = self.gui.add_markdown("", visible=False)
        field = Field(
            path=path,
            label=handle.label,
            handle=handle,
            to_field=to_field,
            to_widget=to_widget,
            complaint=complaint,
        )
        self._fields[path] = field

        @handle.on_update
        def _(event: Any) -> None:
            # Values set by `refresh` come back here without a client.
            if event.client is not None:
                value = to_field(handle.value)
                self._edit(path, value)
                if path not in self._refused and not complaint.visible and remark(value):
                    complaint.content = f"<small>{remark(value)}</small>"
                    complaint.visible = True

        return handle

    def forget(self, prefix: str) -> None:
        """Remove the widgets whose path begins so."""
        for path in [p for p in self._fields if p.startswith(prefix)]:
            field = self._fields.pop(path)
            self._refused.discard(path)
            if field.handle is not None:
                field.handle.remove()
            field.complaint.remove()

    def refresh(self) -> None:
        """Show the session's values in every widget."""
        self._restore(self._fields)

    def refuse(self, path: str) -> None:
        """Remember that the widget holds a value that the design did not take."""
        self._refused.add(path)

    def complain(self, error: WorkbenchError) -> str:
        """Show an error under the widget it names; returns its path, "" without such a widget."""
        field = self._named(error.at)
        if field is None:
            return ""
        parts = [self.in_words(error.message, error.at), self.in_words(error.hint, error.at)]
        if field.handle is not None:
            kept = field.to_widget(self._read(field.path))
            if isinstance(kept, (int, float)) and kept != field.handle.value:
                parts.append(f"still using {kept:g}")
        words = html.escape("; ".join(part for part in parts if part))
        text = f"<span style='color:#e5484d'>{words}</span>"
        field.complaint.content = text
        field.complaint.visible = True
        return field.path

    def in_words(self, text: str, at: str = "") -> str:
        """A message with the labels of widgets in place of the names of fields.

        Args:
            text: The message.
            at: The field it is about: a name without its path is taken from the same part of the
                design, for example `radius_mm` from the ring.
        """
        labels = {
            path: f"\N{LEFT DOUBLE QUOTATION MARK}{field.label}\N{RIGHT DOUBLE QUOTATION MARK}"
            for path, field in self._fields.items()
        }
        for path in sorted(labels, key=lambda path: -len(path)):
            short = path.split(".", 1)[1].replace("settings.", "contact.", 1)
            text = text.replace(short, labels[path])
        about = self._named(at)
        part = about.path.rpartition(".")[0] if about is not None else ""
        for path, label in labels.items():
            parent, _, name = path.rpartition(".")
            if part and parent == part:
                # A name that is a common word counts only where a value follows.
                ends = r"(?![\w.])" if "_" in name else r"(?= = )"
                text = re.sub(rf"(?<![\w.]){re.escape(name)}{ends}", label, text)
        return text

    def settle(self, path: str = "") -> None:
        """Hide all messages; widgets with a refused value, but `path`, show the design's again."""
        for field in self._fields.values():
            if field.complaint.visible:
                field.complaint.visible = False
        refused, self._refused = self._refused - {path}, set()
        self._restore(refused)

    def _restore(self, paths: Iterable[str]) -> None:
        for path in paths:
            field = self._fields.get(path)
            if field is None or field.handle is None:
                continue
            value = field.to_widget(self._read(path))
            if field.handle.value != value:
                field.handle.value = value

    def _named(self, at: str) -> Field | None:
        names = (f"design.{at}", f"case.{at}", at.replace("contact.", "case.settings.", 1))
        return next((self._fields[n] for n in names if n in self._fields), None)


def read_field(state: Any, path: str) -> Any:
    """Value of a dotted path through dataclasses and mappings."""
    value = state
    for name in path.split("."):
        value = value[name] if isinstance(value, Mapping) else getattr(value, name)
    return value


def whole_shape(shape: Any) -> dict[str, Any]:
    """All parameters of a resolved shape by name."""
    return {f.name: getattr(shape, f.name) for f in dataclasses.fields(shape)}
