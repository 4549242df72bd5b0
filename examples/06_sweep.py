"""A softer or a thicker skin: force at the same depth, in steps of one parameter.

Shows: sweeps with stored results, figures by name, two designs compared.
"""

import workbench as wb

base = wb.evaluate(
    wb.load("finger").replace("optics.light_model", "direct"),
    wb.Indenter("sphere", size_mm=6.0),
    wb.Press(depth_mm=0.8, frames=2),
    settings=wb.ContactSettings(grid_mm=0.8),
)

# Any number of design or press. Asked for again, points that are stored cost nothing.
wall = wb.sweep(base, "layers.elastomer_mm", 1.5, 3.0, steps=3)
for point in wall.points:
    figures = point.figures
    print(f"wall {point.value:.2f} mm: {figures['peak_normal_force_N']:.2f} N, {point.status}")

# The same at two moduli: statics is linear in E, so twice the modulus is twice the force.
stiff = wb.evaluate(
    base.design.replace("material.young_MPa", 2 * base.design.material.young_MPa),
    base.case.indenter,
    base.case.press,
    settings=base.case.settings,
)
for change in wb.compare(base, stiff, stages=("shoot",)):
    if change.verdict in ("better", "worse") and change.percent is not None:
        print(f"{change.rule.label}: {change.percent:+.0f} %, {change.verdict}")

forces_N = [point.figures["peak_normal_force_N"] for point in wall.points]
assert forces_N[0] > forces_N[-1], "a thin wall over its support is the stiffer one"
assert abs(stiff.contact.normal_N[-1] / base.contact.normal_N[-1] - 2.0) < 0.02
