"""Arrays to display images and colours, with legends and units."""

from __future__ import annotations

import html
from typing import Any

import numpy as np

VIRIDIS = np.array(
    [
        (0.2777273, 0.0054073, 0.3340998),
        (0.1050930, 1.4046135, 1.3845902),
        (-0.3308618, 0.2148476, 0.0950952),
        (-4.6342305, -5.7991010, -19.3324410),
        (6.2282700, 14.1799334, 56.6905526),
        (4.7763850, -13.7451454, -65.3530326),
        (-5.4354559, 4.6458526, 26.3124352),
    ]
)
"""Polynomial in t of the viridis map: uniform, colour-blind safe. Source: M. Zucker, CC0."""


REST_SHARE = 0.05
"""Below this share of the maximum the colour of rest shows through."""


def viridis(share: np.ndarray) -> np.ndarray:
    """Colours, shape (N, 3) uint8, of values in [0, 1], shape (N,)."""
    t = np.clip(np.nan_to_num(share), 0.0, 1.0)[:, None]
    colour = np.zeros((len(t), 3))
    for coefficient in VIRIDIS[::-1]:
        colour = colour * t + coefficient
    return (np.clip(colour, 0.0, 1.0) * 255).astype(np.uint8)


def heat_colours(share: np.ndarray, rest: tuple[int, int, int]) -> np.ndarray:
    """Viridis where something happens, the colour `rest` where nothing does, shape (N, 3) uint8."""
    strength = np.clip(share / REST_SHARE, 0.0, 1.0)[:, None]
    return ((1 - strength) * np.array(rest) + strength * viridis(share)).astype(np.uint8)


def coloured_glb(points: np.ndarray, faces: np.ndarray, colours: np.ndarray) -> bytes:
    """A mesh with a colour at each vertex as a GLB file with a matt material."""
    import trimesh

    mesh = trimesh.Trimesh(points, faces, process=False, vertex_colors=colours)
    mesh.vertex_normals  # noqa: B018 - computed now, so that the file carries smooth normals

    def matt(tree: dict[str, Any]) -> None:
        # Without a material glTF means polished metal, which is black without an environment.
        tree["materials"] = [
            {
                "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.7},
                "doubleSided": True,
            }
        ]
        for part in tree["meshes"]:
            for primitive in part["primitives"]:
                primitive["material"] = 0

    scene = trimesh.Scene(mesh)
    return scene.export(file_type="glb", include_normals=True, tree_postprocessor=matt)  # pyright: ignore


def difference(image: np.ndarray, background: np.ndarray) -> tuple[np.ndarray, int]:
    """The change about mid grey, and the factor that makes it visible (at most 8).

    The brightest twentieth of the changed pixels may saturate, as one sparkle would hide the rest.
    """
    change = image.astype(np.int16) - background.astype(np.int16)
    size = np.abs(change[change != 0])
    gain = max(1, min(8, int(127 // np.percentile(size, 95)))) if size.size else 1
    return np.clip(128 + gain * change, 0, 255).astype(np.uint8), gain


def placeholder(width_px: int = 320, height_px: int = 240) -> np.ndarray:
    """A grey image that stands where none has been rendered."""
    return np.full((height_px, width_px, 3), 70, np.uint8)


def legend(title: str, high: float, unit: str, rest: tuple[int, int, int]) -> str:
    """A colour bar from 0 as HTML, in the colours of `heat_colours`."""
    stops = heat_colours(np.r_[0.0, 0.025, np.linspace(0.05, 1, 20)], rest)
    colours = ", ".join(f"rgb({r},{g},{b})" for r, g, b in stops)
    return (
        f"<div style='font-size:12px;margin:4px 12px'>{html.escape(title)}"
        f"<div style='height:10px;border-radius:3px;background:linear-gradient(90deg,{colours})'>"
        f"</div><div style='display:flex;justify-content:space-between'><span>0</span>"
        f"<span>{high:.3g} {html.escape(unit)}</span></div></div>"
    )
