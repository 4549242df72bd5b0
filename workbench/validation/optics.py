"""Optics: lenses, refraction, light and images against closed forms, definitions and photons."""

from __future__ import annotations

from workbench.rows import Row
from workbench.validation import light_models, optics_physics, optics_views


def rows() -> list[Row]:
    """All rows of the room."""
    from sim.optics.specimen import finger
    from workbench.devices import open_device

    open_device()
    mesh = finger(edge_mm=0.5)
    return [*optics_physics.rows(mesh), *optics_views.rows(mesh), *light_models.rows()]
