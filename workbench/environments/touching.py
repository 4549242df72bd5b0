"""What environments share: a sensor, an object in the axes of a place, observations, motion.

The object begins over a place of the skin that is drawn at random, with random axes: n is the
skin's outward normal there, u and v lie across it. Motion, force and way are along u, v, n, so that
what is learned at one place holds at another.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict, Unpack

import gymnasium
import numpy as np
from gymnasium.spaces import Box, Dict

from workbench.core.base.check import within
from workbench.core.base.errors import DesignError
from workbench.environments.places import Place, inner_nodes, place_at, touching_mm

if TYPE_CHECKING:
    from workbench.sensor.frame import Felt, Frame
    from workbench.sensor.sensor import Sensor

Seen = dict[str, np.ndarray]
LONGEST_MM = 1.0
"""Of a step: contact is followed from step to step."""
MOST_N, MOST_MM = 100.0, 100.0
"""Bounds of what is observed, which gymnasium asks for; nothing of a finger's size comes near."""


class Touching(TypedDict, total=False):
    """What all environments take beside the sensor and `render_mode`."""

    shape: str
    """Object, as `Sensor.object` takes it; a ball by default."""
    size_mm: float
    """Its size; 6 mm by default."""
    width_px: int
    """Width of the images of a design, 160 by default; a pack has its own."""
    step_mm: float
    """Farthest way of a step along each axis; .1 mm by default."""
    margin_mm: float
    """Least distance of places from the skin's edge; the object's size by default."""


class TouchEnv(gymnasium.Env[Seen, np.ndarray]):
    """An object that moves over a sensor; what is to be reached is for those that derive."""

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012

    def __init__(
        self,
        sensor: Path | str = "geltip",
        *,
        render_mode: str | None = None,
        **options: Unpack[Touching],
    ) -> None:
        """Load the sensor.

        Args:
            sensor: A design by name or file, or the folder of a pack.
            render_mode: `rgb_array`, or None.
            options: See `Touching`.

        Raises:
            DesignError: If there is no such sensor or object, or an option is refused.
        """
        self.render_mode = render_mode
        self.sensor = _loaded(sensor, options.get("width_px", 160))
        size_mm = options.get("size_mm", 6.0)
        self.thing = self.sensor.object(options.get("shape", "sphere"), size_mm=size_mm)
        step_mm = options.get("step_mm", 0.1)
        self.step_mm = within(step_mm, 1e-3, LONGEST_MM, what="step", unit="mm", at="step_mm")
        self._nodes = inner_nodes(self.sensor.skin, options.get("margin_mm", size_mm))
        self._place: Place = place_at(self.sensor.skin, int(self._nodes[0]))
        self._moved_mm = np.zeros(3)
        self._first_mm = np.zeros(3)
        self.frame: Frame | None = None
        """What was felt and seen last."""
        width_px, height_px = self.sensor.image_px
        self.action_space = Box(-self.step_mm, self.step_mm, (3,), np.float32)
        self.observation_space = Dict(  # pyright: ignore[reportAttributeAccessIssue]
            {
                "image": Box(0, 255, (height_px, width_px, 3), np.uint8),
                "force_N": Box(-MOST_N, MOST_N, (3,), np.float32),
                "way_mm": Box(-MOST_MM, MOST_MM, (3,), np.float32),
                "goal": Box(0.0, MOST_N, (1,), np.float32),
            }
        )

    @property
    def force_N(self) -> np.ndarray:
        """Force on the object along u, v, n, shape (3,)."""
        assert self.frame is not None, "reset comes first"
        return self.along(self.frame)

    def along(self, felt: Felt) -> np.ndarray:
        """Force along u, v, n, shape (3,)."""
        return felt.force_N[0] @ self._place.axes

    @property
    def way_mm(self) -> np.ndarray:
        """How far the object has gone along u, v, n since it was set, shape (3,)."""
        return self._moved_mm - self._first_mm

    def set_object(self, above_mm: float) -> None:
        """Draw a place and set the object so far above it, untouched."""
        node = int(self._nodes[self.np_random.integers(len(self._nodes))])
        turn_rad = float(self.np_random.uniform(-np.pi, np.pi))
        self._place = place_at(self.sensor.skin, node, turn_rad)
        touch_mm = touching_mm(self._place, self.thing, self.sensor.skin)
        self._moved_mm = np.array([0.0, 0.0, touch_mm + above_mm])
        self._first_mm = self._moved_mm.copy()
        self.sensor.reset(1)

    def feel(self, motion_mm: np.ndarray) -> Felt:
        """Move the object without a look."""
        self._moved_mm = self._moved_mm + motion_mm
        return self.sensor.feel(self._place.pose(self._moved_mm), self.thing)

    def move(self, motion_mm: np.ndarray) -> Frame:
        """Move the object, at most `step_mm` along each axis, and look."""
        limited = np.clip(np.asarray(motion_mm, dtype=float), -self.step_mm, self.step_mm)
        self._moved_mm = self._moved_mm + limited
        self.frame = self.sensor.render(self._place.pose(self._moved_mm), self.thing)
        return self.frame

    def seen(self, goal: float) -> Seen:
        """What is observed."""
        assert self.frame is not None, "reset comes first"
        return {
            "image": self.frame.rgb[0],
            "force_N": np.clip(self.force_N, -MOST_N, MOST_N).astype(np.float32),
            "way_mm": np.clip(self.way_mm, -MOST_MM, MOST_MM).astype(np.float32),
            "goal": np.array([goal], dtype=np.float32),
        }

    def told(self) -> dict[str, Any]:
        """What is known beside it: slip, and whether forces are of the kind that was fitted."""
        assert self.frame is not None, "reset comes first"
        return {"slip": float(self.frame.slip[0]), "note": self.frame.notes[0]}

    def render(self) -> np.ndarray | None:  # pyright: ignore[reportIncompatibleMethodOverride]
        """What the camera sees, (H, W, 3), uint8; None without `render_mode`."""
        if self.render_mode is None or self.frame is None:
            return None
        return self.frame.rgb[0]


def checked_goals(goals: tuple[float, float], most: float, unit: str) -> tuple[float, float]:
    """Lowest and highest goal.

    Raises:
        DesignError: If one is not in (0, most], or the lowest is above the highest.
    """
    at = f"goals_{unit}"
    low, high = (within(goal, 1e-3, most, what="goal", unit=unit, at=at) for goal in goals)
    if low > high:
        raise DesignError(
            f"goals from {low:g} to {high:g} {unit}", hint="give the lowest first", at=at
        )
    return low, high


def _loaded(sensor: Path | str, width_px: int) -> Sensor:
    from workbench.sensor.pack import is_pack
    from workbench.sensor.sensor import Sensor

    return Sensor.load(sensor, width_px=None if is_pack(Path(sensor)) else width_px)
