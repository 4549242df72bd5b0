"""Forces by finite elements as tables: ours, and ours beside another program's."""

from __future__ import annotations

import dataclasses
import io
from collections.abc import Sequence
from typing import Any

import numpy as np

from workbench.core.result.force_field import ForceField

MOVED_MM = 0.1
"""Displacements are compared where either result moves by this much."""


def beside(ours: ForceField, theirs: ForceField) -> dict[str, Any]:
    """Totals of both, frame by frame."""
    frames = [
        {
            "frame": frame + 1,
            "normal_N": float(ours.normal_N[frame]),
            "their_normal_N": float(theirs.normal_N[frame]),
            "ratio": _ratio(ours.normal_N[frame], theirs.normal_N[frame]),
            "tangential_N": float(ours.tangential_N[frame]),
            "their_tangential_N": float(theirs.tangential_N[frame]),
            "their_balance": float(theirs.balance[frame]),
            "displacement_rms_mm": _rms(ours, theirs, frame),
        }
        for frame in range(len(ours.reaction_N))
    ]
    return {"ours": ours.solver, "theirs": theirs.solver, "frames": frames}


def _ratio(ours_N: float, theirs_N: float) -> float:
    return float(ours_N / theirs_N) if theirs_N else float("nan")


def _rms(ours: ForceField, theirs: ForceField, frame: int) -> float:
    """Root mean square of the difference of displacements where either moves by `MOVED_MM`."""
    pair = ours.displacement_mm[frame], theirs.displacement_mm[frame]
    moved = np.maximum(*(np.linalg.norm(one, axis=1) for one in pair)) > MOVED_MM
    away = np.linalg.norm(pair[0] - pair[1], axis=1)[moved]
    return float(np.sqrt((away**2).mean())) if moved.any() else 0.0


def columns(found: ForceField, depths_mm: Sequence[float]) -> dict[str, np.ndarray]:
    """Totals of each frame, each of shape (K,)."""
    tangent_v = np.cross(found.normal, found.tangent_u)
    return {
        "frame": np.arange(1, len(depths_mm) + 1),
        "depth_mm": np.asarray(depths_mm),
        "normal_N": found.normal_N,
        "tangential_u_N": found.reaction_N @ found.tangent_u,
        "tangential_v_N": found.reaction_N @ tangent_v,
        **({"sliding_share": found.sliding_share} if len(found.sliding_share) else {}),
        "residual": found.residual,
        "balance": found.balance,
        "converged": found.converged.astype(int),
        "increments": found.increments,
        **({"force_error": found.force_error} if len(found.force_error) else {}),
    }


def frame_rows(found: ForceField, depths_mm: Sequence[float]) -> list[dict[str, Any]]:
    """The same, frame by frame."""
    table = columns(found, depths_mm)
    return [
        {name: values[frame].item() for name, values in table.items()}
        for frame in range(len(depths_mm))
    ]


def npz_bytes(found: ForceField) -> bytes:
    """All fields of a result as an `.npz` file."""
    buffer = io.BytesIO()
    arrays = {
        item.name: np.asarray(getattr(found, item.name)) for item in dataclasses.fields(found)
    }
    np.savez_compressed(buffer, allow_pickle=False, **arrays)
    return buffer.getvalue()
