"""Numbers that the kernels of traced light and their plain twins share."""

from __future__ import annotations

ABSORBED, BASE, LEAKED, ROULETTE, DEPTH, FLYING = range(6)
"""Where a photon's power went; the first five are rows of the ledger."""
FATES = ("absorbed", "base", "leaked", "roulette", "depth")
EVENTS = 64
"""Most events of one photon; 0.7^64 is 1e-10."""
OFFSET_MM = 3e-4
"""A ray leaves a surface this far from it [mm]; single precision resolves 4e-6 at 50 mm."""
GRAZING = 1e-4
"""Cosine to a facet or a normal below which a ray runs along it."""
STEEPEST = 4.0
"""Largest weight by the difference of interpolated and facet normal."""
SURVIVAL = 0.98
"""Largest chance to go on after the coating: even in a white sphere a photon ends."""
FIXED_POINT = float(1 << 24)
"""Units of one photon's flux in the sums: whole numbers, whose sum does not depend on the order."""
LATTICE = (0xDB4F0B91, 0xBBE05633, 0xA0F2EC75, 0x89E18285)
"""2^32 / g^k with g^5 = g + 1: the steps of Roberts' sequence in four dimensions."""
NO_GATHERING, AT_NODES, TOWARD_CAMERA = range(3)
"""What is gathered where photons meet the coating."""
FLATTEST_COSINE = 0.01
"""Smallest cosine that a flux is divided by; the lowest bin of direction stands for it."""
LEDGER_SLOTS = 1024
"""Columns of the ledger."""
