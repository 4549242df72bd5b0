"""Contact: Coulomb's cone point by point, sliding, and the way back to no force."""

from __future__ import annotations

from workbench.core.press.press import ContactSettings
from workbench.proof.row import Row, bounded, compared
from workbench.proof.validation.contact.presses import on_device

CONE_LIMIT = 0.01
FRAMES_MM = (0.5, 0.1)
FRAME_LIMIT = 0.01
RELEASE_SUBSTEPS = 400
RELEASE_LIMIT = 1e-3


def rows() -> list[Row]:
    """All rows of friction."""
    return [*_cone(), *_frames(), *_release()]


def _cone() -> list[Row]:
    from sim.contact.studies import finger, sliding

    def farthest() -> float:
        ratios = sliding.cone_ratios(sliding.slid(FRAMES_MM[0]))
        return float(max(ratios, key=lambda ratio: abs(ratio - sliding.FRICTION)))

    case = (
        f"ball R {sliding.BALL_MM / 2:g} mm, {sliding.DEPTH_MM:g} mm deep in a flat layer of "
        f"{sliding.HEIGHT_MM:g} mm, mu {sliding.FRICTION:g}, {sliding.SLIDE_MM:g} mm of sliding"
    )
    return [
        compared(
            "coulomb_limit",
            "finger, 1 mm deep and 0.5 mm sheared: largest tangential over normal force of a point",
            on_device(lambda: float(finger.sheared_press().friction_ratio[-1])),
            sliding.FRICTION,
            unit="1",
            limit=CONE_LIMIT,
            null=0.0,
        ),
        compared(
            "slip_ratio",
            f"{case}: points' tangential over normal forces, the frame farthest from mu after the "
            f"first {sliding.STICKING_MM:g} mm; null: no friction",
            on_device(farthest),
            sliding.FRICTION,
            unit="1",
            limit=CONE_LIMIT,
            null=0.0,
        ),
    ]


def _frames() -> list[Row]:
    from sim.contact.studies import sliding

    coarse_mm, fine_mm = FRAMES_MM
    case = f"{sliding.SLIDE_MM:g} mm of sliding in frames of {coarse_mm:g} and {fine_mm:g} mm"
    return [
        compared(
            "frame_size",
            f"{case}: {name} force at the end",
            on_device(lambda axis=axis: abs(float(sliding.slid(coarse_mm).reaction_N[-1][axis]))),
            on_device(lambda axis=axis: abs(float(sliding.slid(fine_mm).reaction_N[-1][axis]))),
            unit="N",
            limit=FRAME_LIMIT,
        )
        for name, axis in (("tangential", 0), ("normal", 2))
    ] + [
        compared(
            "frame_size",
            "finger, 1 mm straight in, mu 0.3, frames of 0.1 and 0.05 mm: normal force at the end",
            on_device(lambda: _straight_N(10)),
            on_device(lambda: _straight_N(20)),
            unit="N",
            limit=FRAME_LIMIT,
        )
    ]


def _straight_N(frames: int) -> float:
    from sim.contact.studies import finger

    # The first of twenty frames is too shallow for a finer tolerance in single precision.
    tolerance = ContactSettings().tolerance
    contact = finger.press_45(active_radius_mm=9.0, frames=frames, tolerance=tolerance)
    return float(contact.normal_N[-1])


def _release() -> list[Row]:
    from sim.contact.studies import sliding

    return [
        bounded(
            "release_substeps",
            f"ball lifted clear from {sliding.DEPTH_MM:g} mm in one frame",
            on_device(lambda: sliding.released().substeps),
            unit="1",
            limit=RELEASE_SUBSTEPS,
        ),
        bounded(
            "release_force",
            "reaction left after the same release, over the peak",
            on_device(lambda: sliding.released().residue),
            unit="1",
            limit=RELEASE_LIMIT,
        ),
    ]
