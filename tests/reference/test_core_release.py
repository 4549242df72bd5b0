"""Strain of the skin when a bent core leaves it, against the closed form of a bent column."""

from __future__ import annotations

import numpy as np
import pytest

from geometry.body.csg import Body
from geometry.mould.core_release import bend_strain
from workbench.core.result.results import Label, LabelledSurface

LEVELS, AROUND = 121, 72


def column(
    radius_mm: float,
    length_mm: float,
    bend_mm: float,
    narrowing_mm: float = 0.0,
    lean_mm: float = 0.0,
) -> Body:
    """A round column along c = bend (z / L)^2 + lean z / L, narrower at its head, closed."""
    share = np.linspace(0.0, 1.0, LEVELS)
    turn = 2.0 * np.pi * np.arange(AROUND) / AROUND
    radius = radius_mm - narrowing_mm * share
    x = (bend_mm * share**2 + lean_mm * share)[:, None] + radius[:, None] * np.cos(turn)
    y = radius[:, None] * np.sin(turn)
    z = np.broadcast_to(length_mm * share[:, None], x.shape)
    points = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    ring = np.arange(AROUND)
    ahead = np.roll(ring, -1)
    sides = [
        np.concatenate([np.stack([a, b, d], axis=1), np.stack([a, d, c], axis=1)])
        for k in range(LEVELS - 1)
        for a, b in [(k * AROUND + ring, k * AROUND + ahead)]
        for c, d in [(a + AROUND, b + AROUND)]
    ]
    fan = np.stack([np.zeros(AROUND - 2, dtype=int), ring[1:-1], ring[2:]], axis=1)
    caps = [fan[:, ::-1], fan + (LEVELS - 1) * AROUND]
    return Body(points_mm=points, faces=np.concatenate([*sides, *caps]).astype(np.int32))


def skin(body: Body) -> LabelledSurface:
    """The body as the outside of a membrane."""
    labels = np.full(len(body.faces), Label.OUTER, dtype=np.uint8)
    return LabelledSurface(points_mm=body.points_mm, faces=body.faces, labels=labels)


@pytest.mark.parametrize(("length_mm", "bend_mm"), [(30.0, 4.0), (40.0, 6.0), (14.0, 10.0)])
def test_strain_of_a_bent_column(length_mm: float, bend_mm: float) -> None:
    """2 r b / L^2 with r = 10 mm: 8.9 %, 7.5 % and 102 %."""
    core, outer = column(8.0, length_mm, bend_mm), column(10.0, length_mm, bend_mm)
    # Sections are 1/60 of the length apart and chords of 72 sides: 1 %.
    exact = 2.0 * 10.0 * bend_mm / length_mm**2
    assert bend_strain(core, skin(outer)).value == pytest.approx(exact, rel=0.01)


def test_a_bent_column_narrow_enough_for_its_foot_asks_for_nothing() -> None:
    """Wall x = 10 - 8 u + 4 u^2 never turns outward below u = 1; with 5 u^2 it does from 0.8 on."""
    outer = skin(column(12.0, 30.0, 4.0))
    assert bend_strain(column(10.0, 30.0, 4.0, 8.0), outer).value == pytest.approx(0.0, abs=1e-6)
    assert bend_strain(column(10.0, 30.0, 5.0, 8.0), outer).value > 0.01


def test_a_straight_core_asks_for_nothing() -> None:
    """Upright, tapered or leaning: its axis has no curvature."""
    outer = skin(column(12.0, 30.0, 0.0))
    for core in (column(8.0, 30.0, 0.0), column(8.0, 30.0, 0.0, 3.0), column(8.0, 30.0, 0.0, 0, 6)):
        assert bend_strain(core, outer).value == pytest.approx(0.0, abs=1e-6)
