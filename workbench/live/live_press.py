"""What is shown while the designer drags: one settled frame and its image, computed in a lane.

A `LiveCall` is a `workbench.live.preview_call`. The lane keeps the last press
(`sim.contact.live_contact`) and the scene of the last image, for requests like the one before.
"""

from __future__ import annotations

import dataclasses
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.optics.field.model import baked_model, model_of
from sim.optics.studio.fitted_photos import fitted_photos
from workbench.core.base.digest import digest
from workbench.core.base.monitor import Monitor
from workbench.core.design.design import Elastomer, SensorDesign
from workbench.core.design.lighting import Baking
from workbench.core.design.optics import Optics
from workbench.core.press.indenter import Indenter
from workbench.core.press.motion import Mover
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.sensing import Contact
from workbench.live.kept_studio import KeptStudio
from workbench.pipeline.stage import Ref
from workbench.pipeline.store import Store
from workbench.pipeline.surface_detail import detailed
from workbench.planning.planned import planned

if TYPE_CHECKING:
    from sim.contact.live_contact import LiveContact

NEEDED = ("mesh", "lattice", "bake", "table")
"""Stages that must be stored before a live call; the last only of models that have it."""
WIDEST_PX = 320
"""Width of a preview's image: that of the page's dock."""
FEWEST_PX = 16
"""Least width and height of a camera."""


@dataclass(frozen=True, kw_only=True, slots=True)
class LiveCall:
    """One live press."""

    mesh: Ref
    points: Ref
    light: Ref
    table: Ref | None
    material: Elastomer
    optics: Optics
    indenter: Indenter
    press: Press
    settings: ContactSettings

    @property
    def lane(self) -> str:
        """The worker that answers it."""
        return "sim"

    @property
    def stage(self) -> str:
        """What messages call it."""
        return "live press"

    @property
    def needs(self) -> tuple[str, ...]:
        """Stages that must be stored before."""
        return NEEDED

    def answer(self, store: Store, kept: dict[str, Any], monitor: Monitor) -> PressPreview:
        """Press and look, going on from the last press of this process."""
        previewer: PressPreviewer = kept.setdefault(self.stage, PressPreviewer())
        return previewer.answer(store, self, monitor)

    @property
    def key(self) -> str:
        """Equal for calls that differ in nothing but where and how far the object is pressed."""
        return digest((self.mesh, self.points, self.material, self.indenter, self.settings))


@dataclass(frozen=True, kw_only=True, slots=True)
class PressPreview:
    """The settled frame of a live press."""

    contact: Contact
    """One frame."""
    images: np.ndarray
    """Background and image, shape (2, H, W, 3), uint8, at most `WIDEST_PX` wide."""
    seconds: float
    """Time from the call to the answer [s]."""
    words: str
    """How it was reached."""


def live_press(press: Press) -> Press:
    """What a live press shows of a press: approach, shear and twist, in as few frames as go."""
    return dataclasses.replace(
        press,
        frames=1,
        strokes=(),
        actuations=(),
        trajectory=None,
        object_pose=None,
        mover=Mover.OBJECT,
    )


def live_design(design: SensorDesign) -> SensorDesign:
    """The design that a live press shows: nobody waits for photons while dragging."""
    if not model_of(design.optics.light_model).per_frame:
        return design
    baking = design.optics.baking
    fewer = dataclasses.replace(baking, photons=min(baking.photons, Baking().photons))
    baked = design.replace("optics.light_model", baked_model())
    return baked.replace("optics.baking", fewer)


def live_call(design: SensorDesign, case: PressCase) -> LiveCall:
    """The live press of a state.

    Raises:
        DesignError: As `plan`.
    """
    design = live_design(design)
    calls = planned(design, case)
    mesh, points, light = (calls[name].ref for name in NEEDED[:3])
    return LiveCall(
        mesh=mesh,
        points=points,
        light=light,
        table=calls["table"].ref if "table" in calls else None,
        material=design.material,
        optics=design.optics,
        indenter=case.indenter,
        press=live_press(case.press),
        settings=case.settings,
    )


class PressPreviewer:
    """Answers live calls in one process, and keeps what the next one may need."""

    def __init__(self) -> None:
        self._live: LiveContact | None = None
        self._studio = KeptStudio()

    def answer(self, store: Store, call: LiveCall, monitor: Monitor) -> PressPreview:
        """Press and look.

        Raises:
            WorkbenchError: Whatever placing, solving or rendering raises.
        """
        from workbench.pipeline.devices import open_device

        begun = time.perf_counter()
        open_device()
        from sim.contact.live_contact import LiveContact
        from sim.optics.studio.detail import open_detail

        if self._live is None:
            self._live = LiveContact()
        mesh = store.load(call.mesh.stage, call.mesh.key)
        contact = self._live.press(
            mesh,
            store.load(call.points.stage, call.points.key),
            call.material,
            PressCase(indenter=call.indenter, press=call.press, settings=call.settings),
            key=call.key,
            monitor=monitor,
        )
        optics = small(call.optics)
        studio = self._studio.open(store, mesh, call.light, call.table, optics)
        shown = detailed(call.optics, call.indenter, call.settings)
        young_MPa, poisson = call.material.young_MPa, call.material.poisson
        detail = open_detail(shown, mesh, contact, young_MPa=young_MPa, poisson=poisson)
        images = studio.shoot(mesh.seen_displacement_mm(contact), detail=detail).rgb
        seconds = time.perf_counter() - begun
        return PressPreview(
            contact=contact,
            images=images,
            seconds=seconds,
            words=f"settled in {seconds:.2f} s ({self._live.way})",
        )


def small(optics: Optics, widest_px: int = WIDEST_PX) -> Optics:
    """The same optics with no more pixels across than the page shows."""
    camera = optics.camera
    share = min(1.0, widest_px / camera.width_px)
    width_px, height_px = (
        max(FEWEST_PX, round(share * count)) for count in (camera.width_px, camera.height_px)
    )
    reduced = dataclasses.replace(camera, width_px=width_px, height_px=height_px)
    return fitted_photos(dataclasses.replace(optics, camera=reduced, cameras=()))
