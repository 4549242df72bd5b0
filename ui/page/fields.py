"""Widgets bound to fields of the session: edits go in, refused ones get a message underneath."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from ui.page.callbacks import put
from ui.page.choice_hint import told_with_name
from ui.page.field_words import Field, find_field, in_words, refused_html
from workbench.core.base.errors import WorkbenchError
from workbench.view.choice_words import named

TYPED_S = 0.8
"""Quiet time after which a text is read: viser tells of every letter [s]."""


class Fields:
    """All bound widgets of a desk."""

    def __init__(self, server: Any, read: Callable[[str], Any], edit: Callable[..., None]) -> None:
        self.gui = server.gui
        self.lock = threading.RLock()
        """Held while a widget is read and its value is taken, or while state and widgets change."""
        self._read = read
        self._edit = edit
        self._fields: dict[str, Field] = {}
        self._refused: set[str] = set()
        self._typed: dict[str, float] = {}
        """Paths of texts that wait to be read, and when each was last typed in [s]."""

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

    def number(
        self, label: str, path: str, *, step: float, hint: str = "", whole: bool = False
    ) -> Any:
        """A number box without limits of its own; the design refuses what is wrong."""
        kind = int if whole else float
        value, by = kind(self._read(path)), kind(step)
        handle = self.gui.add_number(label, value, step=by, hint=hint or None)
        return self._bind(path, handle, kind, kind)

    def text(
        self,
        label: str,
        path: str,
        *,
        read: Callable[[str], Any],
        write: Callable[[Any], str],
        hint: str = "",
    ) -> Any:
        """A line of text, read once nobody has typed for a moment; `read` may refuse it."""
        handle = self.gui.add_text(label, write(self._read(path)), hint=hint or None)
        field = self._field(path, handle, read, write)

        @handle.on_update
        def _(event: Any) -> None:
            if event.client is not None:
                self._typed[field.path] = time.monotonic()

        return handle

    def read_typed(self, *, now: bool = False) -> None:
        """Read the texts that nobody types in any more, or with `now` all of them."""
        quiet = time.monotonic() - (0.0 if now else TYPED_S)
        for path in [path for path, when in list(self._typed.items()) if when <= quiet]:
            del self._typed[path]
            if path in self._fields:
                self._take(self._fields[path])

    def _take(self, field: Field) -> bool:
        """Hand a widget's value on; whether it could be read."""
        try:
            value = field.to_field(field.handle.value)
        except WorkbenchError as error:
            self.refuse(field.path)
            self.complain(error)
            return False
        self._edit(field.path, value)
        return True

    def choice(self, label: str, path: str, options: Sequence[Any], *, hint: str = "") -> Any:
        """A drop-down over the members of an enumeration, in words; its hint tells their names."""
        choices = named(options)
        handle = self.options(label, path, choices, hint=hint)
        told_with_name(handle, hint, {text: str(m.value) for text, m in choices.items()})
        return handle

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
        self._field(path, None, lambda value: value, lambda value: value, label=label)

    def _bind(
        self,
        path: str,
        handle: Any,
        to_field: Callable[[Any], Any],
        to_widget: Callable[[Any], Any],
        remark: Callable[[Any], str] = lambda value: "",
    ) -> Any:
        field = self._field(path, handle, to_field, to_widget)

        @handle.on_update
        def _(event: Any) -> None:
            if event.client is None:
                # A value set by `refresh` comes back here.
                return
            # Read under the lock: a value read before an undo must not be taken after it.
            with self.lock:
                if not self._take(field):
                    return
                complaint, words = field.complaint, remark(to_field(handle.value))
                if field.path not in self._refused and not complaint.visible and words:
                    complaint.content = f"<small>{words}</small>"
                    complaint.visible = True

        return handle

    def _field(
        self,
        path: str,
        handle: Any,
        to_field: Callable[[Any], Any],
        to_widget: Callable[[Any], Any],
        *,
        label: str = "",
    ) -> Field:
        field = Field(
            path=path,
            label=label or handle.label,
            handle=handle,
            to_field=to_field,
            to_widget=to_widget,
            complaint=self.gui.add_markdown("", visible=False),
        )
        self._fields[path] = field
        return field

    def rebind(self, old: str, new: str) -> None:
        """Let the widgets of one table edit another of the same kind, and show its values."""
        if old == new:
            return
        moved = [path for path in self._fields if path == old or path.startswith(f"{old}.")]
        for path in moved:
            field = self._fields.pop(path)
            self._refused.discard(path)
            self._typed.pop(path, None)
            field.complaint.visible = False
            field.path = new + path.removeprefix(old)
            self._fields[field.path] = field
        self._restore([new + path.removeprefix(old) for path in moved])

    def widget(self, path: str) -> Any:
        """The widget that is bound to a field."""
        return self._fields[path].handle

    def has(self, path: str) -> bool:
        """Whether a field has a widget now: those of another family come after its design."""
        return path in self._fields

    def reveal(self, path: str, wanted: bool) -> None:
        """Show or hide a widget that means nothing for some designs."""
        handle = self._fields[path].handle
        if handle.visible != wanted:
            handle.visible = wanted

    def forget(self, prefix: str) -> None:
        """Remove the widgets whose path begins so."""
        for path in [p for p in self._fields if p.startswith(prefix)]:
            field = self._fields.pop(path)
            self._refused.discard(path)
            self._typed.pop(path, None)
            if field.handle is not None:
                field.handle.remove()
            field.complaint.remove()

    def refresh(self) -> None:
        """Show the session's values in every widget."""
        self._typed.clear()
        self._restore(self._fields)

    def refuse(self, path: str) -> None:
        """Remember that the widget holds a value that the design did not take."""
        self._refused.add(path)

    def complain(self, error: WorkbenchError) -> str:
        """Show an error under the widget it names; returns its path, "" without such a widget."""
        field = find_field(self._fields, error.at)
        if field is None:
            return ""
        kept = None if field.handle is None else self._kept(field)
        field.complaint.content = refused_html(self._fields, field, error, kept)
        field.complaint.visible = True
        return field.path

    def in_words(self, text: str, at: str = "") -> str:
        """A message about the field `at` with labels in place of the names of fields."""
        return in_words(self._fields, text, at)

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
            value = self._kept(field)
            if value is not None:
                put(field.handle, value)

    def _kept(self, field: Field) -> Any:
        """The design's value as the widget shows it; None of a lamp or camera that is gone."""
        try:
            value = self._read(field.path)
        except IndexError:
            # The item goes first; its widgets are bound anew or removed when the panel follows.
            return None
        return field.to_widget(value)
