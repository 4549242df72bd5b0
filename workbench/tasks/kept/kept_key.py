"""The key of what a task keeps: it is read again only where all that it rests on is the same."""

from __future__ import annotations

from workbench.core.base.digest import digest
from workbench.planning.stage_table import STAGES
from workbench.system.record import code_digest

BELOW = ("build", "mesh", "lattice", "press", "fem", "bake", "table")
"""Stages whose results are looked up by name, which no import shows."""


def kept_key(rests_on: list[object], sources: tuple[str, ...]) -> str:
    """Of what something is, of the code that makes it, and of the stages below.

    Args:
        rests_on: What it is of: design, recipe, photographs; whatever `digest` takes.
        sources: Modules that make it; all that they import counts.
    """
    versions = {name: STAGES[name].version for name in BELOW}
    return digest([rests_on, code_digest(sources), versions])
