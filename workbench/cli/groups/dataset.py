"""`workbench dataset`: make, check and show data sets of presses for learning."""

from __future__ import annotations

from workbench.cli.command import Group

GROUP = Group(place=9, help="Make, check and show data sets of presses for learning.")
