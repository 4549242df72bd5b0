"""`workbench reader`: teach a network to read touch from photographs of one design."""

from __future__ import annotations

from workbench.cli.command import Group

GROUP = Group(place=11, help="Train a reader of touch for one design, and take it elsewhere.")
