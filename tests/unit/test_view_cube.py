"""The cube in the corner of the view: it shows the faces that the eye sees, as it sees them."""

from __future__ import annotations

import asyncio
import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ui.patches.view_cube import FACES, ViewCube, cube_html, page_axes
from ui.scene.views import TOWARD, Side

KEYS = {side.value: str(number) for number, side in enumerate(Side, start=1)}


def turned(side: Side) -> np.ndarray:
    """Quaternion of a camera that looks from a side with Z up: x right, y down, z forward."""
    forward = -np.array(TOWARD[side], dtype=float)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    matrix = np.column_stack([right, np.cross(forward, right), forward])
    values, vectors = np.linalg.eigh(_quaternion_form(matrix))
    return vectors[:, np.argmax(values)]


def _quaternion_form(matrix: np.ndarray) -> np.ndarray:
    """Its largest eigenvector is the quaternion w, x, y, z of the matrix (Bar-Itzhack 2000)."""
    (a, b, c), (d, e, f), (g, h, i) = matrix
    return np.array(
        [
            [a + e + i, h - f, c - g, d - b],
            [h - f, a - e - i, b + d, c + g],
            [c - g, b + d, e - a - i, f + h],
            [d - b, c + g, f + h, i - a - e],
        ]
    )


def words(html: str) -> list[str]:
    return re.findall(r">(\w+)</button>", html)


@pytest.mark.parametrize("word", FACES)
def test_from_a_side_its_face_alone_is_seen(word: str) -> None:
    """And the face is a square as it lies on the page, its word upright: the unit matrix."""
    html = cube_html(turned(Side(word)), KEYS)
    assert words(html) == [word]
    found = re.search(r"matrix3d\(([^)]*)\)", html)
    assert found is not None
    columns = np.array([float(value) for value in found.group(1).split(",")]).reshape(4, 4)
    assert np.allclose(columns[:3, :3], np.eye(3), atol=2e-3)
    assert f'data-key="{KEYS[word]}"' in html


def test_aslant_three_faces_are_seen() -> None:
    """From (1, 1, 1): right, back and top; Z goes up the page, X to the left and down, Y right."""
    wxyz = turned(Side.ISOMETRIC)
    assert set(words(cube_html(wxyz, KEYS))) == {"Right", "Back", "Top"}
    x, y, z = page_axes(wxyz).T
    assert z[1] < 0 and abs(z[0]) < 1e-9
    assert x[0] < 0 < x[1] and y[0] > 0 and y[1] > 0


def test_a_tab_is_told_once_the_pump_turns_and_only_when_it_has_turned() -> None:
    """A hundred poses between two turns are one message; the same pose again is none."""
    sent: list[str] = []

    class Html:
        content = ""

        def __setattr__(self, name: str, value: Any) -> None:
            object.__setattr__(self, name, value)
            sent.append(value)

    begun: list[Any] = []
    server: Any = SimpleNamespace(
        on_client_connect=begun.append,
        on_client_disconnect=begun.append,
    )
    cube = ViewCube(server, KEYS)
    told: list[Any] = []
    client = SimpleNamespace(
        client_id=2,
        gui=SimpleNamespace(add_html=lambda text: Html()),
        camera=SimpleNamespace(on_update=told.append),
    )
    begun[0](client)
    for side in (Side.FRONT, Side.TOP, Side.RIGHT):
        asyncio.run(told[0](SimpleNamespace(wxyz=turned(side))))
    cube.turn()
    assert len(sent) == 1 and words(sent[0]) == ["Right"]
    asyncio.run(told[0](SimpleNamespace(wxyz=turned(Side.RIGHT))))
    cube.turn()
    begun[1](client)
    asyncio.run(told[0](SimpleNamespace(wxyz=turned(Side.TOP))))
    cube.turn()
    assert len(sent) == 1
