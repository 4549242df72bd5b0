"""What a task's page draws of how its first network learned."""

from __future__ import annotations

import pytest

from workbench.tasks.networks.head import PENALTIES
from workbench.tasks.report import curves
from workbench.tasks.task import Net, Told


@pytest.mark.parametrize(
    ("net", "along"),
    [
        (Net.DENT, "50 steps each"),
        (Net.MOTION, "100 steps each"),
        (Net.MEASURES, "penalty of the regression"),
        (Net.PAPER, "epoch"),
    ],
)
def test_points_are_named_by_what_lies_between_them(net: Net, along: str) -> None:
    """Only networks that see everything once have epochs."""
    drawn = curves([{"train": 1.0, "validation": 0.5}] * len(PENALTIES), Told.VALUES, net)
    assert along in drawn
    assert ("300000" in drawn) == (net is Net.MEASURES)


def test_loss_and_what_is_told_wrong_are_two_lines() -> None:
    """Of classes one is a cross-entropy, the other a share: each has its own stroke and name."""
    drawn = curves([{"train": 2.0, "validation": 0.5}] * 2, Told.CLASS, Net.MOTION)
    strokes = {part.split("'")[1] for part in drawn.split("stroke=")[1:] if "'#" in part[:3]}
    assert len(strokes - {"#d5d9df"}) == 2
    assert "loss of training" in drawn and "told wrong" in drawn


def test_one_point_is_no_curve() -> None:
    """Nothing is drawn of a training that was told once."""
    assert not curves([{"train": 2.0, "validation": 0.5}], Told.CLASS, Net.DENT)
