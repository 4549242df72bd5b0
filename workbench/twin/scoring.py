"""How far a reading is from what the skin really did.

Depth and normals are compared over the skin that the camera sees and that moved by more than
`MOVED_MM`, each vertex by the area that it stands for. Beside each score stands its null, the
reading that says nothing moved, and beside the depth its ceiling, what known normals alone would
give (`sim.reading.true_surface`).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from workbench.reading.design_reader import DesignReader
from workbench.reading.learned_reader import LearnedReading
from workbench.reading.read_photo import Reading
from workbench.twin.truth import Truth

if TYPE_CHECKING:
    # It needs the device that reading opens.
    from sim.reading.reader import Touch

MOVED_MM = 0.05
"""True depth from which skin counts as moved; `sim.reading.maps` calls so much contact."""
READABLE_DEG = 3.0
"""Standard deviation of a tilt, by one pixel, up to which skin counts as readable."""
PLAIN_NOISE_GREY = 1.0
"""Noise by which skin counts as readable where a reading tells none."""
REST_MM = 2e-3
"""Skin that moved less is held when known normals are integrated."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ReadingScore:
    """Of one photograph; NaN of what does not apply."""

    photo: str
    depth_mm: float
    """Mean error of depth."""
    depth_null_mm: float
    """The same of a reading that says nothing moved: the mean depth."""
    depth_ceiling_mm: float
    """The same of the true normals, integrated."""
    depth_bias_mm: float
    """Mean of depth read less the true one."""
    peak_mm: float
    """Deepest point read less the true one."""
    normal_deg: float
    """Median angle between the normals read and the true ones."""
    normal_null_deg: float
    """The same of the skin at rest."""
    contact_iou: float
    """Area that is both pressed in and read so, over that which is either."""
    within_sigma: float
    """Share of the errors of depth that are within one standard deviation; .68 is right."""
    readable: float
    """Share of the moved skin on which one pixel tells tilts to `READABLE_DEG`."""
    seen: float
    """Share of all moved skin that the camera sees."""
    force_N: float
    """Size of the true force."""
    force_read_N: float
    force_error: float
    """Size of the difference of the two as vectors, over the true one; its null is 1."""

    @property
    def figures(self) -> dict[str, float | None]:
        """Its numbers by name, as JSON holds them."""
        table = dataclasses.asdict(self)
        del table["photo"]
        return {name: value if np.isfinite(value) else None for name, value in table.items()}


