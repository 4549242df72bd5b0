"""The shadow around a foot: it begins at the foot, ends at its reach, and is a GLB others read."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import trimesh

from tests.unit.test_glb import colours_of, read
from ui.scene.contact_shadow import REACH_MM, STEPS, ContactShadow, rim, sole_outline

RADIUS_MM = 12.0


def foot(radius_mm: float = RADIUS_MM) -> np.ndarray:
    """A cylinder that stands on z = -8."""
    made = trimesh.creation.cylinder(radius_mm, 8.0, sections=60)
    return np.asarray(made.vertices) - [0.0, 0.0, 4.0]


def test_a_round_foot_has_a_round_rim() -> None:
    """Rings of the radius and the reach; a parallel of a polygon of 60 corners is .2 % short."""
    points, dark, faces = rim(sole_outline(foot()))
    away = np.linalg.norm(points[:, :2], axis=1)
    assert away.max() == pytest.approx(RADIUS_MM + REACH_MM, rel=2e-3)
    assert dark[away > RADIUS_MM + REACH_MM - 0.1].max() == 0.0
    assert dark[0] == STEPS[0][1]
    # All faces look up, and together they are the disc.
    a, b, c = (points[faces[:, k]] for k in range(3))
    area = np.cross(b - a, c - a)[:, 2] / 2
    assert area.min() > 0
    assert area.sum() == pytest.approx(np.pi * away.max() ** 2, rel=5e-3)


def test_a_body_on_its_point_has_the_outline_of_what_is_above() -> None:
    """A cone on its tip: what is within 1 mm of it; an edge of a box likewise; a line has none."""
    cone = np.asarray(trimesh.creation.cone(5.0, 10.0, sections=40).vertices) * [1, 1, -1]
    assert len(sole_outline(cone)) >= 3
    box = np.asarray(trimesh.creation.box((4.0, 4.0, 4.0)).vertices)
    turned = box @ np.array([[1, 0, 0], [0, 0.6, -0.8], [0, 0.8, 0.6]])
    assert len(sole_outline(turned)) >= 3
    assert not len(sole_outline(np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 1.0]])))


def test_it_is_made_anew_only_for_another_foot() -> None:
    """Two shapes with one foot share a shadow, which moves to the height; another foot has its own.

    trimesh reads the file; opacities are in it.
    """
    made: list[Any] = []

    def add(name: str, glb: bytes, **words: Any) -> SimpleNamespace:
        made.append(SimpleNamespace(name=name, glb=glb, remove=lambda: None, **words))
        return made[-1]

    shadow = ContactShadow(SimpleNamespace(add_glb=add))
    shadow.follow(foot(), -8.1)
    shadow.follow(foot(), -9.1)
    assert len(made) == 1
    assert made[0].position == (0.0, 0.0, -9.1)
    shadow.follow(foot(15.0), -8.1)
    assert [node.name for node in made] == ["/contact_shadow/1", "/contact_shadow/0"]
    mesh = read(made[0].glb)
    assert mesh.area == pytest.approx(np.pi * (RADIUS_MM + REACH_MM) ** 2, rel=0.01)
    assert mesh.visual.material.alphaMode == "BLEND"
    alpha = colours_of(made[0].glb)[:, 3]
    assert alpha.max() == round(255 * STEPS[0][1])
    assert alpha.min() == 0
