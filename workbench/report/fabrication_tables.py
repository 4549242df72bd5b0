"""Tables of what is made, for `summary.json` and `export --json`: moulds, parts, checks, recipe."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import Any

from workbench.core.result.fabrication import (
    FabricationCheck,
    HousingSet,
    MouldSet,
    PartGroup,
    Recipe,
    Severity,
)
from workbench.core.result.results import Bundle


def mould_rows(moulds: MouldSet) -> list[dict[str, Any]]:
    """The mould's STL files as the summary lists them."""
    return [
        {
            "file": f"moulds/{part.name}.stl",
            "watertight": part.watertight,
            "volume_mm3": part.volume_mm3,
        }
        for part in moulds.parts
    ]


def part_rows(moulds: MouldSet, housing: HousingSet, package: Bundle) -> list[dict[str, Any]]:
    """The parts as `export --json` lists them: the volume of the mesh, and of its STEP file read
    back, which is None where a part has none."""
    from geometry.surface.surface import mesh_volume

    rows = [
        {
            "file": f"{'moulds' if part.group is PartGroup.MOULD else 'parts'}/{part.name}.stl",
            "watertight": part.watertight,
            "volume_mm3": mesh_volume(part.points_mm, part.faces),
            "step_volume_mm3": package.step_volumes_mm3.get(part.name),
        }
        for part in (*moulds.parts, *housing.parts)
    ]
    return plain_numbers(rows)


def fabrication_tables(moulds: MouldSet, housing: HousingSet, recipe: Recipe) -> dict[str, Any]:
    """The tables `moulds`, `parts`, `checks` and `recipe` of the summary."""
    return {
        "moulds": mould_rows(moulds),
        "parts": [
            {
                "file": f"{'moulds' if part.group is PartGroup.MOULD else 'parts'}/{part.name}.stl",
                "group": str(part.group),
                "watertight": part.watertight,
                "volume_mm3": part.volume_mm3,
                "process": part.process,
            }
            for part in (*moulds.parts, *housing.parts)
        ],
        "checks": check_rows(all_checks(moulds, housing, recipe)),
        "recipe": _plain(recipe),
    }


def all_checks(
    moulds: MouldSet, housing: HousingSet, recipe: Recipe
) -> tuple[FabricationCheck, ...]:
    """Every check of what is made, the worst first."""
    order = (Severity.BAD, Severity.WARNING, Severity.GOOD)
    found = (*moulds.checks, *housing.checks, *recipe.checks)
    return tuple(sorted(found, key=lambda check: order.index(check.severity)))


def check_rows(checks: Sequence[FabricationCheck]) -> list[dict[str, Any]]:
    """Checks as `summary.json` and `export --json` list them."""
    return [_plain(check) for check in checks]


def _plain(value: FabricationCheck | Recipe) -> dict[str, Any]:
    return plain_numbers(dataclasses.asdict(value))


def plain_numbers(value: Any) -> Any:
    """Tables and lists with None for what is not finite: JSON has no infinity and no NaN.

    A part without any wall to measure has none to report.
    """
    if isinstance(value, dict):
        return {name: plain_numbers(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain_numbers(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