class Scorer:
    """What all readings of one reader share."""

    def __init__(self, opened: DesignReader) -> None:
        self.opened = opened
        self._signal: np.ndarray | None = None

    def score(self, reading: Reading | LearnedReading, truth: Truth) -> ReadingScore:
        """Compare a reading with what its photograph shows."""
        from sim.reading.maps import touched
        from sim.reading.rest_skin import normals_of
        from sim.reading.true_surface import KnownSkin, integrated_mm, surface_over

        reader, touch = self.opened.reader, self._touch(reading)
        skin = reader.rest.skin
        true = surface_over(
            skin,
            KnownSkin(rest_mm=truth.rest_mm, displaced_mm=truth.displaced_mm, faces=truth.faces),
        )
        depth_mm = np.nan_to_num(true.depth_mm)
        seen, area = reader.seen(touch.sight), skin.shares_mm2
        moved = (depth_mm > MOVED_MM) & np.isfinite(true.depth_mm)
        judged = moved & seen
        error = touch.inward_mm - depth_mm
        read = touched(touch) & seen
        either = judged | read
        kept = integrated_mm(skin, true, np.abs(depth_mm) > REST_MM)
        angles = _angles_deg(normals_of(skin, reader.displaced_mm(touch)), true.inward)
        known = judged & np.isfinite(touch.sigma_mm) & (touch.sigma_mm > 0.0)
        sure = np.abs(error) <= np.nan_to_num(touch.sigma_mm)
        true_N = float(np.linalg.norm(truth.force_N))
        return ReadingScore(
            photo=reading.photo,
            depth_mm=_mean(np.abs(error), area, judged),
            depth_null_mm=_mean(depth_mm, area, judged),
            depth_ceiling_mm=_mean(np.abs(kept - depth_mm), area, judged),
            depth_bias_mm=_mean(error, area, judged),
            peak_mm=_peak(touch.inward_mm, seen) - _peak(depth_mm, judged),
            normal_deg=_median(angles, judged),
            normal_null_deg=_median(_angles_deg(skin.inward, true.inward), judged),
            contact_iou=_mean((judged & read).astype(float), area, either),
            within_sigma=_mean(sure.astype(float), area, known),
            readable=_mean(self._readable(touch).astype(float), area, judged),
            seen=_mean(seen.astype(float), area, moved),
            force_N=true_N,
            force_read_N=float(np.linalg.norm(reading.force_N)),
            force_error=float(np.linalg.norm(reading.force_N - truth.force_N)) / max(true_N, 1e-9),
        )

    def _touch(self, reading: Reading | LearnedReading) -> Touch:
        """A reading as a touch; a network says nothing of noise, and sees the skin at rest."""
        from sim.reading.reader import Touch

        if isinstance(reading, Reading):
            return reading.touch
        return Touch(
            inward_mm=reading.surface_mm,
            sigma_mm=reading.surface_sigma_mm,
            misfit=float("nan"),
            noise_grey=PLAIN_NOISE_GREY,
            steps=0,
            seconds=reading.seconds,
            sight=self.opened.reader.rest.sight,
        )

    def _readable(self, touch: Touch) -> np.ndarray:
        """Vertices on which a pixel's noise hides no more than `READABLE_DEG`, (V,), bool."""
        from sim.optics.maps.signal import resolvability

        jacobian = self._jacobian()
        noise = np.full(jacobian.shape[:2], max(touch.noise_grey, 1e-6))
        return resolvability(jacobian, noise) * READABLE_DEG >= 1.0

    def _jacobian(self) -> np.ndarray:
        """Grey levels per degree of tilt at rest, shape (V, 3, 2)."""
        from sim.optics.maps.display_light import display_light
        from sim.optics.maps.signal import tilt_jacobian

        rest = self.opened.reader.rest
        if self._signal is None:
            light = display_light(rest.studio, rest.camera)
            self._signal = tilt_jacobian(
                lambda inward: rest.gain * light(inward.astype(np.float32)),
                rest.skin.inward,
                rest.camera.sensor,
            )
        return self._signal


def mean_score(scores: Sequence[ReadingScore], name: str = "mean") -> ReadingScore:
    """The mean of each score, photographs alike; NaN are left out.

    Args:
        scores: Of some photographs.
        name: What it is called.
    """
    found: dict[str, float] = {}
    for field in dataclasses.fields(ReadingScore):
        if field.name != "photo":
            values = np.array([getattr(each, field.name) for each in scores], dtype=float)
            plain = values[np.isfinite(values)]
            found[field.name] = float(plain.mean()) if len(plain) else float("nan")
    return ReadingScore(photo=name, **found)


def _mean(values: np.ndarray, area: np.ndarray, chosen: np.ndarray) -> float:
    whole = float(area[chosen].sum())
    return float((area * values)[chosen].sum()) / whole if whole > 0.0 else float("nan")


def _peak(depth_mm: np.ndarray, chosen: np.ndarray) -> float:
    return float(depth_mm[chosen].max(initial=0.0))


def _median(values: np.ndarray, chosen: np.ndarray) -> float:
    plain = values[chosen & np.isfinite(values)]
    return float(np.median(plain)) if len(plain) else float("nan")


def _angles_deg(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.degrees(np.arccos(np.clip(np.einsum("vc,vc->v", one, other), -1.0, 1.0)))
