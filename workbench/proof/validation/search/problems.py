"""Two real problems for samplers to be compared on, each with two goals that pull apart.

*light*: a finger, 6 optical parameters, light evenness and normal resolvability; nothing blown out,
room for the LEDs. *mixed*: a pad, 8 parameters of shape, gel and optics, a whole number and a
choice among them; sensitivity to .1 N and the force at the press's depth, castable. Both begin with
a preset and are judged by the draft settings of a search. Ranges are our choice: what can be bought
and printed, and what the design takes.
"""

from __future__ import annotations

from pathlib import Path

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import suggest
from workbench.project.project import Project
from workbench.search.problem import Problem
from workbench.search.problem_file import read_problem

LIGHT, MIXED = "light", "mixed"
TITLES = {
    LIGHT: "light of the finger, 6 optical parameters",
    MIXED: "pad, 8 parameters of shape, gel and optics",
}
"""Of the problems, for people."""
TEXTS = {
    LIGHT: """
base = "geltip"

[[vary]]
field = "design.optics.ring.tilt_deg"
low = -60.0
high = 60.0

[[vary]]
field = "design.optics.ring.height_mm"
low = 0.3
high = 4.0

[[vary]]
field = "design.optics.ring.emission_exponent"
low = 1.0
high = 8.0

[[vary]]
field = "design.optics.coating.albedo"
low = 0.05
high = 0.6

[[vary]]
field = "design.optics.coating.specular"
low = 0.04
high = 0.6

[[vary]]
field = "design.optics.coating.roughness"
low = 0.1
high = 0.6

[[goal]]
figure = "light_evenness_p5_over_p95_1"
want = "max"

[[goal]]
figure = "normal_resolvability_median_per_deg"
want = "max"

[[limit]]
figure = "overexposed_percent"
at_most = 2.0

[[limit]]
figure = "checks_bad"
at_most = 0.0
""",
    MIXED: """
base = "pad"
wishes = ["feels .1 N"]

[[vary]]
field = "design.shape.dome_mm"
low = 0.0
high = 2.0

[[vary]]
field = "design.layers.elastomer_mm"
low = 2.0
high = 5.0

[[vary]]
field = "design.material.young_MPa"
low = 0.05
high = 0.5
log = true

[[vary]]
field = "design.optics.ring.count"
low = 6
high = 18

[[vary]]
field = "design.optics.ring.tilt_deg"
low = -80.0
high = -20.0

[[vary]]
field = "design.optics.ring.colours"
choices = [["#ff0000", "#00ff00", "#0000ff"], ["#ffffff"]]

[[vary]]
field = "design.optics.coating.albedo"
low = 0.05
high = 0.6

[[vary]]
field = "design.optics.coating.roughness"
low = 0.1
high = 0.6
""",
}
"""As files of a search."""


def problem_of(name: str, project: Project) -> Problem:
    """The problem of that name.

    Raises:
        DesignError: If there is none.
    """
    if name not in TEXTS:
        raise DesignError(
            f"there is no problem {shown(name)}", hint=suggest(name, TEXTS), at="problem"
        )
    return read_problem(TEXTS[name], project, folder=Path())
