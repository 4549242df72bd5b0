"""Callbacks of shared widgets run one after the other, in the order in which the pages sent them.

viser runs each in one of 32 threads, where a click on *Run press* can overtake the number that was
typed before it: both wait for the desk's lock, which does not know who came first. Windows of a tab
of its own (`client.gui`) are left to viser's threads.

viser (1.1) has no setting for it: the executors of shared widgets and scene are replaced.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any


def run_in_order(server: Any) -> None:
    """Give the shared widgets and the scene of a server one thread for all their callbacks."""
    one = ThreadPoolExecutor(max_workers=1, thread_name_prefix="callbacks")
    server.gui._thread_executor = one
    server.scene._thread_executor = one
