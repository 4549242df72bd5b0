"""Names of what is being written: by whom, on which host.

So what a dead process left behind can be told from what another is at, here or on a machine that
shares the folder.
"""

from __future__ import annotations

import os
import re
import secrets
import socket
import time
from pathlib import Path

from workbench.system.processes import is_alive

UNFINISHED = ".part-*"
"""What all such names match."""
ABANDONED_S = 24 * 3600.0
"""Age from which what another host was writing counts as left behind [s]."""
_NAME = re.compile(r"\.part-(?P<pid>\d+)(?:@(?P<host>.+))?-[^-]*")


def prefix() -> str:
    """How names of this process begin; a token that no other has must follow."""
    return f".part-{os.getpid()}@{socket.gethostname().replace('/', '_')}-"


def fresh_name() -> str:
    """A name of this process that nothing has."""
    return prefix() + secrets.token_hex(6)


def is_left_behind(part: Path) -> bool:
    """Whether nobody writes it any more, as far as can be seen from here."""
    found = _NAME.fullmatch(part.name)
    if found is None:
        return True
    host = found["host"]
    if host is None or host == socket.gethostname().replace("/", "_"):
        return not is_alive(int(found["pid"]))
    try:
        return time.time() - part.stat().st_mtime > ABANDONED_S
    except OSError:
        # It is gone, or its folder cannot be read: nothing to remove.
        return False
