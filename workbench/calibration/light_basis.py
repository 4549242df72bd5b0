"""Images of each light alone, of power 1: what a fit of powers and colours is linear in.

Three lights are traced at a time, one in each colour, so a bake of the design answers for three.
Images are sampled: of the sensor at rest everywhere, of each press in the box of its contact.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim.optics.raster.image_sensor import kept_light
from workbench.calibration.ball_presses import BallPress
from workbench.calibration.light_sources import NO_RING
from workbench.calibration.lit_studio import lit_studio
from workbench.calibration.photo_set import Circle
from workbench.core.base.monitor import Monitor, part
from workbench.core.design.design import SensorDesign
from workbench.core.design.lighting import Ambient, Baking, Lamp
from workbench.core.design.optics import BEST, Optics
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.store import Store

BOX = 1.45
"""Half width of a contact's box over the radius of its circle [1]."""
PIXELS = 2500
"""Of a contact that are sampled, and of the image at rest, at most about."""
LEVELS = 5
"""Depths at which a press of unknown depth is drawn."""
PHOTONS = 1_000_000
"""Of a bake of three lights; what is fitted is smooth over the image."""
PRIMARIES = ("#ff0000", "#00ff00", "#0000ff")


@dataclass(frozen=True, kw_only=True, slots=True)
class PressSamples:
    """One press in the light of each of L lights."""

    pixel: np.ndarray
    """Numbers of the sampled pixels, row by row of an even grid, shape (N,)."""
    depths_mm: np.ndarray
    """Shape (D,)."""
    change: np.ndarray
    """Of the light on the image sensor, shape (D, N, L), float32."""

    def at(self, depth_mm: float) -> np.ndarray:
        """Change of light at a depth [mm], shape (N, L)."""
        if len(self.depths_mm) == 1:
            return self.change[0]
        place = float(np.interp(depth_mm, self.depths_mm, np.arange(len(self.depths_mm))))
        low = min(int(place), len(self.depths_mm) - 2)
        share = np.float32(place - low)
        return (np.float32(1.0) - share) * self.change[low] + share * self.change[low + 1]


@dataclass(frozen=True, kw_only=True, slots=True)
class LightBasis:
    """All that a fit reads."""

    lights: tuple[Lamp, ...]
    rest_pixel: np.ndarray
    """Sampled pixels at rest that see the skin, shape (N,)."""
    rest: np.ndarray
    """Light on the image sensor at rest, shape (N, L), float32."""
    ambient: np.ndarray
    """The same of ambient light of power 1, shape (N,), float32."""
    presses: tuple[PressSamples, ...]

    def only(self, chosen: np.ndarray) -> LightBasis:
        """The basis of some of the lights, by their numbers."""
        return dataclasses.replace(
            self,
            lights=tuple(self.lights[number] for number in chosen),
            rest=self.rest[:, chosen],
            presses=tuple(
                dataclasses.replace(each, change=each.change[:, :, chosen]) for each in self.presses
            ),
        )


def contact_box(circle: Circle, width: int, height: int) -> tuple[slice, slice]:
    """Rows and columns of the box about a contact, inside the image."""
    half = BOX * circle.radius_px
    rows = max(0, int(circle.row_px - half)), min(height, int(circle.row_px + half) + 1)
    columns = max(0, int(circle.column_px - half)), min(width, int(circle.column_px + half) + 1)
    return slice(*rows), slice(*columns)


def sampled(rows: slice, columns: slice, width: int) -> np.ndarray:
    """Numbers of about `PIXELS` pixels evenly over a box, shape (N,)."""
    count = (rows.stop - rows.start) * (columns.stop - columns.start)
    step = max(1, round(np.sqrt(count / PIXELS)))
    row = np.arange(rows.start, rows.stop, step)
    column = np.arange(columns.start, columns.stop, step)
    return (row[:, None] * width + column).ravel()


def open_basis(
    design: SensorDesign,
    mesh: MembraneMesh,
    lights: Sequence[Lamp],
    presses: Sequence[tuple[BallPress, Circle]],
    store: Store,
    monitor: Monitor,
) -> LightBasis:
    """Trace and draw every light alone.

    Raises:
        WorkbenchError: From the stages that trace.
    """
    camera = design.optics.camera
    width, height = camera.width_px, camera.height_px
    pixels = [sampled(*contact_box(circle, width, height), width) for _, circle in presses]
    depths = [_levels(press) for press, _ in presses]
    rest_pixel = sampled(slice(0, height), slice(0, width), width)
    rest: list[np.ndarray] = []
    ambient = np.zeros(0)
    changes: list[list[np.ndarray]] = [[] for _ in presses]
    keep = kept_light(camera).reshape(-1, 1)
    for first in range(0, len(lights), 3):
        span = part(monitor, first / len(lights), min(first + 3, len(lights)) / len(lights))
        group = lights[first : first + 3]
        note = f"lights {first + 1} to {first + len(group)} of {len(lights)}"
        studio = lit_studio(_in_light_of(design, group), mesh, store, part(span, 0.0, 0.7), note)
        back = studio.imager.backdrop
        lit = studio.imager.shader.lit.ambient.mean() * studio.rays.transmittance[:, None]
        glow = keep * lit * (back.background.max(axis=1, keepdims=True) > 0.0)
        whole = keep * back.background[:, : len(group)] - glow
        rest.append(whole[rest_pixel])
        ambient = glow[:, 0]
        for number, (press, _) in enumerate(presses):
            span(0.7 + 0.3 * number / len(presses), f"{note}: {press.photo.name}")
            moved = np.stack([press.displaced_mm(depth) for depth in depths[number]])
            drawn = studio.linear(moved).reshape(len(moved), -1, 3)[..., : len(group)]
            at = pixels[number]
            changes[number].append(keep[at] * drawn[:, at] - whole[at] - glow[at])
    monitor(1.0, "lights drawn")
    return LightBasis(
        lights=tuple(lights),
        rest_pixel=rest_pixel,
        rest=np.concatenate(rest, axis=1).astype(np.float32),
        ambient=ambient[rest_pixel].astype(np.float32),
        presses=tuple(
            PressSamples(
                pixel=pixels[number],
                depths_mm=depths[number],
                change=np.concatenate(changes[number], axis=2).astype(np.float32),
            )
            for number in range(len(presses))
        ),
    )


def _levels(press: BallPress) -> np.ndarray:
    """Depths at which a press is drawn [mm]."""
    if press.most_mm - press.least_mm < 1e-6:
        return np.array([press.most_mm])
    return np.linspace(press.least_mm, press.most_mm, LEVELS)


def _in_light_of(design: SensorDesign, group: Sequence[Lamp]) -> SensorDesign:
    """The design in the light of up to three lights, one in each colour."""
    lamps = tuple(
        dataclasses.replace(lamp, colour=colour)
        for lamp, colour in zip(group, PRIMARIES, strict=False)
    )
    return dataclasses.replace(design, optics=plain_optics(design.optics, lamps))


def plain_optics(optics: Optics, lamps: tuple[Lamp, ...]) -> Optics:
    """The design's optics in other light, without photograph, ink and further cameras."""
    return dataclasses.replace(
        optics,
        ring=NO_RING,
        lamps=lamps,
        cameras=(),
        ambient=Ambient(power=1.0),
        background=None,
        unit=None,
        light_model=BEST,
        baking=Baking(photons=PHOTONS, seed=optics.baking.seed),
        markers=dataclasses.replace(optics.markers, visible=False),
    )
