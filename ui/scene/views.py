"""Where the tabs look from: frames a body, flies to a place and marks it, and comes back."""

from __future__ import annotations

import enum
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from workbench.view.scene_shapes import USUAL_VIEW

FOV_RAD = 0.6
"""Vertical angle of view of every tab [rad]."""
AWAY = np.array([0.74, 0.55, 0.39])
"""Unit direction from which a body is seen first."""
FILLED = 0.9
"""Share of the view that the diagonal of a framed box takes."""
USUAL_ASPECT = 0.78
"""Width over height of the view between the docks, for tabs that have not told theirs."""
RAISED = 0.04
"""How far a framed box stands above the middle of the view, over the eye's distance: the timeline
lies along the lower edge."""
MARK_SHARE = 0.012
"""Radius of a mark over the eye's distance from it."""
POINTER_SHARE = 0.12
"""Length of the pointer that stands on a mark over the eye's distance from it."""
POINTER_UP = np.array([0.0, 0.0, 0.7])
"""Added to the direction of the pointer, which would otherwise be seen end-on."""
MARK_COLOUR = (255, 45, 85)


@dataclass(frozen=True, slots=True)
class Mark:
    """What stands at a place that is looked at."""

    text: str
    colour: tuple[int, int, int] = MARK_COLOUR
    ball: bool = True
    """Whether a ball stands there; it would hide what is as small."""


class Side(enum.StrEnum):
    """Where to look from; names for people, in the order of their keys."""

    FRONT = "Front"
    RIGHT = "Right"
    TOP = "Top"
    CONTACT = "Contact"
    ISOMETRIC = "Isometric"
    BACK = "Back"
    LEFT = "Left"
    BOTTOM = "Bottom"


TOWARD = {
    # Of a sensor without a body; else the way depends on where it is pressed.
    Side.CONTACT: tuple(AWAY),
    Side.FRONT: (0.0, -1.0, 0.0),
    Side.RIGHT: (1.0, 0.0, 0.0),
    # Straight down the upright axis a turntable camera has no up.
    Side.TOP: (0.0, -0.001, 1.0),
    # From the side that bodies are first seen from.
    Side.ISOMETRIC: (1.0, 1.0, 1.0),
    Side.BACK: (0.0, 1.0, 0.0),
    Side.LEFT: (-1.0, 0.0, 0.0),
    Side.BOTTOM: (0.0, -0.001, -1.0),
}
"""Directions from the sensor toward the eye, of any length; Z is up."""
USUAL = (Side.FRONT, Side.RIGHT, Side.TOP, Side.CONTACT, Side.ISOMETRIC)
"""Those that have a button; the others are on the cube in the corner of the view, and have keys."""
STEEPEST = 0.999
"""Largest share of the upright axis in a direction toward the eye."""


