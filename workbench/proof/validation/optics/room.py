"""Optics: against closed forms, figures of Mitsuba, photographs, and itself another way."""

from __future__ import annotations

from workbench.proof.row import Row
from workbench.proof.validation.optics import (
    contact_seen,
    light_models,
    lobe_rows,
    optics_physics,
    optics_views,
    photographs,
    recorded_rows,
)


def rows() -> list[Row]:
    """All rows of the room."""
    from sim.optics.proof.specimen import finger
    from workbench.pipeline.devices import open_device

    open_device()
    mesh = finger(edge_mm=0.5)
    return [
        *optics_physics.rows(mesh),
        *lobe_rows.rows(),
        *recorded_rows.rows(),
        *optics_views.rows(mesh),
        *light_models.rows(),
        *contact_seen.rows(),
        *photographs.rows(),
    ]
