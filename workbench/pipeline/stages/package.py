"""The stage `package`: every part as STL, STEP and 3MF, assemblies, build sheet and parts list."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.monitor import Monitor
from workbench.core.result.fabrication import HousingSet, MouldSet, Recipe, SheetHead
from workbench.core.result.results import Bundle
from workbench.pipeline.stage import Chain, Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class PackageInputs:
    """What the files of a sensor depend on."""

    moulds: MouldSet
    housing: HousingSet
    recipe: Recipe
    name: str
    family: str
    shrink_percent: float
    draft_deg: float


def inputs(chain: Chain) -> PackageInputs:
    """All parts, and the head of the build sheet."""
    design = chain.design
    return PackageInputs(
        moulds=chain.result("mould"),
        housing=chain.result("housing"),
        recipe=chain.result("recipe"),
        name=design.name,
        family=design.family,
        shrink_percent=design.mould.shrink_percent,
        draft_deg=design.mould.draft_deg,
    )


def package(given: PackageInputs, *, monitor: Monitor) -> Bundle:
    """The files."""
    from geometry.workshop.export import package_files

    head = SheetHead(
        name=given.name,
        family=given.family,
        shrink_percent=given.shrink_percent,
        draft_deg=given.draft_deg,
    )
    return package_files(given.moulds, given.housing, given.recipe, head, monitor=monitor)


STAGE = Stage(
    name="package",
    label="Files",
    version=5,
    place=17,
    lane="cad",
    run=package,
    inputs=inputs,
    in_run=True,
)
