"""A membrane of your own, from an STL file: an egg, pressed on its side.

Shows: bodies from files, a ring of LEDs that has to fit, targets that go to the skin.
"""

from pathlib import Path

import cv2
import numpy as np
import trimesh

import workbench as wb

OUT = Path("out/examples/04_own_body")
OUT.mkdir(parents=True, exist_ok=True)

# Any closed body that stands on a flat foot; here half an egg of 30 x 30 x 24 mm.
egg = trimesh.creation.icosphere(subdivisions=4, radius=15.0)
egg.apply_scale((1.0, 1.0, 1.6))
egg = egg.slice_plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), cap=True)
egg.export(OUT / "egg.stl")

# The wall is `layers.elastomer_mm` everywhere; LEDs must stand inside what is left.
design = wb.load(OUT / "egg.stl", unit="mm").replace("optics.ring.radius_mm", 7.0)
design = design.replace("optics.light_model", "direct")

# A target need not be on the skin: it goes to the nearest place, and is refused beyond 5 mm.
results = wb.evaluate(
    design,
    wb.Indenter("cube", size_mm=5.0),
    wb.Press(target_mm=(12.0, 0.0, 12.0), depth_mm=0.8, frames=2),
    settings=wb.ContactSettings(grid_mm=0.8),
)
print(f"membrane of {results.solid.volume_mm3:.0f} mm3, {len(results.mesh.outer.faces)} triangles")
print(f"normal there: {np.round(results.contact.normal, 2)}")
cv2.imwrite(str(OUT / "pressed.png"), results.images[-1][:, :, ::-1])

# Outward is +x and up; the reaction pushes the cube out.
assert results.contact.normal[0] > 0.7
assert results.contact.normal_N[-1] > 0.1
