"""The press that the options of `workbench run` and `workbench sweep` describe.

A sequence of the family brings its own target, path and drives; object, depth, frames and solver
are its own unless the options name them.
"""

from __future__ import annotations

import argparse
import dataclasses
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from workbench.core.base.errors import DesignError, shown
from workbench.core.design.design import SensorDesign
from workbench.core.press.indenter import BALL, Indenter
from workbench.core.press.motion import Mover
from workbench.core.press.press import Extent, Method, Press
from workbench.core.press.soft_body import SoftBody
from workbench.core.press.texture import Texture
from workbench.core.press.trajectory import Trajectory

if TYPE_CHECKING:
    from workbench.core.press.press_case import PressCase

SETTINGS = ("grid_mm", "region_error", "max_substeps", "tolerance", "penalty")
"""Options that are fields of `ContactSettings` as they stand."""
PATH = ("target", "shear_mm", "twist_deg", "stroke", "trajectory", "every_s")
NOT_WITH_SEQUENCE = (*PATH, "mover", "object_pose")
NOT_WITH_TRAJECTORY = ("depth_mm", "shear_mm", "twist_deg", "frames", "stroke")
"""Options that would change nothing, which nobody expects of what they typed."""
EXAMPLES = {
    "--target": ("0,10,35", "x, y, z in mm"),
    "--shear-mm": ("0.5,0", "along U and V in mm"),
    "--turn-deg": ("180,0,0", "degrees about X, then Y, then Z"),
    "--object-pose": ("0,0,20,1,0,0,0", "x, y, z in mm, then the unit quaternion qw, qx, qy, qz"),
}
"""What may be typed, and what it means."""


def press_case(
    options: argparse.Namespace,
    design: SensorDesign,
    target_mm: tuple[float, float, float],
    held: PressCase | None = None,
) -> PressCase:
    """What is pressed, where, and how it is computed.

    Args:
        options: Those of `press_arguments`.
        design: What is pressed on.
        target_mm: Where to, if the options do not say.
        held: What stands where the options name nothing; without it the defaults.

    Raises:
        DesignError: If a value is refused, or object or sequence are unknown.
    """
    from workbench.core.press.press_case import PressCase

    base = PressCase() if held is None else held
    if options.sequence is not None:
        return _sequence(options, design)
    return PressCase(
        indenter=_indenter(options, None if held is None else held.indenter),
        press=_press(options, target_mm, base.press),
        settings=dataclasses.replace(base.settings, **_settings(options)),
    )


def _sequence(options: argparse.Namespace, design: SensorDesign) -> PressCase:
    from workbench.edit.sequences import FRAMES, find_sequence, sequence

    _refuse(options, NOT_WITH_SEQUENCE, "sequence")
    named = (options.indenter, options.size_mm, options.edge_radius_mm, options.texture)
    named = (*named, options.soft_mpa, options.turn_deg)
    indenter = None if all(value is None for value in named) else _indenter(options)
    chosen = find_sequence(design, options.sequence)
    if options.depth_mm is not None:
        chosen = dataclasses.replace(chosen, depth_mm=options.depth_mm)
    return sequence(
        design,
        chosen,
        indenter=indenter,
        frames=FRAMES if options.frames is None else options.frames,
        settings=_settings(options),
    )


def _refuse(options: argparse.Namespace, names: Iterable[str], path: str) -> None:
    """Refuse options that the option `path`, or what the design file has of it, has no use for."""
    given = getattr(options, path)
    what = f"the {path} of the design file" if given is None else f"--{path} {given}"
    for name in names:
        if getattr(options, name) not in (None, []):
            option = f"--{name.replace('_', '-')}"
            raise DesignError(
                f"{option} is given with {what}, which has its own path",
                hint=f"leave {option} out" if given is None else f"leave {option} or --{path} out",
                at=option,
            )


