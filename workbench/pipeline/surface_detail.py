"""Which objects have a texture that images show beyond what contact resolves."""

from __future__ import annotations

from sim.optics.field.model import model_of
from workbench.core.base.errors import DesignError
from workbench.core.design.optics import Optics
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import ContactSettings, Method


def detailed(optics: Optics, indenter: Indenter, settings: ContactSettings) -> Indenter | None:
    """The object if images add its fine texture, else None.

    Raises:
        DesignError: If its texture is too fine for contact, and images do not show it either.
    """
    if not indenter.texture.raised:
        return None
    reason = _not_shown(optics, indenter, settings)
    if not reason:
        return indenter
    _check_resolved(indenter, settings.grid_mm, reason)
    return None


def _not_shown(optics: Optics, indenter: Indenter, settings: ContactSettings) -> str:
    """Why images show no more of a texture than contact; empty if they do."""
    if not optics.detail:
        return "optics.detail is off"
    if indenter.soft is not None:
        return "no detail is shown of a soft object"
    if settings.method is not Method.LATTICE:
        return f"contact.method {settings.method} finds no pressure to show detail by"
    if model_of(optics.light_model).per_frame:
        return f"the light model {optics.light_model} shows no detail"
    return ""


def _check_resolved(indenter: Indenter, grid_mm: float, reason: str) -> None:
    from sim.contact.objects.sampling import SAMPLES_PER_CELL
    from sim.contact.objects.textures import LEAST_FEATURE_SAMPLES, resolved

    texture, spacing_mm = indenter.texture, grid_mm / SAMPLES_PER_CELL
    if resolved(texture, spacing_mm):
        return
    least, width = LEAST_FEATURE_SAMPLES * spacing_mm, 2.0 * texture.flank_mm
    pitch = texture.pitch_mm * least / width
    raise DesignError(
        f"{texture.pattern} with a pitch of {texture.pitch_mm:g} mm have ridges {width:.2f} mm "
        f"wide; contact resolves {least:.2f} mm, and {reason}",
        hint=f"raise the pitch to {pitch:.2f} mm or lower contact.grid_mm",
        at="indenter.texture.pitch_mm",
    )
