"""What is said of an object from a file that touches with its foot, and the turn that mends it."""

from __future__ import annotations

from workbench.core.design.turning import Angles, touching_with
from workbench.core.press.indenter import Indenter


def meant_turn(indenter: Indenter) -> Angles | None:
    """The turn with which the structured side touches; None where the touching side is fine.

    Only objects of triangles are looked at: every other kind comes with its face down. A texture
    says itself which side is to touch.
    """
    from geometry.objects.touching import meant_side

    mesh = indenter.standing_mesh
    if mesh is None or indenter.texture.raised:
        return None
    normal = meant_side(mesh.points_mm, mesh.faces)
    return None if normal is None else touching_with(indenter.turn_deg, normal)


def touching_notice(indenter: Indenter) -> str:
    """What to say of an object whose structured side looks away, else ""."""
    turn_deg = meant_turn(indenter)
    if turn_deg is None:
        return ""
    words = ",".join(f"{angle:g}" for angle in turn_deg)
    return (
        "a flat side of the object touches the skin, and its structured side looks away; "
        f"to touch with that side: --turn-deg {words}"
    )