def _indenter(options: argparse.Namespace, held: Indenter | None = None) -> Indenter:
    """The object that the options name; of the one that is held, what they change."""
    from workbench.edit.indenter_choice import choose_indenter, choose_texture

    texture = choose_texture(options.texture) if options.texture else None
    if options.indenter is None and held is not None:
        found = _changed(options, held, texture)
    else:
        found = choose_indenter(
            BALL.value if options.indenter is None else options.indenter,
            size_mm=options.size_mm,
            edge_radius_mm=options.edge_radius_mm,
            texture=texture,
        )
    if options.soft_mpa is not None:
        found = dataclasses.replace(found, soft=SoftBody(young_MPa=options.soft_mpa))
    if options.turn_deg is None:
        return found
    return dataclasses.replace(found, turn_deg=typed_numbers(options.turn_deg, at="--turn-deg"))


def _changed(options: argparse.Namespace, held: Indenter, texture: Texture | None) -> Indenter:
    """An object with the size, edges and texture that the options name."""
    from workbench.edit.indenter_edit import resized, rounded, textured

    if options.size_mm is not None:
        held = resized(held, options.size_mm)
    if options.edge_radius_mm is not None:
        held = rounded(held, options.edge_radius_mm)
    return held if texture is None else textured(held, texture)


def _press(
    options: argparse.Namespace, target_mm: tuple[float, float, float], held: Press
) -> Press:
    from workbench.edit.strokes import read_stroke

    shear, standing = options.shear_mm, options.object_pose
    timed = options.trajectory is not None or held.trajectory is not None
    if timed:
        _refuse(options, NOT_WITH_TRAJECTORY, "trajectory")
    if options.trajectory is not None:
        # It takes the place of the whole path.
        held = Press()
    frames = held.frames if options.frames is None else options.frames
    mover = held.mover if options.mover is None else Mover(options.mover)
    pose = held.object_pose if standing is None else typed_numbers(standing, at="--object-pose")
    strokes = tuple(read_stroke(text, frames=frames) for text in options.stroke)
    if timed and (mover is Mover.OBJECT or pose is not None):
        # Otherwise the object stands where it touches the target.
        _refuse(options, ("target",), "trajectory")
    return dataclasses.replace(
        held,
        target_mm=typed_numbers(options.target, at="--target") if options.target else target_mm,
        depth_mm=held.depth_mm if options.depth_mm is None else options.depth_mm,
        shear_mm=held.shear_mm if shear is None else typed_numbers(shear, at="--shear-mm"),
        twist_deg=held.twist_deg if options.twist_deg is None else options.twist_deg,
        frames=frames,
        strokes=strokes or held.strokes,
        trajectory=_trajectory(options) or held.trajectory,
        mover=mover,
        object_pose=pose,
    )


def _trajectory(options: argparse.Namespace) -> Trajectory | None:
    from workbench.edit.trajectories import read_trajectory

    if options.trajectory is not None:
        return read_trajectory(options.trajectory, every_s=options.every_s or 0.0)
    if options.every_s is not None:
        raise DesignError(
            f"--every-s {options.every_s:g} s is given without a trajectory",
            hint="add --trajectory FILE.csv, or leave --every-s out",
            at="--every-s",
        )
    return None


def _settings(options: argparse.Namespace) -> dict[str, Any]:
    """Fields of `ContactSettings` that the options name."""
    given = {name: getattr(options, name) for name in SETTINGS}
    if options.extent is not None:
        given["extent"] = Extent(options.extent)
    if options.method is not None:
        given["method"] = Method(options.method)
    return {name: value for name, value in given.items() if value is not None}


def typed_numbers(text: str, *, at: str) -> Any:
    """The numbers of an option of `EXAMPLES`.

    Raises:
        DesignError: If there are others than it takes.
    """
    example, what = EXAMPLES[at]
    count = len(example.split(","))
    try:
        values = tuple(float(part) for part in text.split(","))
    except ValueError:
        values = ()
    if len(values) != count:
        raise DesignError(
            f"{at} is {shown(text)}, expected {count} numbers separated by commas: {what}",
            hint=f"for example {at} {example}",
            at=at,
        )
    return values
