"""One photograph read: what the skin did, what the camera shows of it, and what it took."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.reading.pixel_maps import PixelMaps
from workbench.reading.design_reader import DesignReader, expect_light, expect_size

if TYPE_CHECKING:
    # They need the device that reading opens.
    from sim.reading.ball_model import FittedBall
    from sim.reading.layer_law import Layer
    from sim.reading.reader import Touch

UNKNOWN = np.full(3, np.nan)


@dataclass(frozen=True, kw_only=True, slots=True)
class Reading:
    """Of one photograph."""

    photo: str
    touch: Touch
    normals: np.ndarray
    """Unit normals into the sensor of the moved vertices, shape (V, 3)."""
    maps: PixelMaps
    force_N: np.ndarray
    """On the membrane in the sensor frame, shape (3,); NaN where the design tells none."""
    force_sigma_N: float
    """Standard deviation of its size."""
    contact_area_mm2: float
    ball_radius_mm: float
    """Of the ball that fits the dent; NaN where none does."""
    ball: FittedBall | None = None
    """The ball whose image fits the photograph, where one was asked for."""

    @property
    def surface_mm(self) -> np.ndarray:
        """Inward displacement of the vertices of the seen skin, shape (V,)."""
        return self.touch.inward_mm

    @property
    def surface_sigma_mm(self) -> np.ndarray:
        """Its standard deviation, shape (V,)."""
        return self.touch.sigma_mm

    @property
    def more(self) -> dict[str, np.ndarray]:
        """Further arrays of its file: none."""
        return {}

    @property
    def figures(self) -> dict[str, Any]:
        """What `reading.json` says of it; null where nothing is known."""
        return {
            "photo": self.photo,
            "peak_depth_mm": float(self.touch.inward_mm.max(initial=0.0)),
            "contact_area_mm2": self.contact_area_mm2,
            "ball_radius_mm": known(self.ball_radius_mm),
            "force_N": [known(value) for value in self.force_N.tolist()],
            "force_sigma_N": known(self.force_sigma_N),
            "noise_grey": self.touch.noise_grey,
            "misfit": self.touch.misfit,
            "seconds": self.touch.seconds,
            **({} if self.ball is None else {"ball": _told(self.ball)}),
        }


def read_photo(
    opened: DesignReader, name: str, photo: np.ndarray, before: Touch | None = None
) -> Reading:
    """Read a photograph (H, W, 3), uint8.

    Args:
        opened: The design's reader.
        name: Of the photograph.
        photo: Of the touched sensor, by the camera that took the one at rest.
        before: What the image before it in a video said.

    Raises:
        DesignError: If it has another size or is saturated.
    """
    from sim.reading.ball import ball_radius_mm
    from sim.reading.maps import pixel_maps, touched
    from sim.reading.rest_skin import normals_of

    rest, reader = opened.reader.rest, opened.reader
    expect_size(name, photo, rest.camera)
    expect_light(name, photo, rest.sees)
    touch = reader.read(photo, before)
    normals = normals_of(rest.skin, reader.displaced_mm(touch))
    chosen = np.flatnonzero(touched(touch))
    force_N, sigma_N = _force(opened, touch, chosen)
    return Reading(
        photo=name,
        touch=touch,
        normals=normals,
        maps=pixel_maps(reader, touch, normals),
        force_N=force_N,
        force_sigma_N=sigma_N,
        contact_area_mm2=float(rest.skin.shares_mm2[chosen].sum()),
        ball_radius_mm=ball_radius_mm(
            rest.skin.points_mm[chosen], rest.skin.inward[chosen], touch.inward_mm[chosen]
        ),
    )


def _force(opened: DesignReader, touch: Touch, chosen: np.ndarray) -> tuple[np.ndarray, float]:
    """Force and deviation by the law of the wall, of the touched vertices (n,)."""
    from sim.reading.force import read_force

    if not opened.tells_force:
        return UNKNOWN, float("nan")
    skin, depth_mm = opened.reader.rest.skin, touch.inward_mm[chosen]
    found = read_force(
        _layer(opened, depth_mm, chosen),
        skin.points_mm[chosen],
        skin.inward[chosen],
        skin.shares_mm2[chosen],
        (depth_mm, touch.sigma_mm[chosen]),
    )
    return found.force_N, found.sigma_N


def with_ball(opened: DesignReader, reading: Reading, photo: np.ndarray) -> Reading:
    """A reading with the ball whose image fits its photograph (H, W, 3), uint8, best."""
    from sim.reading.ball_model import fit_ball
    from sim.reading.maps import touched

    chosen = np.flatnonzero(touched(reading.touch))
    if not len(chosen):
        return reading
    radius_mm = reading.ball_radius_mm
    if not np.isfinite(radius_mm):
        # A dent as wide as it is read.
        radius_mm = max(1.0, float(np.sqrt(reading.contact_area_mm2 / np.pi)))
    layer = _layer(opened, reading.touch.inward_mm[chosen], chosen)
    photo = photo.astype(np.float64)
    found = fit_ball(opened.reader, photo, reading.touch, layer, radius_mm)
    return dataclasses.replace(reading, ball=found)


def _layer(opened: DesignReader, depth_mm: np.ndarray, chosen: np.ndarray) -> Layer:
    """The wall under the touched vertices (n,), pressed in by (n,) [mm]."""
    from sim.reading.layer_law import Layer

    material, thickness_mm = opened.material, 1.0
    if len(chosen):
        thickness_mm = float(np.average(opened.wall_mm[chosen], weights=depth_mm))
    return Layer(thickness_mm=thickness_mm, young_MPa=material.young_MPa, poisson=material.poisson)


def _told(ball: FittedBall) -> dict[str, Any]:
    return {
        "place_mm": ball.place_mm.tolist(),
        "radius_mm": ball.radius_mm,
        "radius_sigma_mm": ball.radius_sigma_mm,
        "depth_mm": ball.depth_mm,
        "misfit": ball.misfit,
    }


def known(value: float) -> float | None:
    """A number as a table holds it; None where it is not finite."""
    return value if np.isfinite(value) else None
