"""The files of a Taxim pack: what each of the programs looks for, under the names it looks for."""

from __future__ import annotations

import io
import json
from typing import Any

import numpy as np

from workbench.core.base.errors import StoreError
from workbench.taxim.dents import SIZE_MM
from workbench.taxim.programs import DARKER, SHARE, SIGMA_PX, Program
from workbench.taxim.table import BINS

DIRECTION_RAD, HEIGHTS = 0.1, 9
"""Steps of Taxim's table of shadows: directions [rad], heights."""
PYRAMID_PX = (51, 21, 11, 5, 3, 2)
"""Kernels of the dents' slopes, of Taxim for 640 x 480."""
NOTHING = 255.0
"""A shadow that darkens nothing."""


def files_of(
    program: Program, rest: np.ndarray, table: np.ndarray, mm_per_px: float
) -> dict[str, bytes]:
    """The files for a program by name.

    Args:
        program: Which.
        rest: The image at rest, red, green, blue, shape (H, W, 3), uint8.
        table: Shape (125, 125, 6, 3), red, green, blue.
        mm_per_px: Scale.
    """
    turned = table[..., ::-1] if program.reversed_colours else table
    names = ("grad_r", "grad_g", "grad_b")
    grads = {name: turned[..., colour].copy() for colour, name in enumerate(names)}
    polynomials = _npz(bins=np.array(BINS), **grads)
    if not program.reversed_colours:
        return {
            "polycalib.npz": polynomials,
            "bg.jpg": _jpeg(rest),
            "real_bg.npy": _npy(rest.astype(float)),
        }
    rows, columns = rest.shape[:2]
    flat = np.zeros((rows, columns))
    return {
        "polycalib.npz": polynomials,
        "dataPack.npz": _npz(f0=np.ascontiguousarray(rest[..., ::-1])),
        "shadowTable.npz": _npz(**_no_shadows()),
        # One array under the names of Taxim and of TacEx.
        "gelmap5.npy": _npy(flat),
        "gelmap.npy": _npy(flat),
        "params.json": f"{json.dumps(_parameters(rows, columns, mm_per_px), indent=1)}\n".encode(),
        "sensorParams.py": _sensor_parameters(rows, columns, mm_per_px).encode(),
    }


def _sensor_parameters(rows: int, columns: int, mm_per_px: float) -> str:
    """Taxim's `Basics/sensorParams.py`; d is not read."""
    return (
        f"ball_radius = {SIZE_MM / 2:g}\n"
        f"pixmm = {mm_per_px:.6g}\n"
        f"numBins = {BINS}\n"
        f"h = {rows}\n"
        f"w = {columns}\n"
        "d = 900\n"
    )


def _parameters(rows: int, columns: int, mm_per_px: float) -> dict[str, Any]:
    """TacEx's `params.json`: Taxim's kernels as shares of the image."""

    def shares(px: float) -> list[float]:
        return [px / columns, px / rows]

    return {
        "simulator": {
            "initial_frame_sigma_rel": shares(SIGMA_PX),
            "diff_threshold": DARKER,
            "frame_mixing_percentage": SHARE,
            "shadow_step_rel": shares(1.25),
            "discretize_precision": DIRECTION_RAD,
            "height_precision": 0.1,
            "fan_angle": 0.1,
            "fan_precision": 0.05,
            "contact_scale": 0.4,
            "deform_pyramid_sigma_rel": [
                [px / columns for px in PYRAMID_PX],
                [px / rows for px in PYRAMID_PX],
            ],
            "deform_final_sigma_rel": shares(2.0),
            "shadow_blur_sigma_rel": shares(2.0),
            "shadow_attachment_kernel_size_rel": shares(5.0),
        },
        "sensor": {"pixmm": mm_per_px, "num_bins": BINS, "w": columns, "h": rows},
    }


def _no_shadows() -> dict[str, np.ndarray]:
    """A table of shadows that darken nothing: without one the program does not start."""
    directions = np.arange(0.0, 2.0 * np.pi, DIRECTION_RAD)
    table = np.empty((3, len(directions), HEIGHTS), dtype=object)
    for place in np.ndindex(table.shape):
        table[place] = [NOTHING]
    return {"shadowDirections": directions, "shadowTable": table}


def _npz(**arrays: np.ndarray) -> bytes:
    out = io.BytesIO()
    # Objects go as pickles, which Taxim asks for.
    np.savez_compressed(out, **arrays)  # pyright: ignore[reportArgumentType]
    return out.getvalue()


def _npy(array: np.ndarray) -> bytes:
    out = io.BytesIO()
    np.save(out, array)
    return out.getvalue()


def _jpeg(image: np.ndarray) -> bytes:
    import cv2

    whole = [
        cv2.IMWRITE_JPEG_QUALITY,
        100,
        cv2.IMWRITE_JPEG_SAMPLING_FACTOR,
        cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444,
    ]
    done, content = cv2.imencode(".jpg", np.ascontiguousarray(image[..., ::-1]), whole)
    if not done:
        raise StoreError("the image at rest cannot be written as a JPEG", hint="", at="--taxim")
    return content.tobytes()
