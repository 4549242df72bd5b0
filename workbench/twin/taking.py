"""Which frames of a path become photographs, and what a table says of each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.forces.peaks import largest_disc_N
from sim.forces.slip import GROSS_SHARE
from workbench.calibration.seen.photo_set import POSE
from workbench.core.result.force_field import ForceField
from workbench.core.result.results import Skin
from workbench.learning.dataset.photo_labels import DISC_MM2, PEAK
from workbench.learning.dataset.sequences import FRAMES
from workbench.twin.cases import BALL_FRAMES, PRESS_FRAMES, Kind, TwinCase
from workbench.twin.draw import Draws, Twin, stream
from workbench.twin.stage import Stage

LABELS = (
    *("photo", "object", "place", "sequence", "frame", "slip", "depth_mm", PEAK),
    *("force_x_N", "force_y_N", "force_z_N", *POSE),
)
"""Columns of `labels.csv`; the pose is where the object touched first, in the sensor frame."""
NUMBERS = {Kind.CALIBRATION: 1, Kind.PRESS: 2, Kind.SLIDE: 3}
OF_A_KIND, OF_A_CASE = 2**24, 2**6
"""Room for cases of a kind, and for photographs of a case, in the numbers of photographs."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Taken:
    """One photograph that is to be taken."""

    name: str
    """Of its files, without ending; unique within a twin."""
    case: TwinCase
    frame: int
    number: int
    """That its photons and noise follow from."""
    sequence: str = ""
    """Of slides: which one, the frame's number in it, and whether all slides at its end."""
    place_in_sequence: int = 0
    slip: bool = False

    @property
    def marked(self) -> bool:
        """Whether dots are printed on the skin: on images of slides."""
        return self.case.kind is Kind.SLIDE


def photos_of(twin: Twin, case: TwinCase, field: ForceField) -> list[Taken]:
    """The photographs of a solved path, in order; none of a slide that does not slip in time."""
    if case.kind is Kind.SLIDE:
        return _sequences(twin, case, field)
    frames = BALL_FRAMES if case.kind is Kind.CALIBRATION else PRESS_FRAMES
    return [
        Taken(
            name=f"{case.id}_{frame}",
            case=case,
            frame=frame,
            number=_number(case, frame),
        )
        for frame in range(frames)
    ]


def ball_row(taken: Taken, field: ForceField, ball_mm: float, stage: Stage) -> dict[str, str]:
    """A photograph's line of `presses.csv`: what its builder knows of it.

    Args:
        taken: Of a ball.
        field: The solved path.
        ball_mm: Diameter of the ball as its printer was told.
        stage: What pressed it.
    """
    told = stage.told_mm(field.target_mm, taken.case.number)
    pose = {name: f"{value:.3f}" for name, value in zip(POSE, told, strict=True)}
    return {"photo": f"{taken.name}.png", "ball_mm": f"{ball_mm:g}", **pose}


def label_row(taken: Taken, field: ForceField, skin: Skin) -> dict[str, str]:
    """A photograph's line of `labels.csv`; its peak is that of `photo_labels`.

    Args:
        taken: The photograph.
        field: The solved path.
        skin: The outer one, at rest, that the object's forces act on.
    """
    frame, case = taken.frame, taken.case
    peak_N = largest_disc_N(skin, field.contact_force_N[frame].astype(np.float64))
    force = dict(zip("xyz", -field.reaction_N[frame], strict=True))
    row = {
        "photo": f"{taken.name}.png",
        "object": case.name,
        "place": case.place,
        "depth_mm": f"{case.depth_at_mm(frame):.4f}",
        PEAK: f"{peak_N / DISC_MM2:.6f}",
        **{f"force_{axis}_N": f"{value:.6f}" for axis, value in force.items()},
        **{name: f"{value:.4f}" for name, value in zip(POSE, field.target_mm, strict=True)},
    }
    if taken.sequence:
        row |= {
            "sequence": taken.sequence,
            "frame": str(taken.place_in_sequence),
            "slip": str(int(taken.slip)),
        }
    return row


def onset(case: TwinCase, share: np.ndarray) -> int | None:
    """First frame of gross slip of a slide, from 0; None where it never comes.

    The rule of `workbench.learning.dataset.sequences`.

    Args:
        case: A slide.
        share: Share of the contact that slides, frame by frame, shape (K,).
    """
    first = case.press.frames
    whole = np.flatnonzero(share[first:] >= GROSS_SHARE)
    return first + int(whole[0]) if len(whole) else None


def _sequences(twin: Twin, case: TwinCase, field: ForceField) -> list[Taken]:
    """One sequence that ends before gross slip and one that ends in it or after."""
    begins = onset(case, field.sliding_share)
    if begins is None or begins < FRAMES:
        return []
    rng = stream(twin.seed, Draws.SLIDES, 2**30 + case.number)
    before = int(rng.integers(FRAMES - 1, begins))
    after = int(rng.integers(begins, len(field.sliding_share)))
    found = []
    for slip, last in ((False, before), (True, after)):
        word = "slip" if slip else "hold"
        for place in range(FRAMES):
            found.append(
                Taken(
                    name=f"{case.id}_{word}{place}",
                    case=case,
                    frame=last + 1 - FRAMES + place,
                    number=_number(case, FRAMES * slip + place),
                    sequence=f"{case.id}_{word}",
                    place_in_sequence=place,
                    slip=slip,
                )
            )
    return found


def _number(case: TwinCase, photo: int) -> int:
    return NUMBERS[case.kind] * OF_A_KIND + case.number * OF_A_CASE + photo
