"""An object with a raised letter: pressed flat, and its mark found in the depth map.

Shows: objects by name or file, textures, depth maps of the camera.
"""

from pathlib import Path

import cv2
import numpy as np

import workbench as wb

OUT = Path("out/examples/05_own_object")
OUT.mkdir(parents=True, exist_ok=True)

# The end of a cylinder of 9 mm with an R of 0.4 mm height; a name may also be an STL or STEP file.
stamp = wb.choose_indenter("cylinder", size_mm=9.0, texture="letters=R:0.4:5")
design = wb.load("pad").replace("optics.light_model", "direct")
results = wb.evaluate(
    design, stamp, wb.Press(depth_mm=0.4, frames=1), settings=wb.ContactSettings(grid_mm=0.6)
)

# How far each pixel's skin came toward the camera [mm]; NaN where it sees no skin.
depth_mm = results.shot.frames.depth_z_mm
pushed_mm = np.nan_to_num(depth_mm[0] - depth_mm[-1])
print(f"deepest {pushed_mm.max():.2f} mm, {100 * (pushed_mm > 0.1).mean():.1f} % of the image")
grey = np.clip(255 * pushed_mm / pushed_mm.max(), 0, 255).astype(np.uint8)
cv2.imwrite(str(OUT / "letter_depth.png"), grey)
cv2.imwrite(str(OUT / "letter.png"), results.images[-1][:, :, ::-1])

assert 0.1 < pushed_mm.max() < 0.6
assert 0.001 < (pushed_mm > 0.1).mean() < 0.5
