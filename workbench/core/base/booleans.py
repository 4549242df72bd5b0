"""Booleans on B-rep bodies that check what came back.

The CAD kernel (OCCT) fails silently: it returns the uncut body, an empty one or one that lost a
feature, with `is_valid` true. So every operation states what it must have done to the volume, the
bounding box and the number of pieces, and is refused when it did not.

Bodies are duck-typed (as build123d's `Shape`: `volume`, `is_valid`, `bounding_box(optimal=...)`,
`solids()` and the operators `-`, `+`, `&`), so this module imports no CAD package.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, cast

from workbench.core.base.errors import GeometryError

TRIVIAL_MM3 = 1e-6
"""Smallest change of volume that counts as one [mm3]; OCCT volumes repeat to about 1e-9."""
BOX_SLACK_MM = 0.05
"""Growth of a bounding box that is tolerance, not material [mm]: OCCT pads boxes of splines."""


class Limits(NamedTuple):
    """Open interval in which the volume of a result must lie [mm3]."""

    low_mm3: float
    high_mm3: float


def cut(body: Any, tool: Any, *, what: str) -> Any:
    """The body without the tool; the volume must fall, and by no more than the tool's.

    Args:
        what: Name of the feature, for the message.

    Raises:
        GeometryError: If the tool missed, the body vanished, fell apart or grew.
    """
    before, removed = volume(body), volume(tool)
    limits = Limits(max(0.0, before - removed - _slack(before)), before)
    result = body - tool
    return _checked(result, "cut", what, (before, removed), limits, (body,))


def fuse(body: Any, tool: Any, *, what: str) -> Any:
    """The body and the tool, or a list of them, as one; the volume must grow, and not by more.

    Raises:
        GeometryError: If nothing was added, or the result is not one solid.
    """
    before, added = volume(body), volume(tool)
    limits = Limits(max(before, added), before + added + _slack(before))
    result = body + tool
    tools: Sequence[Any] = cast("list[Any]", tool) if isinstance(tool, list) else [tool]
    return _checked(result, "fuse", what, (before, added), limits, (body, *tools))


def intersect(body: Any, tool: Any, *, what: str) -> Any:
    """The common part of body and tool; it must not be empty, nor all of the body.

    Raises:
        GeometryError: If they do not overlap, the tool holds the whole body, or the
            result is not one solid.
    """
    before, other = volume(body), volume(tool)
    limits = Limits(0.0, min(before, other + _slack(other)))
    result = body & tool
    return _checked(result, "intersect", what, (before, other), limits, (body,))


def fillet(
    body: Any,
    radius_mm: float,
    edges: Sequence[Any],
    *,
    what: str,
    removes_mm3: tuple[float, float],
) -> Any:
    """The body with convex edges rounded; the volume must fall by an amount between two bounds.

    Args:
        radius_mm: Radius of the rounding.
        edges: Edges of the body, at least one.
        removes_mm3: Least and most volume the rounding may remove; (1 - pi/4) r^2 times the
            length of the edges is the amount for right angles.

    Raises:
        GeometryError: If the kernel gave up, or the volume, the box or the number of pieces is
            wrong.
    """
    before, most = volume(body), removes_mm3[1]
    limits = Limits(before - most, before - removes_mm3[0])
    name = f"{what} {radius_mm:g} mm"
    if not edges:
        raise _failed(f"fillet of {name}", "there is no edge to round")
    try:
        result = body.fillet(radius_mm, edges)
    # build123d turns the kernel's refusal into a ValueError; OCCT's own are RuntimeErrors.
    except (ValueError, RuntimeError) as error:
        # Its words name functions of the library, which mean nothing to a designer.
        raise _failed(f"fillet of {name}", "it could not be built") from error
    return _checked(result, "fillet", name, (before, most), limits, (body,))


def expect_volume(body: Any, expected_mm3: float, *, what: str, relative: float = 1e-6) -> Any:
    """The body, if it is valid, one solid and has the volume known in closed form.

    Raises:
        GeometryError: If not; OCCT's volumes of revolved ellipses are good to about 1e-9.
    """
    found_mm3 = volume(body)
    story = f"{what}: expected {expected_mm3:.6g} mm3, result {found_mm3:.6g} mm3"
    if abs(found_mm3 - expected_mm3) > relative * abs(expected_mm3):
        raise _failed(story, "the volume is wrong")
    if not _valid(body) or len(body.solids()) != 1:
        raise _failed(story, "the body is not one valid solid")
    return body


def volume(body: Any) -> float:
    """Volume of a body or of a list of bodies [mm3]; 0 for None, which OCCT returns for empty."""
    if body is None:
        return 0.0
    # The kernel integrates anew every time, for up to 50 ms: kept with the shape it belongs to.
    kept = getattr(body, "_kept_volume", None)
    if kept is not None and kept[0] is body.wrapped:
        return kept[1]
    found_mm3 = getattr(body, "volume", None)
    if found_mm3 is None:
        return sum(volume(item) for item in body)
    # An empty body refuses to show its shape.
    if found_mm3 and hasattr(body, "wrapped"):
        body._kept_volume = (body.wrapped, float(found_mm3))
    return float(found_mm3)


def _valid(body: Any) -> bool:
    """Whether the kernel calls a body valid: its 5 ms are spent once for each shape."""
    kept = getattr(body, "_kept_valid", None)
    if kept is not None and kept[0] is body.wrapped:
        return kept[1]
    found = bool(body.is_valid)
    if found and hasattr(body, "wrapped"):
        body._kept_valid = (body.wrapped, found)
    return found


def _slack(size_mm3: float) -> float:
    return TRIVIAL_MM3 + 1e-6 * abs(size_mm3)


def _checked(
    result: Any,
    operation: str,
    what: str,
    volumes: tuple[float, float],
    limits: Limits,
    within: tuple[Any, ...],
) -> Any:
    after = volume(result)
    story = (
        f"{operation} of {what}: body {volumes[0]:.6g} mm3, tool {volumes[1]:.6g} mm3, "
        f"result {after:.6g} mm3"
    )
    low_mm3, high_mm3 = limits.low_mm3 + TRIVIAL_MM3, limits.high_mm3 - TRIVIAL_MM3
    if not low_mm3 < after < high_mm3:
        raise _failed(story, f"expected {limits.low_mm3:.6g} to {limits.high_mm3:.6g} mm3")
    if not _valid(result):
        raise _failed(story, "the body is not valid")
    if not _inside(result, within):
        raise _failed(story, "the body grew beyond its bounding box")
    found = len(result.solids())
    if found != 1:
        raise _failed(story, f"{found} pieces instead of 1")
    return result


def _failed(story: str, reason: str) -> GeometryError:
    return GeometryError(
        f"{story}; {reason}",
        hint="change the last parameter a little, or make the feature larger or smaller",
        at="shape",
    )


def _inside(result: Any, bodies: tuple[Any, ...]) -> bool:
    # Exact boxes of surfaces of revolution take 0.1 s each, loose ones 0.1 ms; a loose box may
    # stand out by the control points of a trimmed surface, so only then is the exact one asked.
    return any(_within_boxes(result, bodies, optimal=optimal) for optimal in (False, True))


def _within_boxes(result: Any, bodies: tuple[Any, ...], *, optimal: bool) -> bool:
    boxes = [body.bounding_box(optimal=optimal) for body in bodies]
    inner = result.bounding_box(optimal=optimal)
    return all(
        getattr(inner.min, axis) >= min(getattr(box.min, axis) for box in boxes) - BOX_SLACK_MM
        and getattr(inner.max, axis) <= max(getattr(box.max, axis) for box in boxes) + BOX_SLACK_MM
        for axis in "XYZ"
    )
