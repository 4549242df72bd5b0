"""How the skin moves under each photographed ball, by depth, from the contact solver.

The depth of a press is seldom known. The circle that is seen says it roughly: a contact of radius a
under a ball of radius R is about a^2 / R deep on an elastic half space (Hertz), where the skin
around sinks in, and R - sqrt(R^2 - a^2), the cap's height, where only the skin under the ball
moves. Circles drawn by hand are off by a tenth, depths then by a fifth, so the ball is pressed to
`BEYOND_HERTZ` times Hertz's depth, in frames of equal depth; between two frames displacement is
linear in depth.

On flat parts a press at one place serves the others: the skin moves alike, and is carried over.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np

from workbench.calibration.seen.photo_set import BallPhoto
from workbench.calibration.seen.seen_places import ContactPlace, SeenPlaces
from workbench.calibration.stored import stored
from workbench.core.base.errors import DesignError
from workbench.core.base.frames import tangent
from workbench.core.base.monitor import Monitor, part
from workbench.core.design.design import SensorDesign
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MembraneMesh
from workbench.core.result.sensing import Contact
from workbench.pipeline.store import Store

FRAMES = 8
BEYOND_HERTZ, SHORT_OF_CAP = 1.4, 0.6
"""Depths that are allowed: up to this many times Hertz's, down to this share of the cap's [1]."""
BEYOND_FOUND, SHORT_OF_FOUND = 2.5, 0.4
"""The same where a circle was found, not drawn: on the wall of a finger, seen aslant, it is found
too small by as much as a third. Held to the others, 6 of 14 presses of a twin stayed at two thirds
to four fifths of their depth, and lights and coating made up for it."""
OF_WALL = 0.8
"""Most of the wall that a ball may be pressed into [1]."""
OF_BALL = 0.95
"""Most of the ball's radius [1]: deeper, its equator touches."""
FINEST_MM, COARSEST_MM = 0.5, 0.8
"""Grid of the contact solver: a third of the contact's radius, between these."""
EDGE_MM = 1.0
"""Skin that is looked at around what moves, when a press is carried over [mm]."""
FACING = 0.3
"""Least cosine of skin with the direction of the press for it to be carried over [1]."""
FLAT_RADII = 3.0
"""Contact radii, plus the wall, around a place that must be flat for a press to be carried over."""


@dataclass(frozen=True, kw_only=True, slots=True)
class BallPress:
    """The skin under one ball."""

    photo: BallPhoto
    place: ContactPlace
    least_mm: float
    """Depth that the circle allows at least; that of the photograph where it is known."""
    most_mm: float
    guess_mm: float
    """Depth by Hertz's contact of the circle's radius, as far as ball and wall allow."""
    depths_mm: np.ndarray
    """Of the frames, the first is 0, shape (K + 1,)."""
    displacement_mm: np.ndarray
    """Of the seen skin's vertices, shape (K + 1, V, 3), float32."""
    normal_N: np.ndarray
    """Force along the normal, shape (K + 1,)."""

    def displaced_mm(self, depth_mm: float) -> np.ndarray:
        """Displacement at a depth [mm], shape (V, 3)."""
        low, share = self._between(depth_mm)
        one, other = self.displacement_mm[low], self.displacement_mm[low + 1]
        return ((1.0 - share) * one + share * other).astype(np.float32)

    def force_N(self, depth_mm: float) -> float:
        """Force along the normal at a depth [N]."""
        low, share = self._between(depth_mm)
        return float((1.0 - share) * self.normal_N[low] + share * self.normal_N[low + 1])

    def _between(self, depth_mm: float) -> tuple[int, float]:
        place = np.interp(depth_mm, self.depths_mm, np.arange(len(self.depths_mm)))
        low = min(int(place), len(self.depths_mm) - 2)
        return low, float(place - low)


def press_balls(
    design: SensorDesign,
    places: SeenPlaces,
    photos: list[tuple[BallPhoto, ContactPlace]],
    store: Store,
    monitor: Monitor,
) -> list[BallPress]:
    """Press each ball where its photograph shows it; what is stored is read.

    Raises:
        DesignError: With the photograph's name, if a ball cannot be pressed there.
    """
    mesh = places.mesh
    found: list[BallPress] = []
    on_flat: list[BallPress] = []
    for number, (photo, place) in enumerate(photos):
        span = part(monitor, number / len(photos), (number + 1) / len(photos))
        span(0.0, f"press of {photo.name}, {number + 1} of {len(photos)}")
        span_mm = allowed_mm(photo, place, places.wall_mm(place))
        far_mm = FLAT_RADII * place.radius_mm + places.wall_mm(place)
        flat = places.flat_to_mm(place) > far_mm
        known = [
            each
            for each in on_flat
            if flat
            and each.photo.ball_mm == photo.ball_mm
            and each.depths_mm[-1] >= span_mm[1] - 1e-9
            and each.place.normal @ place.normal > 0.999999
        ]
        if known:
            found.append(_carry(known[0], photo, place, mesh, span_mm))
            continue
        deepest = span_mm[1]
        if flat:
            # One press for all of them: as deep as the deepest may be.
            deepest = max(
                allowed_mm(other, there, places.wall_mm(there))[1]
                for other, there in photos
                if other.ball_mm == photo.ball_mm and there.normal @ place.normal > 0.999999
            )
        contact = _pressed(design, photo, place, deepest, store, span)
        press = _ball_press(photo, place, mesh, contact, deepest, span_mm)
        found.append(press)
        if flat:
            on_flat.append(press)
    monitor(1.0, "balls pressed")
    return found


