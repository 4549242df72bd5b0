"""What was released with the paper, beside ours: one file per group of rows."""

from __future__ import annotations

from workbench.proof.row import Row
from workbench.proof.validation.optics import idle_photo
from workbench.proof.validation.published import indenters, membranes


def rows() -> list[Row]:
    """All rows of the room."""
    return [*membranes.rows(), *indenters.rows(), *idle_photo.rows()]
