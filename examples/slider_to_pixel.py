"""From one number of a design to one grey value, step by step, with the equations.

Shows: what the stages compute, one call each; private modules, to be read rather than relied on.
The way through the browser is in docs/architecture.md; here it is without browser or store.
"""

import numpy as np

import workbench as wb
from geometry.volume.hexmesh import mesh_membrane
from geometry.volume.lattice import material_points
from sim.contact.press import press_membrane
from sim.optics.field.bake import bake_light
from sim.optics.studio.render import Studio
from workbench.core.design.lighting import LightModel
from workbench.core.press.press_case import PressCase
from workbench.pipeline.devices import open_device

open_device()
# The slider: half a millimetre less of wall.
design = wb.load("finger").replace("layers.elastomer_mm", 1.5)

# 1 Body. The membrane is what lies between two surfaces of revolution, elastomer_mm apart.
solid = wb.evaluate(design).solid

# 2 Mesh. Hexahedra through the wall; their outer and inner sides are the skins, V vertices each.
mesh = mesh_membrane(solid, design.meshing)

# 3 Light. At a vertex T of the skin, from an LED at S of power P whose axis leans by a:
#   E = P cos(a)^m / r^2, r = |S - T|, along L = (S - T) / r, shadowed by the body.
ring, camera = design.optics.ring, design.optics.camera
light = bake_light(mesh, ring, design.optics.lamps, model=LightModel("direct"))

# 4 Contact. Material points at x carry F = 1 + grad u. Equilibrium: sum over points of
#   vol P(F) grad(weight) = contact forces, P = dW/dF of a compressible neo-Hookean W, with normal
#   pressure where the object's signed distance is negative and Coulomb's cone |t| <= mu p.
points = material_points(solid.membrane, 0.8)
press = wb.Press(target_mm=(0.0, 10.0, 35.0), depth_mm=1.0, frames=2)
ball, settings = wb.Indenter("sphere", size_mm=6.0), wb.ContactSettings(grid_mm=0.8)
contact = press_membrane(
    mesh, points, design.material, PressCase(indenter=ball, press=press, settings=settings)
)

# 5 Image. The moved skin is drawn into the camera: pixel = f (x/z, y/z) + centre after Snell's law
#   at the clear wall. Radiance of matte and glossy coating (GGX), summed over the LEDs:
#   I = sum of (rho (1 - F0) / pi + D G F) E (L . N), with N the moved normal.
optics = design.replace("optics.light_model", "direct").optics
studio = Studio(mesh, light, optics, camera=camera)
frames = studio.shoot(mesh.seen_displacement_mm(contact))

# 6 Grey value: display = exposure I on the curve of sRGB, to 8 bits; one exposure per design.
change = np.abs(frames.rgb[-1].astype(int) - frames.rgb[0]).sum(axis=2)
row, column = np.unravel_index(change.argmax(), change.shape)
before, after = frames.rgb[0, row, column], frames.rgb[-1, row, column]
print(f"wall {design.layers.elastomer_mm} mm, {contact.normal_N[-1]:.2f} N")
print(f"pixel ({column}, {row}) goes from {before.tolist()} to {after.tolist()}")

# The pixel that changes most is one that sees moved skin.
assert frames.moved[-1, row, column]
# Step by step is what the front door does in one call: the same forces, bit by bit.
same = wb.evaluate(design, ball, press, settings=settings)
np.testing.assert_array_equal(same.contact.reaction_N, contact.reaction_N)
