"""What surfaces of the 3D view are made of, for the eye: silicone, resin, metal, plastic, glass.

Found by eye, not measured: what a coating of the sensor's inside does to light is the business of
the optics, and is not shown here.
"""

from __future__ import annotations

from ui.patches.materials import Finish

SILICONE = Finish(roughness=0.5)
"""Matt and soft, with a wide highlight; frames of a press have it in their files (`MATT`)."""
RESIN = Finish(roughness=0.15, reflection=5.0)
"""Clear and polished."""
ANODISED = Finish(roughness=0.45, metalness=0.3)
PLASTIC = Finish(roughness=0.3)
LIT = Finish(roughness=0.3, glow=0.85)
GLASS = Finish(roughness=0.12)
FINISHES = {
    "/sensor/skin": SILICONE,
    "/sensor/inside": PLASTIC,
    "/sensor/tips": PLASTIC,
    "/sensor/rigid": RESIN,
    "/sensor/foot": ANODISED,
    "/indenter": PLASTIC,
    "/parts": PLASTIC,
    "/leds/": LIT,
    "/lamps/": LIT,
    "/camera": GLASS,
}
