"""The stage `press`: quasi-static contact along the path of an object, by material points."""

from __future__ import annotations

from dataclasses import dataclass, field

from workbench.core.base.digest import at_defaults
from workbench.core.base.monitor import Monitor
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MaterialPoints, MembraneMesh
from workbench.core.result.sampled import SampledDistance
from workbench.core.result.sensing import Contact
from workbench.pipeline.devices import start_device
from workbench.pipeline.stage import IF_GIVEN, Chain, Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class PressInputs:
    """What a contact depends on."""

    mesh: MembraneMesh
    points: MaterialPoints
    material: Elastomer
    indenter: Indenter
    path: Press
    settings: ContactSettings
    sampled: SampledDistance | None = field(default=None, metadata=IF_GIVEN)
    """The object's distance, if known."""


def inputs(chain: Chain) -> PressInputs:
    """The membrane, its points, the object and its path."""
    case = chain.case
    return PressInputs(
        mesh=chain.result("mesh"),
        points=chain.result("lattice"),
        material=elastic(chain.design.material),
        indenter=case.indenter,
        path=case.press,
        settings=case.settings,
        sampled=chain.result("object"),
    )


def elastic(material: Elastomer) -> Elastomer:
    """A material without what statics do not read."""
    return at_defaults(material, "density_g_cm3")


def press(given: PressInputs, *, monitor: Monitor) -> Contact:
    """Contact along the path."""
    start_device(monitor)
    from sim.contact.press import press_membrane

    return press_membrane(
        given.mesh,
        given.points,
        given.material,
        PressCase(indenter=given.indenter, press=given.path, settings=given.settings),
        sampled=given.sampled,
        monitor=monitor,
    )


STAGE = Stage(
    name="press",
    label="Contact",
    version=13,
    place=7,
    lane="sim",
    run=press,
    inputs=inputs,
    in_run=True,
    on_strip=True,
    heavy=True,
)
