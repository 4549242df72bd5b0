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
from workbench.calibration.seen.photo_set import Circle
from workbench.calibration.stored import lit_studio
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
    step = _step(count)
    row = np.arange(rows.start, rows.stop, step)
    column = np.arange(columns.start, columns.stop, step)
    return (row[:, None] * width + column).ravel()


def around(light: np.ndarray, width: int) -> np.ndarray:
    """Light of all pixels (H W, C) averaged over what a sample at rest stands for, same shape.

    So edges of the skin move the samples beside them smoothly.
    """
    import cv2

    image = light.reshape(-1, width, light.shape[1])
    step = _step(image.shape[0] * width)
    kept = cv2.blur(image, (step, step), borderType=cv2.BORDER_REPLICATE)
    return kept.reshape(light.shape)


def _step(pixels: int) -> int:
    """Pixels from sample to sample."""
    return max(1, round(float(np.sqrt(pixels / PIXELS))))


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
    parts = []
    for first in range(0, len(lights), 3):
        group = lights[first : first + 3]
        span = part(monitor, first / len(lights), (first + len(group)) / len(lights))
        note = f"lights {first + 1} to {first + len(group)} of {len(lights)}"
        lamps = tuple(
            dataclasses.replace(lamp, colour=colour)
            for lamp, colour in zip(group, PRIMARIES, strict=False)
        )
        alone = dataclasses.replace(design, optics=plain_optics(design.optics, lamps))
        parts.append(drawn(alone, mesh, presses, store, part(span, 0.0, 1.0), note))
    monitor(1.0, "lights drawn")
    count, (first, *_) = len(lights), parts
    return LightBasis(
        lights=tuple(lights),
        rest_pixel=first.rest_pixel,
        rest=np.concatenate([each.rest for each in parts], axis=1)[:, :count],
        ambient=first.ambient,
        presses=tuple(
            dataclasses.replace(
                each[0],
                change=np.concatenate([one.change for one in each], axis=2)[:, :, :count],
            )
            for each in zip(*(each.presses for each in parts), strict=True)
        ),
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class Drawn:
    """A design in its own light, in three colours, without its ambient light."""

    rest_pixel: np.ndarray
    rest: np.ndarray
    """Light on the image sensor at rest, shape (N, 3), float32."""
    ambient: np.ndarray
    """The same of ambient light of power 1, shape (N,), float32."""
    presses: tuple[PressSamples, ...]
    """With a colour in the place of each light."""


def drawn(
    design: SensorDesign,
    mesh: MembraneMesh,
    presses: Sequence[tuple[BallPress, Circle]],
    store: Store,
    monitor: Monitor,
    note: str,
) -> Drawn:
    """Trace a design with `plain_optics` and draw it at rest and pressed.

    Args:
        design: With ambient light of power 1.
        mesh: Of the design.
        presses: Each with the circle whose box is drawn.
        store: Keeps light and table.
        monitor: Progress and cancellation.
        note: What the light is for, for people.

    Raises:
        WorkbenchError: From the stages that trace.
    """
    camera = design.optics.camera
    width, height = camera.width_px, camera.height_px
    keep = kept_light(camera).reshape(-1, 1)
    studio = lit_studio(design, mesh, store, part(monitor, 0.0, 0.7), note)
    back = studio.imager.backdrop
    lit = studio.imager.shader.lit.ambient.mean() * studio.rays.transmittance[:, None]
    glow = keep * lit * (back.background.max(axis=1, keepdims=True) > 0.0)
    whole = keep * back.background - glow
    rest_pixel = sampled(slice(0, height), slice(0, width), width)
    found = []
    for number, (press, circle) in enumerate(presses):
        monitor(0.7 + 0.3 * number / len(presses), f"{note}: {press.photo.name}")
        pixel = sampled(*contact_box(circle, width, height), width)
        depths_mm = _levels(press)
        moved = np.stack([press.displaced_mm(depth) for depth in depths_mm])
        images = studio.linear(moved).reshape(len(moved), -1, 3)[:, pixel]
        change = keep[pixel] * images - whole[pixel] - glow[pixel]
        found.append(
            PressSamples(pixel=pixel, depths_mm=depths_mm, change=change.astype(np.float32))
        )
    return Drawn(
        rest_pixel=rest_pixel,
        rest=around(whole, width)[rest_pixel].astype(np.float32),
        ambient=around(glow, width)[rest_pixel, 0].astype(np.float32),
        presses=tuple(found),
    )


def _levels(press: BallPress) -> np.ndarray:
    """Depths at which a press is drawn [mm]."""
    if press.most_mm - press.least_mm < 1e-6:
        return np.array([press.most_mm])
    return np.linspace(press.least_mm, press.most_mm, LEVELS)


def plain_optics(optics: Optics, lamps: tuple[Lamp, ...], photons: int = PHOTONS) -> Optics:
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
        baking=Baking(photons=photons, seed=optics.baking.seed),
        markers=dataclasses.replace(optics.markers, visible=False),
    )
