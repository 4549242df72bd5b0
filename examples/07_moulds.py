"""A mould to print: its parts, how it opens, and what a printer could not make.

Shows: fabrication without a press, checks with value and limit, files for the workshop.
"""

from pathlib import Path

import trimesh

import workbench as wb

OUT = Path("out/examples/07_moulds")

results = wb.evaluate(wb.load("finger").replace("layers.elastomer_mm", 2.5))
moulds = results.moulds
for part in moulds.parts:
    print(f"{part.name:8} {part.volume_mm3 / 1000:6.1f} ml, {len(part.faces)} triangles")
for number, motion in enumerate(moulds.motions, 1):
    way = ", ".join(f"{part:.0f}" for part in motion.direction)
    print(f"{number}. pull {motion.part} along ({way}) by {motion.distance_mm:.0f} mm")
bad = [check for check in moulds.checks if check.severity.value == "bad"]
print(f"{len(moulds.checks)} checks, {len(bad)} red")

# STL, STEP and 3MF of every part, assemblies, build sheet, parts list.
package = results["package"]
for name, data in package.files.items():
    path = OUT / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data.tobytes())
print(f"{len(package.files)} files in {OUT}")

# Read back by another program: closed, and of the volume that was meant.
half = trimesh.load_mesh(OUT / "moulds" / "half_a.stl")
meant_mm3 = next(part.volume_mm3 for part in moulds.parts if part.name == "half_a")
assert half.is_watertight
assert abs(half.volume / meant_mm3 - 1.0) < 1e-3
assert not bad
