"""`--cluster`: where work is spread, as typed or as a file says.

local[:N]              N processes here, as many as there are processors by default
tcp://HOST:8786        a scheduler that runs, with its workers
FILE.toml              one that is started: `kind = "ssh"` or `kind = "slurm"`
"""

from __future__ import annotations

import os
import re
import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import suggest

AT = "--cluster"
HINT = 'local, local:4, tcp://HOST:8786, or a TOML file with kind = "ssh" or "slurm"'
KINDS = {
    "ssh": {"hosts": list, "workers": int, "python": str},
    "slurm": {
        "jobs": int,
        "cores": int,
        "memory": str,
        "queue": str,
        "walltime": str,
        "account": str,
    },
}
"""What a file of each kind may say, beside `kind`, and its type."""
NEEDED = {"ssh": ("hosts",), "slurm": ("jobs", "cores", "memory")}


@dataclass(frozen=True, kw_only=True, slots=True)
class Where:
    """Where work is spread."""

    kind: str
    """`local`, `address`, `ssh` or `slurm`."""
    workers: int = 0
    """Processes of a local one; of others those that there are."""
    address: str = ""
    """Of a scheduler that runs."""
    said: dict[str, Any] = field(default_factory=dict)
    """What the file says beside its kind."""

    @property
    def expected(self) -> int:
        """Workers once all have come; 0 where others start them."""
        if self.kind == "ssh":
            return len(self.said["hosts"]) * self.said.get("workers", 1)
        if self.kind == "slurm":
            return self.said["jobs"] * self.said["cores"]
        return self.workers


def read_where(words: str) -> Where:
    """What `--cluster` was given.

    Raises:
        DesignError: If it is none of the three, or the file says something that is not known.
    """
    found = re.fullmatch(r"local(?::(\d+))?", words)
    if found is not None:
        workers = int(found[1]) if found[1] else os.cpu_count() or 1
        if workers < 1:
            raise DesignError(
                "a cluster of 0 workers does nothing", hint="local:1 is the least", at=AT
            )
        return Where(kind="local", workers=workers)
    if re.fullmatch(r"(tcp|tls|ws|wss|ucx)://\S+", words):
        return Where(kind="address", address=words)
    path = Path(words)
    if path.suffix == ".toml":
        return _from_file(path)
    raise DesignError(f"there is no cluster {shown(words)}", hint=HINT, at=AT)


def _from_file(path: Path) -> Where:
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise DesignError(
            f"cannot read the cluster file {path}: {error}", hint=HINT, at=AT
        ) from error
    kind = table.pop("kind", "")
    if kind not in KINDS:
        hint = suggest(str(kind), KINDS) or f"kind is one of {', '.join(KINDS)}"
        raise DesignError(f"{path}: there is no kind of cluster {shown(kind)}", hint=hint, at=AT)
    known = KINDS[kind]
    for name, value in table.items():
        if name not in known:
            hint = suggest(name, known) or f"known are {', '.join(known)}"
            raise DesignError(f"{path}: {kind} knows no {shown(name)}", hint=hint, at=AT)
        if not isinstance(value, known[name]):
            wanted = known[name].__name__
            raise DesignError(f"{path}: {name} is {shown(value)}, not a {wanted}", hint=HINT, at=AT)
    missing = [name for name in NEEDED[kind] if not table.get(name)]
    if missing:
        raise DesignError(
            f"{path} does not say {', '.join(missing)}", hint=f"a cluster by {kind} needs it", at=AT
        )
    return Where(kind=kind, said=table)