def allowed_mm(photo: BallPhoto, place: ContactPlace, wall_mm: float) -> tuple[float, float, float]:
    """Least and most depth of a press, and Hertz's [mm], on a wall of a thickness."""
    if photo.depth_mm is not None:
        return photo.depth_mm, photo.depth_mm, photo.depth_mm
    ball, seen = photo.ball_mm / 2.0, place.radius_mm
    limit = min(OF_WALL * wall_mm, OF_BALL * ball)
    inside = min(seen, 0.98 * ball)
    cap = ball - math.sqrt(ball**2 - inside**2)
    hertz = seen**2 / ball
    short, beyond = SHORT_OF_CAP, BEYOND_HERTZ
    if photo.circle is None:
        short, beyond = SHORT_OF_FOUND, BEYOND_FOUND
    least, most = short * min(cap, limit), min(beyond * hertz, limit)
    return least, most, min(max(hertz, least), most)


def _pressed(
    design: SensorDesign,
    photo: BallPhoto,
    place: ContactPlace,
    depth_mm: float,
    store: Store,
    monitor: Monitor,
) -> Contact:
    grid_mm = min(max(place.radius_mm / 3.0, FINEST_MM), COARSEST_MM)
    x, y, z = (float(value) for value in place.point_mm)
    case = PressCase(
        indenter=Indenter(size_mm=photo.ball_mm),
        press=Press(target_mm=(x, y, z), depth_mm=depth_mm, frames=FRAMES),
        settings=ContactSettings(grid_mm=grid_mm),
    )
    try:
        return stored(
            design,
            case,
            "press",
            store,
            lambda fraction, note="": monitor(fraction, f"{photo.name}: {note}"),
        )
    except DesignError as error:
        error.message = f"{photo.name}: {error.message}"
        raise


def _ball_press(
    photo: BallPhoto,
    place: ContactPlace,
    mesh: MembraneMesh,
    contact: Contact,
    depth_mm: float,
    span_mm: tuple[float, float, float],
) -> BallPress:
    moved = mesh.seen_displacement_mm(contact)
    return BallPress(
        photo=photo,
        place=place,
        least_mm=span_mm[0],
        most_mm=span_mm[1],
        guess_mm=span_mm[2],
        depths_mm=np.linspace(0.0, depth_mm, len(moved) + 1),
        displacement_mm=np.concatenate([np.zeros_like(moved[:1]), moved]),
        normal_N=np.append(0.0, contact.normal_N),
    )


def carried(
    press: BallPress, photo: BallPhoto, place: ContactPlace, mesh: MembraneMesh
) -> BallPress:
    """The same press at another place: of the same flat part, or a fraction of a contact away."""
    span_mm = press.least_mm, press.most_mm, press.guess_mm
    return _carry(press, photo, place, mesh, span_mm)


def _turn(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Smallest rotation of one unit vector onto another, less than opposite: a matrix (3, 3)."""
    cross = np.cross(before, after)
    skew = np.cross(np.eye(3), cross)
    return np.eye(3) + skew + skew @ skew / (1.0 + before @ after)


def _carry(
    press: BallPress,
    photo: BallPhoto,
    place: ContactPlace,
    mesh: MembraneMesh,
    span_mm: tuple[float, float, float],
) -> BallPress:
    """What moves about one place, moved to another, in the plane that touches the skin there."""
    from scipy.interpolate import LinearNDInterpolator

    skin, still = mesh.seen, np.zeros_like(press.displacement_mm)
    moves = np.abs(press.displacement_mm).max(axis=(0, 2)) > 0.0
    away = np.linalg.norm(skin.points_mm - press.place.point_mm, axis=1)
    reach_mm = float(away[moves].max(initial=0.0)) + EDGE_MM
    normal = place.normal
    turn = _turn(press.place.normal, normal)
    side = tangent(press.place.normal)
    plane = np.column_stack([side, np.cross(press.place.normal, side)])
    there = (skin.normals @ press.place.normal > FACING) & (away < reach_mm)
    here = (skin.normals @ normal > FACING) & (
        np.linalg.norm(skin.points_mm - place.point_mm, axis=1) < reach_mm
    )
    # A press moves nothing beyond its region: outside the hull of what is known there is none.
    known = LinearNDInterpolator(
        (skin.points_mm[there] - press.place.point_mm) @ plane,
        np.moveaxis(press.displacement_mm[:, there], 0, 1),
        fill_value=0.0,
    )
    found = known((skin.points_mm[here] - place.point_mm) @ turn @ plane)
    still[:, here] = np.moveaxis(found, 1, 0) @ turn.T
    return dataclasses.replace(
        press,
        photo=photo,
        place=place,
        least_mm=span_mm[0],
        most_mm=span_mm[1],
        guess_mm=span_mm[2],
        displacement_mm=still,
    )
