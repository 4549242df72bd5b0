"""Where a server can be reached from other machines: links that work when they are copied.

`0.0.0.0` and `::` are every address of this machine and the address of none. A name comes first if
this machine can look it up, since it survives a change of network; whether others can is their
network's matter, so the addresses follow.
"""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Sequence

ANY = ("0.0.0.0", "::", "")
"""What binds to every address."""
FAR = {socket.AF_INET: "192.0.2.1", socket.AF_INET6: "2001:db8::1"}
"""Addresses of documentation (RFC 5737, RFC 3849): the way there starts at this machine's own.
Nothing is sent: a datagram socket that connects only chooses its way."""


def reachable_names(host: str) -> list[str]:
    """Names and addresses of what a server is bound to, the best first; loopback has none."""
    if host not in ANY:
        return [host]
    families = [socket.AF_INET] if host == "0.0.0.0" else [socket.AF_INET, socket.AF_INET6]
    name, found = socket.gethostname(), []
    for family in families:
        with contextlib.suppress(OSError):
            known = [str(row[4][0]) for row in socket.getaddrinfo(name, None, family)]
            found += [name, *known]
        with contextlib.suppress(OSError), socket.socket(family, socket.SOCK_DGRAM) as way:
            way.connect((FAR[family], 9))
            found.append(str(way.getsockname()[0]))
    once = dict.fromkeys(item for item in found if _leads_here(item))
    return list(once) or ["localhost"]


def links(names: Sequence[str], port: int, token: str | None) -> list[str]:
    """A link for each name or address; the token opens the door once."""
    query = f"?token={token}" if token else ""
    return [f"http://{f'[{name}]' if ':' in name else name}:{port}/{query}" for name in names]


def _leads_here(name: str) -> bool:
    """Whether another machine finds this one by it; link-local addresses want an interface too."""
    here = name in ("localhost", "::1", *ANY) or name.startswith("127.")
    return not here and not name.lower().startswith("fe80:")
