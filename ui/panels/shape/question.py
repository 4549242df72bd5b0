"""A question in a window of one tab: what may be done, as buttons, and a way out.

Buttons of a tab's own GUI pass `ui.page.incoming`, so that it is asked here whether the tab still
edits.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from ui.desk.desk import Desk
from ui.page.plain import plain


def ask(
    desk: Desk, client: Any, title: str, words: str, answers: Mapping[str, Callable[[], None]]
) -> None:
    """Open the question; it closes with any answer.

    Args:
        desk: Whose lock the answer runs under.
        client: The tab.
        title: Of the window.
        words: What is asked, as plain text.
        answers: What each button does, by its label.
    """
    window = client.gui.add_modal(title)

    def answered(act: Callable[[], None], event: Any) -> None:
        window.close()
        if desk.editor.edits(client.client_id):
            act()
        else:
            desk.editor.remind(client.client_id)

    with window:
        client.gui.add_markdown(plain(words))
        for label, act in answers.items():
            client.gui.add_button(label).on_click(desk.guarded(partial(answered, act)))
        client.gui.add_button("Cancel", color="gray").on_click(lambda event: window.close())
