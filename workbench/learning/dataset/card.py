"""The data card: what a data set holds, how it was made, and what it must not be trusted for."""

from __future__ import annotations

from collections import Counter
from typing import Any

from workbench.core.press.fem import QUALITY_MM
from workbench.learning.dataset.agreement import agreement
from workbench.learning.dataset.cases import Split
from workbench.learning.dataset.estimate import estimate, estimate_text
from workbench.learning.dataset.folder import TIMES, DataSet
from workbench.learning.dataset.json_lines import read_rows

FIELDS = """\
Forces act on the skin, displacements are from rest, in the sensor frame; mm, N, MPa. Vertices are
those of `skin.npz`; only those that moved by more than 1e-6 mm, carry force or slide are stored.

| entry of `cases/ID/000.npz` | meaning |
|---|---|
| `head` | JSON: case, frame, shape label, depth, shear, pose (x, y, z, qw, qx, qy, qz), target, \
normal, U; of each solver reaction, tangential force, residual, balance, converged, seconds, share \
of the contact's area that slides |
| `mpm.index`, `fem.index` | vertices of the rows below |
| `mpm.displacement_mm`, `fem.displacement_mm` | displacement, (n, 3), float32 |
| `mpm.contact_force_N`, `fem.contact_force_N` | nodal force of the object, (n, 3), float32 |
| `mpm.sliding`, `fem.sliding` | whether most of the contact around it slides, (n,) |
| `fem.cauchy_MPa` | Cauchy stress xx, yy, zz, xy, yz, zx, (n, 6), float32 |
| `png`, `png_markers` | PNG files of the image without and with markers |
| `markers_px` | u, v of the markers [px], (M, 2), float32; NaN of those out of sight |

The frames of a case in order are a tactile sequence. Frames before `first_new` of a case repeat
states of an earlier one with the same object and place: leave them out where each state shall
count once (`DataSet.samples` does).
"""


def card_text(data: DataSet) -> str:
    """The card of a data set, in Markdown.

    Raises:
        StoreError: If a sample that it looks at is damaged.
    """
    recipe, counts = data.manifest["recipe"], data.manifest["counts"]
    left = counts["samples"] - counts["samples_done"]
    cost = estimate_text(estimate(read_rows(data.folder / TIMES), left))
    sections = [
        f"# Data set {data.folder.name}",
        f"{counts['samples_done']:,} of {counts['samples']:,} samples of {counts['cases']:,} cases "
        f"({counts['cases_done']:,} complete, {counts['cases_failed']:,} failed); "
        f"{counts['samples_distinct']:,} distinct states.",
        f"Made by sensor-workbench {data.manifest['program']}, format {data.manifest['format']}, "
        f"recipe {data.key}.",
        "## What was pressed",
        _recipe_words(recipe),
        "## Splits",
        "Training, validation and test share pairs of object and place 3:1:1; all presses of a "
        "pair stay together. Objects that the paper's networks did not see are apart.",
        _split_table(data),
        "## Which presses",
        "A subset of N cases is the first N of one shuffled order (seed "
        f"{recipe['seed']}) in which any beginning holds every object, and every place, equally "
        "often to within one. This rule is ours: the paper does not say which it kept.",
        "## Fields",
        FIELDS.rstrip(),
        "## How far the solvers are apart",
        found.text if (found := agreement(data)) else "Not known: no sample has both.",
        "## Limits",
        _limits(recipe),
        "## Failed cases",
        _failed_list(data),
        "## Cost",
        cost,
    ]
    return "\n\n".join(sections) + "\n"


def _recipe_words(recipe: dict[str, Any]) -> str:
    design = recipe["design"]
    shear = f"{recipe['shear_directions']} directions of {recipe['shear_mm']:g} mm along U and V"
    rows = [
        f"- design: {design.get('name', '')} (family {design.get('family', '')}), "
        f"E {design['material']['young_MPa']:g} MPa, Poisson ratio "
        f"{design['material']['poisson']:g}, friction {_friction_words(design['material'])}",
        f"- pattern {recipe['pattern']}, objects of {recipe['size_mm']:g} mm: "
        f"{', '.join(recipe['indenters'])}",
        *_ranges(recipe.get("vary", {})),
        f"- depth to {recipe['depth_mm']:g} mm by {recipe['depth_step_mm']:g} mm; shear: "
        + (shear if recipe["shear_directions"] else "none"),
        f"- solvers: {recipe['solvers']}; hexahedra of {recipe['hex_mm']:g} mm, contact grid of "
        f"{recipe['grid_mm']:g} mm; images: {'yes' if recipe['images'] else 'no'}",
    ]
    return "\n".join(rows)


def _friction_words(material: dict[str, Any]) -> str:
    static, kinetic = material["friction"], material.get("kinetic_friction")
    return f"{static:g}" if kinetic is None else f"{static:g}, kinetic {kinetic:g}"


def _ranges(vary: dict[str, Any]) -> list[str]:
    """What each case draws, in words; nothing where nothing varies."""
    looks = vary.get("looks", {}).get("count", 0)
    drawn = [f"{name} {low:g} to {high:g}" for name, (low, high) in _pairs(vary)]
    drawn += [f"{looks} built sensors"] if looks else []
    return [f"- drawn for each case: {', '.join(drawn)}"] if drawn else []


def _pairs(vary: dict[str, Any]) -> list[tuple[str, tuple[float, float]]]:
    return [(name, (value[0], value[1])) for name, value in vary.items() if name != "looks"]


def _split_table(data: DataSet) -> str:
    cases = Counter(case.split for case in data.cases())
    rows = ["| split | cases | samples done |", "|---|---|---|"]
    done = data.manifest["counts"]["samples_by_split"]
    rows += [f"| {s.value} | {cases[s]} | {done[s.value]} |" for s in Split]
    return "\n".join(rows)


def _limits(recipe: dict[str, Any]) -> str:
    lines = [
        "- Finite elements are cut off 12 mm from the contact (plus shear): farther vertices are "
        "at rest by construction. The contact solver's region is smaller still.",
        "- Images show the displacement of the contact solver, or of the finite elements where "
        "they are alone, on the skin of these hexahedra.",
        "- The sizes and edge radii of objects are ours; the paper gives none.",
    ]
    if recipe["hex_mm"] > QUALITY_MM + 1e-9:
        lines.insert(
            0,
            f"- **Draft mesh**: hexahedra of {recipe['hex_mm']:g} mm instead of {QUALITY_MM:g} mm. "
            "At 0.9 mm forces of the finite elements are up to 3.5 % too high on balls and cones, "
            "and vertices beside a ball lie up to 0.14 mm off it: faces touch, not corners.",
        )
    return "\n".join(lines)


def _failed_list(data: DataSet) -> str:
    rows = [f"- `{name}`: {row['message']}" for name, row in data.failed().items()]
    return "\n".join(rows) or "None."
