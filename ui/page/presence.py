"""Who is behind a tab, and whether anybody still is.

A connection that was cut without a word (a laptop shut, a browser killed behind a proxy) stands
for minutes. A ping is answered by the browser itself, however busy its page is, so a tab whose
ping is not answered in a few seconds is taken for gone.
"""

from __future__ import annotations

import asyncio
import ipaddress
from typing import Any

ANSWER_S = 3.0
"""Time a browser has to answer a ping before its tab counts as gone [s]."""
BROWSERS = (
    ("Edg/", "Edge"),
    ("OPR/", "Opera"),
    ("Firefox/", "Firefox"),
    ("Chrom", "Chrome"),
    ("Safari/", "Safari"),
)
"""Words of a User-Agent, the most telling first: Edge calls itself Chrome and Safari too."""
SYSTEMS = (
    ("Android", "Android"),
    ("iPhone", "iPhone"),
    ("iPad", "iPad"),
    ("Windows", "Windows"),
    ("Mac OS X", "macOS"),
    ("CrOS", "ChromeOS"),
    ("Linux", "Linux"),
)


def browser_words(agent: str) -> str:
    """A browser and its system by the User-Agent it sends: `Firefox on Linux`, or `a browser`."""
    browser = next((name for word, name in BROWSERS if word in agent), "a browser")
    system = next((name for word, name in SYSTEMS if word in agent), "")
    return f"{browser} on {system}" if system else browser


class Presence:
    """The connections of a viser server's tabs."""

    def __init__(self, server: Any) -> None:
        self._server = server

    def _connection(self, tab: int) -> Any:
        # viser keeps the connections of its tabs here and has no public way to them.
        sockets = getattr(self._server, "_websock_server", None)
        return getattr(sockets, "_live_connections", {}).get(tab)

    def words(self, tab: int) -> str:
        """Who is behind a tab: browser, system and address; `another tab` where nobody knows."""
        connection = self._connection(tab)
        if connection is None:
            return "another tab"
        agent = connection.request.headers.get("User-Agent", "")
        address = str((connection.remote_address or [""])[0])
        return f"{browser_words(agent)} {_place(address)}".strip()

    async def answers(self, tab: int) -> bool:
        """Whether the browser of a tab answers a ping in time."""
        connection = self._connection(tab)
        if connection is None:
            return False
        # Any failure to ask means that there is nobody to be asked.
        try:
            async with asyncio.timeout(ANSWER_S):
                await (await connection.ping())
        except Exception:
            return False
        return True

    def cut(self, tab: int) -> None:
        """End the connection of a tab that does not answer, without waiting for its good-bye."""
        connection = self._connection(tab)
        if connection is not None:
            connection.transport.abort()


def _place(address: str) -> str:
    try:
        local = ipaddress.ip_address(address).is_loopback
    except ValueError:
        return ""
    return "on this machine" if local else f"at {address}"
