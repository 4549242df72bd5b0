"""A calibration that was written, as the page shows it: scores in words, lights, files."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from statistics import mean
from typing import Any

import numpy as np

from workbench.calibration.outputs import DESIGN, FIGURES, FILES, PREDICTED, REPORT
from workbench.core.base.errors import DesignError
from workbench.core.design.design import SensorDesign
from workbench.photographs.photo_files import decoded
from workbench.project.design_bundle import zipped
from workbench.project.design_toml import design_from_toml

CALIBRATED = " calibrated"
"""Ends the name of the design that comes of it."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Outcome:
    """Figures of one calibration."""

    folder: Path
    figures: Mapping[str, Any]
    """`calibration.json`."""

    @property
    def photos(self) -> dict[str, Mapping[str, Any]]:
        """Scores by photograph."""
        return {each["photo"]: each for each in self.figures["photos"]}

    def predicted(self, name: str) -> np.ndarray:
        """What the calibrated design shows of a photograph's press, shape (H, W, 3), uint8.

        Raises:
            DesignError: If the file is gone.
        """
        return decoded(name, self._read(f"{PREDICTED}/{Path(name).stem}.png"))

    def design(self) -> SensorDesign:
        """The calibrated design with its unit.

        Raises:
            DesignError: If a file is gone or was edited into nonsense.
        """
        text = self._read(DESIGN).decode()
        found = design_from_toml(text, source=DESIGN, roots=(self.folder,), enclosed=True)
        name = found.name.removesuffix(CALIBRATED) + CALIBRATED
        return dataclasses.replace(found, name=name)

    def report(self) -> bytes:
        """The page of the report."""
        return self._read(REPORT)

    def archive(self) -> bytes:
        """All files as a zip."""
        paths = sorted({path for pattern in FILES for path in self.folder.glob(pattern)})
        return zipped({p.relative_to(self.folder).as_posix(): p.read_bytes() for p in paths})

    def _read(self, name: str) -> bytes:
        try:
            return (self.folder / name).read_bytes()
        except OSError as error:
            raise DesignError(
                f"{name} of the calibration cannot be read: {error.strerror or error}",
                hint="calibrate again; what was computed is stored",
            ) from error


def read_outcome(folder: Path) -> Outcome | None:
    """The calibration that lies in a folder; None where there is none that can be read."""
    try:
        figures = json.loads((folder / FIGURES).read_text(encoding="utf-8"))
        found = Outcome(folder=folder, figures=figures)
        summary(found)
        lights(found)
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return found


def summary(found: Outcome) -> list[str]:
    """How well it predicts, in sentences."""
    lines = []
    for words, held in (
        ("Photographs that were held out", True),
        ("Photographs that it was fitted to", False),
    ):
        chosen = [each for each in found.photos.values() if each["held_out"] is held]
        if chosen:
            psnr, flat, poly, repeat = (
                mean(each[name] for each in chosen)
                for name in ("psnr_dB", "null_psnr_dB", "polynomial_psnr_dB", "repeat_psnr_dB")
            )
            verdict = "better" if psnr > poly else "no better"
            lines.append(
                f"{words} ({len(chosen)}): predicted to **{psnr:.1f} dB**. Showing no contact "
                f"at all gives {flat:.1f}; a polynomial without physics {poly:.1f}, so this is "
                f"{verdict}; two photographs of untouched skin are alike to {repeat:.1f}."
            )
    fitted = found.figures["fitted"]
    left = 100.0 * fitted["error_grey"] / max(fitted["null_grey"], 1e-9)
    whose = "the design's own lights" if fitted["lights_known"] else "lights found around the body"
    idle_dB = found.figures["idle"]["psnr_dB"]
    lines.append(
        f"Light: {whose} leave {left:.0f} % of what the contacts change; they alone give the "
        f"idle photo to {idle_dB:.1f} dB."
    )
    return lines


def lights(found: Outcome) -> list[tuple[str, tuple[float, float, float], tuple[float, ...]]]:
    """Of each light its number, place [mm] and power in red, green and blue over the strongest."""
    return [
        (f"{number}", tuple(each["position_mm"]), tuple(each["power_rgb"]))
        for number, each in enumerate(found.figures["fitted"]["lights"], 1)
    ]
