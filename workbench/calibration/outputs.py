"""What a calibration writes: the calibrated design, its unit, predictions, figures, a report."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from workbench.calibration.calibrate import Calibration
from workbench.calibration.determined import directions, parameters
from workbench.calibration.known_places import apart_mm
from workbench.calibration.report import report
from workbench.calibration.scores import Scored, score
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import Lamp
from workbench.project.design_toml import design_to_toml
from workbench.report.image_files import png_bytes
from workbench.system.whole_files import write_atomically

DESIGN, UNIT, FIGURES, REPORT = "calibrated.toml", "unit.npz", "calibration.json", "report.html"
PREDICTED = "predicted"
FILES = (DESIGN, UNIT, FIGURES, REPORT, f"{PREDICTED}/*.png")
"""All that a calibration writes, as patterns of `Path.glob`."""


def write_calibration(
    out: Path, found: Calibration, idle: np.ndarray
) -> tuple[dict[str, Any], Scored]:
    """Write everything; returns what stands in `calibration.json`, and the scores.

    Raises:
        StoreError: If the folder cannot be written.
    """
    scored = score(found, idle)
    figures = calibration_figures(found, scored)
    for each, image in zip(scored.photos, scored.predicted, strict=True):
        name = f"{Path(each.photo).stem}.png"
        write_atomically(out / PREDICTED / name, png_bytes(image))
    write_atomically(out / UNIT, found.unit_data)
    write_atomically(out / DESIGN, _design_text(found).encode())
    write_atomically(out / FIGURES, json.dumps(figures, indent=1, allow_nan=False).encode())
    write_atomically(out / REPORT, report(found, scored, idle).encode())
    return figures, scored


def calibration_figures(found: Calibration, scored: Scored) -> dict[str, Any]:
    """The figures of a calibration by name, as JSON holds them."""
    return {
        "photos": [_plain(each) for each in scored.photos],
        "left_out": [_plain(each) for each in found.left_out],
        "idle": {"psnr_dB": scored.idle_psnr_dB, "ssim": scored.idle_ssim},
        "fitted": {
            "lights_known": found.known,
            "lights": light_rows(found.basis.lights, found.powers.lights),
            "ambient_rgb": _rounded(found.powers.ambient / found.powers.lights.max()),
            "exposure": float(found.powers.lights.max()),
            "error_grey": found.powers.error_grey,
            "null_grey": found.powers.null_grey,
            "camera": _camera(found.design.optics.camera),
            "coating": {
                name: round(getattr(found.design.optics.coating, name), 4)
                for name in ("albedo", "specular", "roughness")
            },
            "stage": _stage(found),
            "young": None if found.young is None else _plain(found.young),
            **_known(found),
        },
    }


def _camera(camera: Camera) -> dict[str, Any]:
    return {
        "position_mm": _rounded(np.array(camera.position_mm)),
        "wxyz": [round(value, 6) for value in camera.wxyz],
        "fov_x_deg": round(camera.fov_x_deg, 4),
        "falloff": _rounded(np.array(camera.sensor.falloff)),
    }


def _stage(found: Calibration) -> dict[str, float] | None:
    """How many places a stage knew, and how far they are from where contacts are seen [mm]."""
    apart = apart_mm(found.presses)
    if not len(apart):
        return None
    return {"places": len(apart), "median_mm": round(float(np.median(apart)), 4)}


def _known(found: Calibration) -> dict[str, Any]:
    """What the photographs say of each unknown; empty where powers alone were fitted."""
    if found.refined is None:
        return {"parameters": [], "directions": [], "steps": 0}
    return {
        "parameters": [_plain(each) for each in parameters(found.refined)],
        "directions": [
            {
                "singular_value": round(each.singular_value, 3),
                "parts": {name: round(share, 3) for name, share in each.parts},
            }
            for each in directions(found.refined)
        ],
        "steps": found.refined.steps,
    }


def _plain(record: Any) -> dict[str, Any]:
    """A flat record as JSON holds it."""
    return {
        name: round(value, 4) if isinstance(value, float) else value
        for name, value in dataclasses.asdict(record).items()
    }


def light_rows(lights: Sequence[Lamp], powers: np.ndarray) -> list[dict[str, Any]]:
    """Each light's place and its power in each colour over the strongest one's."""
    strongest = float(powers.max())
    return [
        {
            "kind": lamp.kind.value,
            "mount": lamp.mount.value,
            "position_mm": _rounded(np.array(lamp.position_mm)),
            "axis": _rounded(np.array(lamp.axis)),
            "power_rgb": _rounded(powers[:, number] / strongest),
        }
        for number, lamp in enumerate(lights)
    ]


def _rounded(values: np.ndarray) -> list[float]:
    return [round(float(value), 4) for value in values]


def _design_text(found: Calibration) -> str:
    """The design as TOML, with its unit beside it."""
    text = design_to_toml(found.design)
    # Tables follow their own values, so the unit goes right behind the table's name.
    return text.replace("[optics]\n", f'[optics]\nunit = "{UNIT}"\n', 1)
