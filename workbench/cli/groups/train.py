"""`workbench train`: teach a network on data sets, tune it, and see what more data buy."""

from __future__ import annotations

from workbench.cli.command import Group

GROUP = Group(place=11, help="Train networks on data sets of presses.")
