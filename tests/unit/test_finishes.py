"""Finishes of surfaces: each node of the 3D view gets its own, by a script that is one HTML."""

from __future__ import annotations

import html
import re

import pytest

from ui.patches.materials import (
    ANODISED,
    FINISHES,
    GLASS,
    LIT,
    RESIN,
    SILICONE,
    Finish,
    finish,
)
from ui.scene.camera_body import BARREL_MM, turned
from workbench.view.glb import MATT


@pytest.mark.parametrize(
    ("node", "wanted"),
    [
        ("/sensor/skin/skin", SILICONE),
        ("/sensor/rigid/support", RESIN),
        ("/sensor/foot/foot", ANODISED),
        ("/leds/3", LIT),
        ("/camera_2/lens", GLASS),
    ],
)
def test_nodes_have_their_finish(node: str, wanted: Finish) -> None:
    """The first prefix counts."""
    found = next(each for prefix, each in FINISHES.items() if node.startswith(prefix))
    assert found is wanted


def test_a_pressed_skin_looks_as_at_rest() -> None:
    """Frames of a press are files with their own material; the eye must not see the change."""
    assert MATT["pbrMetallicRoughness"]["roughnessFactor"] == SILICONE.roughness


def test_the_script_names_all_finishes() -> None:
    """Placeholders are gone, and what an attribute of HTML would end is escaped."""
    written = finish()
    script = html.unescape(re.findall(r'onload="([^"]*)"', written)[0])
    assert "FINISHES" not in script and "AGAIN" not in script
    for prefix in FINISHES:
        assert f'"{prefix}"' in script


def test_a_camera_body_is_turned_about_its_axis() -> None:
    """It reaches as far as its outline, and no farther forward than the pinhole."""
    points, faces = turned(BARREL_MM)
    assert points[:, 2].max() < 0.0
    assert (points[:, :2] ** 2).sum(axis=1).max() ** 0.5 == pytest.approx(1.5)
    assert faces.max() == len(points) - 1
