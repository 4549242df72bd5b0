"""Hands the 3D scene out as one HTML file to the tab that asked."""

from __future__ import annotations

import threading
from typing import Any

from ui.desk.desk import Desk
from ui.scene.recording import record
from workbench.view.shared_scene import file_name, titled


def save_scene(desk: Desk, client: Any) -> None:
    """Record the scene now, and send it once it is packed; other tabs see nothing of it.

    Packing takes a second for a long press, so it happens in a thread of its own.
    """
    if client is None:
        return
    name = desk.session.design.name
    recording = record(desk.server, desk.scene, client)

    def pack() -> None:
        try:
            page = titled(recording.as_html(dark_mode=True), name)
        except Exception as bug:
            desk.reports.crash(bug)
            return
        desk.guarded(lambda event: send(page))(None)

    def send(page: str) -> None:
        client.send_file_download(file_name(name), page.encode(), save_immediately=True)
        desk.log(f"scene saved as {file_name(name)}, {len(page) / 1e6:.1f} MB")

    threading.Thread(target=pack, name="scene file", daemon=True).start()
