"""The same press under three light models, side by side.

Shows: light models of the paper and ours, what is stored and what is computed again.
"""

from pathlib import Path

import cv2
import numpy as np

import workbench as wb

OUT = Path("out/examples/02_light")
OUT.mkdir(parents=True, exist_ok=True)
DRAFT = wb.ContactSettings(grid_mm=0.8)

base = wb.load("geltip")
press = wb.Press(depth_mm=1.0, frames=2)
ball = wb.Indenter("sphere", size_mm=6.0)

# `linear`: the paper's, light on straight lines and Phong's reflection.
# `direct`: distance, lobe of the LEDs, shadows of the dent. `hybrid`: that over traced photons.
images = {}
for model in ("linear", "direct", "hybrid"):
    results = wb.evaluate(base.replace("optics.light_model", model), ball, press, settings=DRAFT)
    images[model] = results.images[-1]
    cached = {outcome.stage: outcome.cached for outcome in results.outcomes}
    # Mesh and contact do not depend on light: their keys are the same, so they are only read.
    print(f"{model:7} mean {images[model].mean():5.1f}  contact read from store: {cached['press']}")

strip = np.hstack(list(images.values()))
cv2.imwrite(str(OUT / "linear_direct_hybrid.png"), strip[:, :, ::-1])

assert cached["press"], "the third model found the contact of the first"
assert np.abs(images["linear"].astype(int) - images["hybrid"]).mean() > 1.0
