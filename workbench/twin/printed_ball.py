"""A ball from a printer: its diameter is off, and its surface stands in layers.

At the height z of the printing axis the surface lies

    (a / 2 pi) s(z) sin(2 pi z / a)

outside the ball, with a the height of a layer: where the ball is flat, each layer is a terrace
with a rounded edge. Toward the sides a wave is only a / sin(theta) long on the surface. Where that
falls from `WHOLE` to `NONE` samples of the distance by which solvers know the object, s fades from
1 to 0: shorter waves they would read as others.
Left out: supports, strings, and what a nozzle cannot fill.
"""

from __future__ import annotations

import numpy as np

from workbench.core.press.indenter import OF_TRIANGLES, Indenter, IndenterMesh

SAMPLE_MM = 0.1
"""Distance of the samples of an object (`FemSettings.sampling_mm`) [mm]."""
WHOLE, NONE = 4.0, 2.0
RING_MM = 0.02
"""Distance of rings of the mesh near the pole that touches; elsewhere a few degrees."""
FINE_SHARE = 0.7
"""Sine of the polar angle up to which rings are fine [1]."""
AROUND = 96
"""Facets around."""


def printed_ball(diameter_mm: float, layer_mm: float) -> Indenter:
    """A printed ball, its printing axis along the press.

    Args:
        diameter_mm: Of the ball between layers.
        layer_mm: Height of a layer; 0 leaves it smooth.
    """
    radius_mm = 0.5 * diameter_mm
    fine = np.arcsin(np.linspace(0.0, FINE_SHARE, max(8, round(FINE_SHARE * radius_mm / RING_MM))))
    coarse = np.linspace(fine[-1], np.pi, 64)[1:]
    polar = np.concatenate([fine, coarse])
    grown_mm = radius_mm + layer_relief_mm(polar, radius_mm, layer_mm)
    # The pole of angle 0 is the one that meets the skin: body -Z.
    points, faces = _lathed(grown_mm * np.sin(polar), -grown_mm * np.cos(polar))
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    mesh = IndenterMesh(points_mm=points - middle, faces=faces)
    return Indenter(kind=OF_TRIANGLES, size_mm=float(np.ptp(points, axis=0).max()), mesh=mesh)


def layer_relief_mm(polar: np.ndarray, radius_mm: float, layer_mm: float) -> np.ndarray:
    """Height of the surface over the ball [mm] at polar angles from the pole, same shape."""
    if layer_mm <= 0.0:
        return np.zeros_like(polar)
    height_mm = radius_mm * (1.0 - np.cos(polar))
    samples = layer_mm / (SAMPLE_MM * np.maximum(np.sin(polar), 1e-9))
    share = np.clip((samples - NONE) / (WHOLE - NONE), 0.0, 1.0)
    # The far pole is held, not pressed.
    share = np.where(polar < 0.5 * np.pi, share, 0.0)
    return layer_mm / (2.0 * np.pi) * share * np.sin(2.0 * np.pi * height_mm / layer_mm)


def _lathed(across_mm: np.ndarray, along_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Closed body of revolution about Z from pole to pole, upward: points (N, 3), faces (M, 3)."""
    angle = 2.0 * np.pi * np.arange(AROUND) / AROUND
    rings = np.stack(
        [
            np.outer(across_mm[1:-1], np.cos(angle)),
            np.outer(across_mm[1:-1], np.sin(angle)),
            np.repeat(along_mm[1:-1, None], AROUND, axis=1),
        ],
        axis=2,
    ).reshape(-1, 3)
    poles = np.array([[0.0, 0.0, along_mm[0]], [0.0, 0.0, along_mm[-1]]])
    points = np.concatenate([rings, poles])
    here, after = np.arange(AROUND), (np.arange(AROUND) + 1) % AROUND
    low, high = len(rings), len(rings) + 1
    last = AROUND * (len(across_mm) - 3)
    faces = [np.column_stack([np.full(AROUND, low), after, here])]
    for ring in range(len(across_mm) - 3):
        one, two = AROUND * ring, AROUND * (ring + 1)
        faces.append(np.column_stack([one + here, one + after, two + after]))
        faces.append(np.column_stack([one + here, two + after, two + here]))
    faces.append(np.column_stack([np.full(AROUND, high), last + here, last + after]))
    return points, np.concatenate(faces).astype(np.int32)
