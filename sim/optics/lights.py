"""LEDs: where they sit, where they point, what they emit, and whether that place exists.

An LED ring is a circle about +Z. Power is radiant flux, so the radiant intensity on the axis of an
LED that falls as cos^m is I0 = power (m + 1) / (2 pi). Colours are linear RGB.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core.camera import Camera
from workbench.core.errors import DesignError
from workbench.core.leds import colour_sectors, led_places
from workbench.core.lighting import LedMount, LedRing
from workbench.core.results import MembraneMesh, Skin
from workbench.core.units import radians

FEWEST_PIXELS = 0.01
"""Least share of pixels that must see the skin [1]; below it an image carries nothing."""
JUST_ABOVE_BASE_MM = 0.05
"""Height of radial rays over the base [mm]: a ray in the rim itself may slip past the skin."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Leds:
    """Point lights in the sensor frame."""

    position_mm: np.ndarray
    """Shape (L, 3), float64."""
    axis: np.ndarray
    """Unit emission axes, shape (L, 3), float64."""
    rgb: np.ndarray
    """Linear RGB power, shape (L, 3), float64."""
    exponent: np.ndarray
    """Radiant intensity falls as cos^exponent, shape (L,), float64."""
    cone: np.ndarray
    """Cosine of half the emission cone, shape (L,), float64."""
    size_mm: np.ndarray
    """Diameter of the emitting disc [mm], shape (L,), float64."""
    in_shell: np.ndarray
    """Whether the light sits in the transparent support rather than in the cavity, (L,), bool."""


def place_leds(ring: LedRing) -> Leds:
    """The LEDs of a ring; colours fill equal sectors in the order of azimuth."""
    position_mm, axis = led_places(ring)
    colours = np.array([linear_rgb(colour) for colour in ring.colours])
    factors = np.array(ring.powers) if ring.powers else np.ones(ring.count)
    rgb = ring.power * factors[:, None] * colours[colour_sectors(ring)]
    return Leds(
        position_mm=position_mm,
        axis=axis,
        rgb=rgb,
        exponent=np.full(ring.count, ring.emission_exponent),
        cone=np.full(ring.count, np.cos(radians(ring.cone_deg) / 2.0)),
        size_mm=np.full(ring.count, ring.size_mm),
        in_shell=np.full(ring.count, ring.mount is LedMount.SHELL),
    )


