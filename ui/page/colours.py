"""Colours that mean the same all over the page: of words, marks and curves."""

from __future__ import annotations

RED = "#e5484d"
"""What was refused or has failed."""
AMBER = "#f5a623"
"""What is worth knowing; also the second curve of a plot."""
GREEN = "#30a46c"
"""The third curve of a plot."""
BLUE = "#3b82f6"
"""The first curve of a plot."""
GREY = "#8a8f98"
"""A line that only marks a place; seen on a dark page and on a light one."""
