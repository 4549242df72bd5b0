"""Optics: lenses, refraction, light and images against closed forms, definitions and photons."""

from __future__ import annotations

from workbench.proof.row import Row
from workbench.proof.validation.optics import (
    contact_seen,
    light_models,
    optics_physics,
    optics_views,
)


def rows() -> list[Row]:
    """All rows of the room."""
    from sim.optics.proof.specimen import finger
    from workbench.pipeline.devices import open_device

    open_device()
    mesh = finger(edge_mm=0.5)
    return [
        *optics_physics.rows(mesh),
        *optics_views.rows(mesh),
        *light_models.rows(),
        *contact_seen.rows(),
    ]
