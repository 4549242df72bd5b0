"""Press, then slide until the skin slips: Coulomb's cone from the reaction.

Shows: strokes after the approach, friction, the share of the contact that slides and when all does.
"""

import numpy as np

import workbench as wb

design = wb.load("finger").replace("material.friction", 0.4)
# 1 mm deep, then 1.5 mm along U in the tangent plane.
press = wb.Press(depth_mm=0.8, frames=3, strokes=(wb.slide(1.5, 0.0, frames=6),))
results = wb.evaluate(
    design, wb.Indenter("sphere", size_mm=8.0), press, settings=wb.ContactSettings(grid_mm=0.8)
)

contact = results.contact
normal_N = contact.normal_N
tangential_N = np.linalg.norm(contact.reaction_N - np.outer(normal_N, contact.normal), axis=1)
ratio = tangential_N / normal_N
for frame, (down, aside, share) in enumerate(zip(normal_N, tangential_N, ratio, strict=True), 1):
    print(f"frame {frame}: {down:6.3f} N down, {aside:6.3f} N aside, ratio {share:.3f}")

gross = results.gross_slip()
assert gross is not None
print(f"all of the contact slides from {gross.way_mm:.2f} mm on, in frame {gross.frame}")

# It sticks first: the ratio rises. Then it slips: point by point the ratio is mu, and the normals
# of a curved dent lean, so that the whole may have a little more.
assert contact.sliding_share[2] < 0.1
assert contact.sliding_share[-1] == 1.0
assert 0.5 < gross.way_mm < 1.0
assert ratio[2] < 0.1
assert 0.35 < ratio[-1] < 0.55
assert abs(ratio[-1] - ratio[-2]) < 0.3 * ratio[-1]
