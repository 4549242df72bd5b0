"""How large what is around a contact is shown, and how deep a dent; it needs no PyTorch."""

from __future__ import annotations

PATCH_PX, HALF_MM = 64, 6.0
"""Side of what is shown [px], and half of it on the skin [mm]."""
MM_PER_PX = 2.0 * HALF_MM / PATCH_PX
GREY_PER_MM = 255.0
"""Grey levels that a dent of one millimetre is shown by."""
DENT, DROP = 0, 2
"""Channels of a dent that was read: inward displacement, and how far the skin at rest lies inward
of the plane that touches it in the middle."""