def linear_rgb(colour: str) -> tuple[float, float, float]:
    """Linear RGB in [0, 1] of `#rrggbb`; the digits are linear power, not an sRGB code."""
    red, green, blue = (int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    return red, green, blue


def check_lights(mesh: MembraneMesh, ring: LedRing) -> None:
    """Refuse LEDs that emit nothing or sit where no LED can be.

    A cavity LED must lie in the air inside the support, a shell LED in the support itself.

    Raises:
        DesignError: Naming the LED, its radius or height, and the limit [mm].
    """
    leds = place_leds(ring)
    _check_power(ring, leds)
    base = float(mesh.cavity.points_mm[:, 2].min())
    if ring.height_mm < base:
        raise DesignError(
            f"the LED ring at height {ring.height_mm:g} mm is below the base at {base:g} mm",
            hint=f"raise height_mm to {base:g} mm or more",
            at="optics.ring.height_mm",
        )
    raised = leds.position_mm.copy()
    raised[:, 2] = np.maximum(raised[:, 2], base + JUST_ABOVE_BASE_MM)
    layers = [("cavity", mesh.cavity), ("support", mesh.inner), ("elastomer wall", mesh.outer)]
    within = {name: inside(skin, raised) for name, skin in layers}
    wanted = "support" if ring.mount is LedMount.SHELL else "cavity"
    for number, point in enumerate(raised):
        place = next((name for name, _ in layers if within[name][number]), "space outside")
        if place != wanted:
            raise _misplaced(mesh, ring, number, point, place)


def _check_power(ring: LedRing, leds: Leds) -> None:
    if ring.power == 0.0:
        raise DesignError(
            "all LEDs have power 0, so the image would be black",
            hint="set the LED power to 1",
            at="optics.ring.power",
        )
    if not leds.rgb.any():
        raise DesignError(
            "all LEDs are black (#000000), so the image would be black",
            hint="name at least one colour other than #000000",
            at="optics.ring.colours",
        )


def _misplaced(
    mesh: MembraneMesh, ring: LedRing, number: int, point: np.ndarray, place: str
) -> DesignError:
    """The error for an LED in the wrong place, with the radii that would do at its azimuth."""
    cavity, inner = (_wall_radius(skin, point) for skin in (mesh.cavity, mesh.inner))
    what = f"LED {number + 1} of {ring.count} at radius {ring.radius_mm:g} mm, height "
    what += f"{ring.height_mm:g} mm is in the {place}"
    if not np.isfinite(cavity) or not np.isfinite(inner):
        top = float(mesh.cavity.points_mm[:, 2].max())
        message = f"{what}; the cavity ends at height {top:.3g} mm"
        hint = f"lower height_mm below {top:.3g} mm"
        return DesignError(message, hint=hint, at="optics.ring.height_mm")
    if ring.mount is LedMount.SHELL:
        message = f"{what}; the support reaches from {cavity:.4g} to {inner:.4g} mm there"
        hint = f"set radius_mm between {cavity:.4g} and {inner:.4g} mm, or mount = 'cavity'"
    else:
        message = f"{what}; the cavity ends at {cavity:.4g} mm there"
        hint = f"set radius_mm below {cavity:.4g} mm, or mount = 'shell' with "
        hint += f"{cavity:.4g} to {inner:.4g} mm"
    return DesignError(message, hint=hint, at="optics.ring.radius_mm")


def check_camera(mesh: MembraneMesh, camera: Camera) -> None:
    """Refuse a camera outside the cavity, or one that sees (almost) nothing of the skin.

    Raises:
        DesignError: Naming the position and its limit [mm], or the share of pixels that see skin.
    """
    position = np.asarray(camera.position_mm, dtype=np.float64)
    base = float(mesh.cavity.points_mm[:, 2].min())
    x, y, z = position
    place = f"the camera at ({x:g}, {y:g}, {z:g}) mm is"
    at = "optics.camera.position_mm"
    if z < base:
        message = f"{place} below the base at {base:g} mm"
        raise DesignError(message, hint=f"raise z to {base:g} mm or more", at=at)
    probe = np.array([[x, y, max(z, base + JUST_ABOVE_BASE_MM)]])
    if not inside(mesh.cavity, probe)[0]:
        in_wall = inside(mesh.outer, probe)[0]
        limit = _wall_radius(mesh.cavity, probe[0])
        top = float(mesh.cavity.points_mm[:, 2].max())
        edge = f"{limit:.4g} mm from the axis" if np.isfinite(limit) else f"at height {top:.4g} mm"
        message = f"{place} {'inside the wall' if in_wall else 'outside the sensor'}; "
        message += f"the cavity ends {edge} there"
        raise DesignError(message, hint="move it into the cavity", at=at)
    _check_view(mesh, camera)


def _check_view(mesh: MembraneMesh, camera: Camera) -> None:
    from geometry.rays import RayCaster
    from sim.optics.camera import pixel_directions

    columns = (np.arange(64) + 0.5) / 64 * camera.width_px
    rows = (np.arange(48) + 0.5) / 48 * camera.height_px
    grid = np.stack(np.meshgrid(columns, rows), axis=-1).reshape(-1, 2)
    direction = pixel_directions(camera, grid)
    origin = np.broadcast_to(np.asarray(camera.position_mm, dtype=np.float64), direction.shape)
    _, face, _ = RayCaster(mesh.seen.points_mm, mesh.seen.faces).hits(origin, direction)
    share = float(np.mean(face >= 0))
    if share < FEWEST_PIXELS:
        raise DesignError(
            f"only {share:.1%} of the pixels see the skin, less than {FEWEST_PIXELS:.0%}",
            hint="turn the camera (wxyz; 1, 0, 0, 0 looks along +Z to the tip) or widen fov_x_deg",
            at="optics.camera",
        )


def inside(skin: Skin, points_mm: np.ndarray) -> np.ndarray:
    """Whether points above the base lie within a skin that is open at its base, shape (N,) bool.

    A ray upward leaves the skin through the face it meets first, or the point was outside.
    """
    from geometry.rays import RayCaster

    # Slightly off +Z: a ray along the axis or a straight wall would graze edges and vertices.
    upward = np.array([0.0131, 0.0217, 1.0])
    upward /= np.linalg.norm(upward)
    direction = np.broadcast_to(upward, points_mm.shape)
    _, face, _ = RayCaster(skin.points_mm, skin.faces).hits(points_mm, direction)
    corners = skin.points_mm[skin.faces[face]]
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) @ upward
    return (face >= 0) & (facing > 0.0)


def _wall_radius(skin: Skin, point: np.ndarray) -> float:
    """Distance [mm] from the axis to the skin at a point's azimuth and height; inf if none."""
    from geometry.rays import RayCaster

    radius = float(np.hypot(point[0], point[1]))
    around = point[:2] / radius if radius > 0.0 else np.array([1.0, 0.0])
    origin = np.array([[0.0, 0.0, point[2]]])
    direction = np.array([[around[0], around[1], 0.0]])
    return float(RayCaster(skin.points_mm, skin.faces).hits(origin, direction)[0][0])
