"""Whether lights and cameras can be where the designer put them, and see or reach the skin.

A light in the cavity must lie in the air inside the support, one in the shell in the support
itself, a camera in the air. The messages name the place, its distance and the limit.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence

import numpy as np

from sim.optics.camera.camera import pixel_directions
from sim.optics.camera.inside_skin import JUST_ABOVE_BASE_MM, inside, wall_radius
from sim.optics.camera.lens import lens_of
from sim.optics.light.lights import place_leds
from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera
from workbench.core.design.leds import lamp_points
from workbench.core.design.lighting import Lamp, LampKind, LedMount, LedRing
from workbench.core.design.optics import Optics
from workbench.core.result.results import MembraneMesh

FEWEST_PIXELS = 0.01
"""Least share of pixels that must see the skin [1]; below it an image carries nothing."""
WHERE = {LedMount.CAVITY: "cavity", LedMount.SHELL: "support"}
"""Layer that each mount belongs into."""


def check_lights(mesh: MembraneMesh, ring: LedRing, lamps: Sequence[Lamp] = ()) -> None:
    """Refuse lights that emit nothing, or sit where no light can be.

    Raises:
        DesignError: Naming the LED or lamp, its radius or height, and the limit [mm].
    """
    _check_power(ring, lamps)
    base = float(mesh.cavity.points_mm[:, 2].min())
    if ring.count:
        _check_ring(mesh, ring, base)
    for number, lamp in enumerate(lamps, start=1):
        _check_lamp(mesh, lamp, number, base)


def _check_power(ring: LedRing, lamps: Sequence[Lamp]) -> None:
    leds = place_leds(ring, lamps)
    if not len(leds.rgb):
        raise DesignError(
            "there is no light: the ring has no LED and there is no lamp",
            hint="give the ring an LED or add a lamp",
            at="optics.ring.count",
        )
    if leds.rgb.any():
        return
    powered = [ring.power * max(ring.powers, default=1.0)] if ring.count else []
    powered += [lamp.power for lamp in lamps]
    what = "LEDs and lamps" if ring.count and lamps else "LEDs" if ring.count else "lamps"
    at = "optics.ring" if ring.count else "optics.lamps"
    if not any(powered):
        raise DesignError(
            f"all {what} have power 0, so the image would be black",
            hint=f"set the {'LED' if ring.count else 'lamp'} power to 1",
            at=f"{at}.power",
        )
    raise DesignError(
        f"all {what} with power are black (#000000), so the image would be black",
        hint="name at least one colour other than #000000",
        at=f"{at}.colour{'s' if ring.count else ''}",
    )


def _layer_of(mesh: MembraneMesh, points_mm: np.ndarray) -> list[str]:
    """Name of the layer that each point lies in."""
    layers = (("cavity", mesh.cavity), ("support", mesh.inner), ("elastomer wall", mesh.outer))
    found = ["space outside"] * len(points_mm)
    for name, skin in reversed(layers):
        for number in np.flatnonzero(inside(skin, points_mm)):
            found[number] = name
    return found


def _check_ring(mesh: MembraneMesh, ring: LedRing, base: float) -> None:
    if ring.height_mm < base:
        raise DesignError(
            f"the LED ring at height {ring.height_mm:g} mm is below the base at {base:g} mm",
            hint=f"raise height_mm to {base:g} mm or more",
            at="optics.ring.height_mm",
        )
    raised = place_leds(ring).position_mm.copy()
    raised[:, 2] = np.maximum(raised[:, 2], base + JUST_ABOVE_BASE_MM)
    for number, place in enumerate(_layer_of(mesh, raised)):
        if place != WHERE[ring.mount]:
            what = f"LED {number + 1} of {ring.count} at radius {ring.radius_mm:g} mm, height "
            what += f"{ring.height_mm:g} mm is in the {place}"
            names = ("radius_mm", "height_mm")
            raise _misplaced(mesh, ring.mount, raised[number], what, "optics.ring", names)


def _check_lamp(mesh: MembraneMesh, lamp: Lamp, number: int, base: float) -> None:
    places, _ = lamp_points(lamp)
    at = f"optics.lamps[{number}]"
    lowest = float(places[:, 2].min())
    if lowest < base:
        raise DesignError(
            f"lamp {number} reaches down to {lowest:.4g} mm, below the base at {base:g} mm",
            hint="raise the z of position_mm",
            at=f"{at}.position_mm",
        )
    raised = places.copy()
    raised[:, 2] = np.maximum(raised[:, 2], base + JUST_ABOVE_BASE_MM)
    for point, place in zip(raised, _layer_of(mesh, raised), strict=True):
        if place != WHERE[lamp.mount]:
            radius = float(np.hypot(point[0], point[1]))
            part = "" if lamp.kind is LampKind.POINT else f" reaches into the {place}"
            what = f"lamp {number}{part} at radius {radius:.4g} mm, height {point[2]:.4g} mm"
            what += "" if part else f" is in the {place}"
            names = ("position_mm", "position_mm")
            raise _misplaced(mesh, lamp.mount, point, what, at, names)


def _misplaced(
    mesh: MembraneMesh,
    mount: LedMount,
    point: np.ndarray,
    what: str,
    at: str,
    names: tuple[str, str],
) -> DesignError:
    """The error for a light in the wrong place, with the radii that would do at its azimuth.

    Args:
        mesh: The skins.
        mount: Where the light belongs.
        point: Its place [mm].
        what: Beginning of the message.
        at: Table of the light, for the message.
        names: Fields of its radius and of its height.
    """
    cavity, inner = (wall_radius(skin, point) for skin in (mesh.cavity, mesh.inner))
    beside, above = names
    if not np.isfinite(cavity) or not np.isfinite(inner):
        top = float(mesh.cavity.points_mm[:, 2].max())
        message = f"{what}; the cavity ends at height {top:.3g} mm"
        return DesignError(message, hint=f"lower {above} below {top:.3g} mm", at=f"{at}.{above}")
    radius = "set radius_mm" if beside == "radius_mm" else f"move {beside} to a radius"
    if mount is LedMount.SHELL:
        message = f"{what}; the support reaches from {cavity:.4g} to {inner:.4g} mm there"
        hint = f"{radius} between {cavity:.4g} and {inner:.4g} mm, or mount = 'cavity'"
    else:
        message = f"{what}; the cavity ends at {cavity:.4g} mm there"
        hint = f"{radius} below {cavity:.4g} mm, or mount = 'shell' with "
        hint += f"{cavity:.4g} to {inner:.4g} mm"
    return DesignError(message, hint=hint, at=f"{at}.{beside}")


def camera_field(optics: Optics, camera: Camera) -> str:
    """Field of a camera in messages; further ones are `optics.cameras[1]` and so on."""
    if camera == optics.camera or camera not in optics.cameras:
        return "optics.camera"
    return f"optics.cameras[{optics.cameras.index(camera) + 1}]"


def check_lenses(optics: Optics) -> None:
    """Refuse lenses that fold the image; needs no mesh.

    Raises:
        DesignError: As `lens_of`, naming the camera.
    """
    for camera in optics.all_cameras:
        with _named(camera_field(optics, camera)):
            lens_of(camera)


@contextlib.contextmanager
def _named(at: str) -> Iterator[None]:
    """Messages about `optics.camera` are about this camera."""
    try:
        yield
    except DesignError as error:
        error.at = error.at.replace("optics.camera", at, 1)
        raise


def check_camera(mesh: MembraneMesh, camera: Camera, *, at: str = "optics.camera") -> None:
    """Refuse a camera outside the cavity, one with a folding lens, or one that sees no skin.

    Args:
        mesh: The skins.
        camera: The camera.
        at: Its field of the design, for messages.

    Raises:
        DesignError: Naming the position and its limit [mm], or the share of pixels that see skin.
    """
    position = np.asarray(camera.position_mm, dtype=np.float64)
    base = float(mesh.cavity.points_mm[:, 2].min())
    x, y, z = position
    place = f"the camera at ({x:g}, {y:g}, {z:g}) mm is"
    if z < base:
        message = f"{place} below the base at {base:g} mm"
        hint = f"raise z to {base:g} mm or more"
        raise DesignError(message, hint=hint, at=f"{at}.position_mm")
    probe = np.array([[x, y, max(z, base + JUST_ABOVE_BASE_MM)]])
    if not inside(mesh.cavity, probe)[0]:
        in_wall = inside(mesh.outer, probe)[0]
        limit = wall_radius(mesh.cavity, probe[0])
        top = float(mesh.cavity.points_mm[:, 2].max())
        edge = f"{limit:.4g} mm from the axis" if np.isfinite(limit) else f"at height {top:.4g} mm"
        message = f"{place} {'inside the wall' if in_wall else 'outside the sensor'}; "
        message += f"the cavity ends {edge} there"
        raise DesignError(message, hint="move it into the cavity", at=f"{at}.position_mm")
    _check_view(mesh, camera, at)


def _check_view(mesh: MembraneMesh, camera: Camera, at: str) -> None:
    from geometry.surface.rays import RayCaster

    columns = (np.arange(64) + 0.5) / 64 * camera.width_px
    rows = (np.arange(48) + 0.5) / 48 * camera.height_px
    grid = np.stack(np.meshgrid(columns, rows), axis=-1).reshape(-1, 2)
    with _named(at):
        direction = pixel_directions(camera, grid)
    origin = np.broadcast_to(np.asarray(camera.position_mm, dtype=np.float64), direction.shape)
    _, face, _ = RayCaster(mesh.seen.points_mm, mesh.seen.faces).hits(origin, direction)
    share = float(np.mean(face >= 0))
    if share < FEWEST_PIXELS:
        raise DesignError(
            f"only {share:.1%} of the pixels see the skin, less than {FEWEST_PIXELS:.0%}",
            hint="turn the camera (wxyz; 1, 0, 0, 0 looks along +Z to the tip) or widen fov_x_deg",
            at=at,
        )
