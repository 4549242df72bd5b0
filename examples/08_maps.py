"""Where a sensor is blind: how well each place of its skin is lit and seen.

Shows: maps of the skin, figures of a design without any press, cameras and LEDs changed.
"""

import numpy as np

import workbench as wb

design = wb.load("finger").replace("optics.light_model", "direct")
narrow = design.replace("optics.camera.fov_x_deg", 70.0)

seen = {}
for name, sensor in (("100 degrees", design), ("70 degrees", narrow)):
    results = wb.evaluate(sensor)
    results.compute("maps")
    figures = results.figures
    seen[name] = figures["skin_seen_percent"]
    print(f"{name}: sees {figures['skin_seen_percent']:.1f} % of the skin")

# A map has a value at each vertex of the skin; where nothing is seen there is none.
for skin_map in results.maps.maps:
    known = 100 * np.mean(np.isfinite(skin_map.values))
    print(f"{skin_map.name:24} [{skin_map.unit}] at {known:.0f} % of the vertices")

assert seen["70 degrees"] < seen["100 degrees"]
