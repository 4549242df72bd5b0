"""NOTICE names the licence of every package that is installed."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parent.parent
KEPT_APART = ("pymeshlab", "certifi", "tqdm", "pytetwild")
"""Packages under licences that ask for more than a notice."""


def licences() -> dict[str, str]:
    """Licence by package, of the list in NOTICE."""
    text = (ROOT / "NOTICE").read_text().split("by its licence:\n\n")[1].split("\n\n")[0]
    rows = re.sub(r"\n  ", " ", text).splitlines()
    found = {}
    for row in rows:
        licence, names = row.removeprefix("- ").rsplit(": ", 1)
        found |= {name.strip(): licence for name in names.split(",")}
    return found


def test_every_locked_package_has_its_licence() -> None:
    """The lock file and the list name the same packages."""
    lines = (ROOT / "requirements.lock").read_text().splitlines()
    locked = {line.split("==")[0] for line in lines if not line.startswith("#")}
    assert set(licences()) == locked


def test_what_asks_for_more_is_not_called_permissive() -> None:
    """GPL and MPL stand where they belong."""
    found = licences()
    assert all(re.match(r"GPL|MPL", found[name]) for name in KEPT_APART)
    others = [name for name, licence in found.items() if re.search(r"GPL|MPL", licence)]
    assert set(others) == {*KEPT_APART, "cadquery-ocp-novtk"}
