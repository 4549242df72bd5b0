"""Press a ball into a finger: force against depth, and what the camera sees.

Shows: loading a preset, changing it, a press in frames, forces and images as NumPy arrays.
"""

from pathlib import Path

import cv2
import numpy as np

import workbench as wb

OUT = Path("out/examples/01_press")
OUT.mkdir(parents=True, exist_ok=True)

# A preset is a design; `replace` gives a changed copy. `direct` light needs no bake: a quick look.
design = wb.load("geltip").replace("optics.light_model", "direct")

# Four frames to a depth of 1 mm from first touch. The target is left to the family: its seam.
press = wb.Press(depth_mm=1.0, frames=4)

# Nothing heavy has run yet: results are computed as they are asked for. 0.8 mm cells are a draft.
results = wb.evaluate(
    design, wb.Indenter("sphere", size_mm=6.0), press, settings=wb.ContactSettings(grid_mm=0.8)
)

# `reaction_N` has shape (frames, 3); this is its part along the outward normal of the target.
normal_N = results.contact.normal_N
depth_mm = press.depth_mm * np.arange(1, press.frames + 1) / press.frames
for depth, force in zip(depth_mm, normal_N, strict=True):
    print(f"{depth:5.2f} mm  {force:6.3f} N")

# The first image is at rest, then one for each frame: (frames + 1, H, W, 3), sRGB.
rest, pressed = results.images[0], results.images[-1]
cv2.imwrite(str(OUT / "rest.png"), rest[:, :, ::-1])
cv2.imwrite(str(OUT / "pressed.png"), pressed[:, :, ::-1])

# Hertz: force grows faster than depth (by its power 3/2 on a half space).
assert (np.diff(normal_N) > 0).all()
assert normal_N[-1] > 2 * normal_N[1]
assert np.abs(pressed.astype(int) - rest).max() > 10
