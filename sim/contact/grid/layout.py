"""Numbers that kernels and their orchestration agree on: states, modes, and rows of tables."""

FREE, TOUCHED, HELD, SLID = 0, 1, 2, 3
"""States of a contact point: apart; anchored within this frame; anchored by a settled state in
which it stuck; by one in which it slid, so that kinetic friction holds it."""
LIFTED = 0.5
"""Gap at which a point forgets where it held, in cells: it will touch anew."""
MEETS_RIGID, HELD_STILL, MEETS_SOFT = 0, 1, 2
"""Kinds of surface points (`held`): what they meet, or that they are held or driven."""
UNHELD, FIXED, TIED = 0, 1, 2
"""What holds a node (`fixed`): nothing; material that was left out; the nodes that it follows."""
AXIS, STIFFNESS, SIDEWAYS, LOCAL = 3, 6, 7, 8
POINT = 11
"""Floats of a surface point: place from the target, then the above: unit normal, spring, its part
sideways, and the place in its cell in cell edges from the centre."""
IDLE, MOVING, STILL = 0, 1, 2
"""Modes of a case: left alone; relaxing; forces only."""
FRICTION, MASS_SCALE, DAMPING, LARGEST_STEP, INVERSE_EDGE, KINETIC, SIZE = 0, 1, 2, 3, 4, 5, 6
NUMBERS = 14
"""Floats of a case: the above, with the eight of the object's size at the end."""
MODE, SHAPE, FIRST_COEFFICIENT, COUNTS = 0, 1, 2, 3
CHOICES = 6
"""Integers of a case: the above, with the three counts of distance samples at the end."""
POSE = 13
"""Floats of a pose: origin from the target, rotation by rows, share of the drives' way."""
