"""Checked booleans refuse what the CAD kernel gets wrong without saying so."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import pytest

from workbench.core.base.booleans import cut, expect_volume, fillet, fuse, intersect
from workbench.core.base.errors import GeometryError


@dataclass
class Fake:
    """A body whose boolean returns whatever it is told to."""

    volume: float
    size: float = 1.0
    is_valid: bool = True
    pieces: int = 1
    result: Any = None

    def bounding_box(self, optimal: bool = True) -> Any:
        corner = self.size
        return SimpleNamespace(
            min=SimpleNamespace(X=-corner, Y=-corner, Z=-corner),
            max=SimpleNamespace(X=corner, Y=corner, Z=corner),
        )

    def solids(self) -> list[Any]:
        return [self] * self.pieces

    def __sub__(self, tool: Any) -> Any:
        return self.result

    __add__ = __and__ = __sub__


TOOL = Fake(2.0)


def test_good_results_pass() -> None:
    """Body 10, tool 2: cut 8.5, fuse 11, intersect 1."""
    for operation, after in ((cut, 8.5), (fuse, 11.0), (intersect, 1.0)):
        good = Fake(after)
        assert operation(Fake(10.0, result=good), TOOL, what="slot") is good


@pytest.mark.parametrize(
    ("operation", "result", "reason"),
    [
        (cut, Fake(10.0), "expected"),
        (cut, Fake(12.0), "expected"),
        (cut, Fake(7.0), "expected"),
        (cut, Fake(0.0), "expected"),
        (cut, None, "expected"),
        (cut, Fake(float("nan")), "expected"),
        (cut, Fake(8.5, is_valid=False), "not valid"),
        (cut, Fake(8.5, size=1.2), "bounding box"),
        (cut, Fake(8.5, pieces=2), "2 pieces instead of 1"),
        (fuse, Fake(10.0), "expected"),
        (fuse, Fake(12.5), "expected"),
        (fuse, Fake(11.0, pieces=2), "2 pieces"),
        (intersect, Fake(0.0), "expected"),
        (intersect, Fake(10.0), "expected"),
        (intersect, None, "expected"),
    ],
)
def test_silent_failures_are_refused(operation: Any, result: Any, reason: str) -> None:
    """Uncut, vanished, grown or broken results raise, naming the operation and all volumes."""
    with pytest.raises(GeometryError, match=reason) as caught:
        operation(Fake(10.0, result=result), TOOL, what="slot")
    for word in (operation.__name__, "slot", "body 10 mm3", "tool 2 mm3"):
        assert word in str(caught.value)
    assert caught.value.hint


def test_kernel_calls_a_missed_cut_valid_and_we_do_not() -> None:
    """OCCT returns the whole 1000 mm3 body with is_valid True when the tool misses it."""
    from build123d import Box, Pos

    body, nail = Box(10, 10, 10), Pos(0, 0, 9) * Box(4, 4, 4)
    missed = body - nail
    assert missed.is_valid
    assert missed.volume == pytest.approx(1000.0)
    with pytest.raises(GeometryError, match="cut of nail"):
        cut(body, nail, what="nail")
    with pytest.raises(GeometryError, match="intersect of nail"):
        intersect(body, nail, what="nail")
    assert cut(body, Pos(0, 0, 5) * nail.moved(Pos(0, 0, -9)), what="nail").volume == (
        pytest.approx(1000.0 - 32.0)
    )


def test_expected_volume_is_held_to() -> None:
    """10 mm3 is not 11 mm3, two solids are not one."""
    assert expect_volume(Fake(10.0), 10.0, what="plug").volume == 10.0
    with pytest.raises(GeometryError, match="expected 11 mm3, result 10 mm3"):
        expect_volume(Fake(10.0), 11.0, what="plug")
    with pytest.raises(GeometryError, match="not one valid solid"):
        expect_volume(Fake(10.0, pieces=2), 10.0, what="plug")


def test_a_fillet_that_fails_names_no_library() -> None:
    """The words of the CAD library stay in the cause; the message names feature and radius."""

    class Unroundable(Fake):
        def fillet(self, radius_mm: float, edges: Any) -> Any:
            raise ValueError("use max_fillet() to find the largest")

    with pytest.raises(GeometryError, match=r"rim 3 mm; it could not be built") as caught:
        fillet(Unroundable(10.0), 3.0, [object()], what="rim", removes_mm3=(0.0, 1.0))
    assert "max_fillet" not in caught.value.message