class Views:
    """Cameras of all tabs of one server."""

    def __init__(self, server: Any) -> None:
        self.server = server
        self._before: dict[int, tuple[Any, Any]] = {}
        self._mark: list[Any] = []
        self._away = AWAY
        """Unit direction from which the body on show was framed."""
        self.close = False
        """Whether the last thing that moved the eye was a flight to a place."""
        server.initial_camera.fov = FOV_RAD

    def frame(self, low_mm: np.ndarray, high_mm: np.ndarray, away: np.ndarray = AWAY) -> None:
        """Look at a box from the unit direction `away`, in tabs that are open and those to come."""
        centre = (low_mm + high_mm) / 2
        size_mm = float(np.linalg.norm(high_mm - low_mm))
        self._away = away
        self._welcome(centre, size_mm, away)
        self._before.clear()
        self.close = False
        self._fit(centre, size_mm, away)

    def _welcome(self, centre: np.ndarray, size_mm: float, away: np.ndarray) -> None:
        """Let tabs that open from now on look at a ball from the side `away`."""
        distance_mm = _distance_mm(size_mm)
        aim = _below(centre, distance_mm, away)
        camera = self.server.initial_camera
        camera.position, camera.look_at = tuple(aim + distance_mm * away), tuple(aim)

    def fit(self, low_mm: np.ndarray, high_mm: np.ndarray) -> None:
        """Look at a box from the side each tab looks from."""
        self.close = False
        centre = (low_mm + high_mm) / 2
        size_mm = float(np.linalg.norm(high_mm - low_mm))
        for client in self.server.get_clients().values():
            away = np.asarray(client.camera.position) - np.asarray(client.camera.look_at)
            length = float(np.linalg.norm(away))
            side = away / length if length > 0 else self._away
            distance_mm = _distance_mm(size_mm, client.camera.aspect)
            aim = _below(centre, distance_mm, side)
            with client.atomic():
                client.camera.position = aim + distance_mm * side
                client.camera.look_at = aim

    def look_from(
        self,
        side: Side,
        low_mm: np.ndarray,
        high_mm: np.ndarray,
        *,
        client: Any = None,
        toward: np.ndarray | None = None,
    ) -> None:
        """Look at a box from a side, in one tab or, without one, in all.

        Args:
            side: Which side.
            low_mm: Lowest corner of the box.
            high_mm: Highest corner of the box.
            client: The tab that asked.
            toward: Direction to the eye in place of the side's own.
        """
        self.close = False
        centre = (low_mm + high_mm) / 2
        size_mm = float(np.linalg.norm(high_mm - low_mm))
        way = np.asarray(TOWARD[side] if toward is None else toward, dtype=float)
        way = way / np.linalg.norm(way)
        if abs(way[2]) > STEEPEST and toward is not None:
            way = np.array(TOWARD[Side.TOP])
        tabs = self.server.get_clients().values() if client is None else (client,)
        for tab in tabs:
            with tab.atomic():
                tab.camera.position = centre + _distance_mm(size_mm, tab.camera.aspect) * way
                tab.camera.look_at = centre

    def step_back(self, low_mm: np.ndarray, high_mm: np.ndarray) -> None:
        """Look at another box for a while; remembers where each tab was."""
        for number, client in self.server.get_clients().items():
            # A close look at one place is not where a tab was: the whole sensor is.
            if not self.close:
                self._before.setdefault(number, (client.camera.position, client.camera.look_at))
        self.close = False
        centre = (low_mm + high_mm) / 2
        size_mm = float(np.linalg.norm(high_mm - low_mm))
        self._welcome(centre, size_mm, USUAL_VIEW)
        self._fit(centre, size_mm, USUAL_VIEW)

    def step_forward(self, low_mm: np.ndarray, high_mm: np.ndarray) -> None:
        """Give every tab its place before `step_back` again; one that came since sees the box."""
        self.close = False
        centre = (low_mm + high_mm) / 2
        size_mm = float(np.linalg.norm(high_mm - low_mm))
        self._welcome(centre, size_mm, self._away)
        for number, client in self.server.get_clients().items():
            away = _distance_mm(size_mm, client.camera.aspect) * self._away
            position, look_at = self._before.pop(number, (centre + away, centre))
            with client.atomic():
                client.camera.position, client.camera.look_at = position, look_at

    def fly_to(
        self,
        place_mm: Sequence[float],
        toward: np.ndarray,
        distance_mm: float,
        mark: Mark,
    ) -> None:
        """Look at a place from a side and mark it.

        Args:
            place_mm: The place [mm].
            toward: Unit direction from the place to the eye.
            distance_mm: From the eye to the place.
            mark: What stands there.
        """
        place = np.asarray(place_mm, dtype=float)
        self.close = True
        pointer = POINTER_SHARE * distance_mm * (np.asarray(toward) + POINTER_UP)
        self._put_mark(place, place + pointer, mark)
        if mark.ball:
            self._put_ball(place, MARK_SHARE * distance_mm, mark.colour)
        for client in self.server.get_clients().values():
            with client.atomic():
                client.camera.position = place + distance_mm * toward
                client.camera.look_at = place

    def _put_mark(self, place: np.ndarray, top: np.ndarray, mark: Mark) -> None:
        """A pointer that stands on the place, and the text at its top."""
        self.unmark()
        api = self.server.scene
        self._mark = [
            api.add_line_segments(
                "/mark/pointer",
                np.array([[place, top]], dtype=np.float32),
                colors=mark.colour,
                line_width=4.0,
            ),
            api.add_label("/mark/text", mark.text, position=top, anchor="bottom-center"),
        ]

    def _put_ball(self, place: np.ndarray, radius_mm: float, colour: tuple[int, int, int]) -> None:
        api = self.server.scene
        self._mark.append(
            api.add_icosphere("/mark/ball", radius=radius_mm, color=colour, position=place)
        )

    def unmark(self) -> None:
        """Take the mark away."""
        for node in self._mark:
            node.remove()
        self._mark.clear()

    def _fit(self, centre: np.ndarray, size_mm: float, away: np.ndarray) -> None:
        """Look at a ball from the side `away`, as near as it fits each tab's view."""
        for client in self.server.get_clients().values():
            distance_mm = _distance_mm(size_mm, client.camera.aspect)
            aim = _below(centre, distance_mm, away)
            with client.atomic():
                client.camera.position = aim + distance_mm * away
                client.camera.look_at = aim


def _below(centre: np.ndarray, distance_mm: float, away: np.ndarray) -> np.ndarray:
    """What to look at, so that a place stands raised in a view from the unit direction `away`."""
    upright = np.array([0.0, 0.0, 1.0])
    return centre - RAISED * distance_mm * (upright - away[2] * away)


def _distance_mm(size_mm: float, aspect: float = USUAL_ASPECT) -> float:
    """From the eye to a ball that takes `FILLED` of the narrower side of the view [mm]."""
    return size_mm / (2 * np.tan(FOV_RAD / 2) * min(1.0, aspect) * FILLED)
