"""Resolve dependencies into requirements.lock and requirements-dev.lock.

Asks pip for the full resolution without installing; local version suffixes (`+cpu`) are dropped,
so that each platform takes its own build of the same release.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).parent.parent
HEAD = "# Made by `make lock`; edit pyproject.toml instead.\n"


def resolved(requirements: list[str]) -> dict[str, str]:
    """Name and version of everything that the requirements pull in."""
    command = [sys.executable, "-m", "pip", "install", "--dry-run", "--ignore-installed"]
    command += ["--quiet", "--report", "-", *requirements]
    report = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    packages = (item["metadata"] for item in report["install"])
    return {p["name"].lower().replace("_", "-"): p["version"].split("+")[0] for p in packages}


def lines(packages: dict[str, str], markers: dict[str, str] | None = None) -> str:
    """Pins, one per line, with the platforms that some are for."""
    known = markers or {}
    return "".join(
        f"{name}=={version}{known.get(name, '')}\n" for name, version in sorted(packages.items())
    )


def main() -> None:
    """Write both files."""
    table = tomllib.loads((ROOT / "pyproject.toml").read_text())
    wanted, dev = table["project"]["dependencies"], table["dependency-groups"]["dev"]
    runtime = resolved(wanted)
    everything = resolved([*wanted, *dev])
    (ROOT / "requirements.lock").write_text(HEAD + lines(runtime))
    extra = {n: v for n, v in everything.items() if n not in runtime}
    markers: dict[str, str] = {}
    for requirement in (r for r in dev if ";" in r):
        # What only this requirement pulls in is for its platforms only.
        others = resolved([*wanted, *(r for r in dev if r != requirement)])
        marker = f"; {requirement.partition(';')[2].strip()}"
        markers |= {name: marker for name in everything if name not in others}
    pins = HEAD + "--requirement requirements.lock\n" + lines(extra, markers)
    (ROOT / "requirements-dev.lock").write_text(pins)


if __name__ == "__main__":
    main()
