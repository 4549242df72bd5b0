"""`workbench compare`: the images of one set of runs beside those of another, scored.

A set is the folder of one run, or a folder of such folders; runs are paired by the names of their
folders, images by their cameras and numbers. The second set is the reference, and its backgrounds
are the null.
"""

from __future__ import annotations

import dataclasses
import html
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.core.base.errors import DesignError

if TYPE_CHECKING:
    from sim.optics.proof.comparison import Pair, Scores

CONTACT_SHARE = 0.1
"""Pixels that changed by this share of the largest change belong to the contact box."""
FRAME = re.compile(r"frame_(\d+)\.png", re.ASCII)
FURTHER = range(2, 9)
"""Numbers of the cameras that have folders of their own."""
LARGEST_MM = 1e6
"""Of a depth or place that a summary may hold; beyond it the file is damaged."""
COLUMNS = ("ssim_1", "psnr_dB", "mse_grey2", "mae_grey")


def compare_sets(images: Path, reference: Path) -> tuple[Scores, ...]:
    """Scores of all pairs, then by camera, indenter, contact angle, depth, position.

    Raises:
        DesignError: If a folder holds no run, nothing pairs, or sizes differ.
    """
    from sim.optics.proof.comparison import compare

    return compare(pairs(images, reference))


def pairs(images: Path, reference: Path) -> list[Pair]:
    """Every image with the reference's image of the same run and number."""
    ours, theirs = _runs(images), _runs(reference)
    names = [name for name in ours if name in theirs]
    if len(ours) == len(theirs) == 1:
        names, theirs = list(ours), dict.fromkeys(ours, next(iter(theirs.values())))
    if not names:
        raise DesignError(
            f"no run of {images} has the name of a run of {reference}",
            hint="give two runs, or two folders whose runs have the same names",
            at="compare",
        )
    found = [pair for name in names for pair in _run_pairs(ours[name], theirs[name])]
    if not found:
        raise DesignError(
            f"no image of {images} has the number of an image of {reference}",
            hint="give runs with the same frames",
            at="compare",
        )
    return found


def _runs(folder: Path) -> dict[str, Path]:
    if (folder / "summary.json").is_file():
        return {".": folder}
    found = {path.parent.name: path.parent for path in sorted(folder.glob("*/summary.json"))}
    if not found:
        raise DesignError(
            f"{folder} holds no run: there is no summary.json in it or one folder below",
            hint="give a folder that `workbench run --out` wrote",
            at="compare",
        )
    return found


def _run_pairs(ours: Path, theirs: Path) -> list[Pair]:
    press = _labels_of(theirs / "summary.json")
    folders = {1: "."}
    for number in FURTHER:
        if all((run / f"camera_{number}").is_dir() for run in (ours, theirs)):
            folders[number] = f"camera_{number}"
    found = []
    for number, folder in folders.items():
        named = {"camera": str(number)} if len(folders) > 1 else {}
        found += _camera_pairs(ours / folder, theirs / folder, press, named)
    return found


def _camera_pairs(
    ours: Path, theirs: Path, press: PressLabels, named: Mapping[str, str]
) -> list[Pair]:
    """Every image of one camera with the reference's image of the same number."""
    from sim.optics.proof.comparison import Pair

    null = _read(theirs / "background.png")
    found = []
    for path in sorted(theirs.iterdir()):
        frame = FRAME.fullmatch(path.name)
        if frame is None or not (ours / path.name).is_file():
            continue
        image, truth = _read(ours / path.name), _read(path)
        _check_sizes(ours / path.name, image, "its reference", truth)
        _check_sizes(theirs / "background.png", null, path.name, truth)
        labels = {**named, **press.of(int(frame[1]))}
        found.append(
            Pair(image=image, reference=truth, null=null, box=_box(truth, null), labels=labels)
        )
    return found


def _check_sizes(path: Path, image: np.ndarray, other: str, truth: np.ndarray) -> None:
    if image.shape == truth.shape:
        return
    raise DesignError(
        f"{path} has {image.shape[1]} x {image.shape[0]} pixels, {other} "
        f"{truth.shape[1]} x {truth.shape[0]}",
        hint="render both with the same camera",
        at="compare",
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class PressLabels:
    """What pairs of one run are grouped by."""

    run: Mapping[str, str]
    """Of all its frames."""
    depths_mm: Sequence[float]
    """Of each frame [mm]; may be shorter than the frames."""

    def of(self, frame: int) -> dict[str, str]:
        """Labels of a frame by its number from 0."""
        labels = dict(self.run)
        if frame < len(self.depths_mm):
            labels["depth_mm"] = f"{self.depths_mm[frame]:.2f}"
        if "position_mm" in labels:
            # Groups come in the order of labels, the position last.
            labels["position_mm"] = labels.pop("position_mm")
        return labels


def _labels_of(summary: Path) -> PressLabels:
    """What a run says of its press; nothing of runs that hold none."""
    try:
        table = json.loads(summary.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise _damaged(summary, f"is not JSON: {error}") from error
    press = table.get("press", {}) if isinstance(table, dict) else None
    if not isinstance(press, dict):
        raise _damaged(summary, "is not the summary of a run: its press is no table")
    labels = {name: str(press[name]) for name in ("indenter", "angle_deg") if name in press}
    depths = press.get("depths_mm", [])
    if not isinstance(depths, list):
        raise _damaged(summary, "has depths_mm that are no list of numbers")
    if "position_mm" in press:
        labels["position_mm"] = f"{_number(summary, 'position_mm', press['position_mm']):.1f}"
    numbers = [_number(summary, "depths_mm", depth) for depth in depths]
    return PressLabels(run=labels, depths_mm=numbers)


def _number(summary: Path, name: str, value: object) -> float:
    if isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < LARGEST_MM:
        return value
    raise _damaged(summary, f"has {str(value)[:40]} in {name}, which is not a number of mm")


def _damaged(summary: Path, what: str) -> DesignError:
    return DesignError(f"{summary} {what}", hint="write the run anew", at="compare")


def _box(image: np.ndarray, background: np.ndarray) -> tuple[slice, slice] | None:
    from sim.optics.studio.metrics import contact_box

    change = np.abs(image.astype(np.int16) - background).max(axis=2)
    return contact_box(change > max(1.0, CONTACT_SHARE * float(change.max())))


def _read(path: Path) -> np.ndarray:
    import cv2

    image = cv2.imread(str(path), cv2.IMREAD_COLOR)
    if image is None:
        raise DesignError(f"{path} cannot be read", hint="write the run anew", at="compare")
    return image[..., ::-1]


def table(scores: tuple[Scores, ...]) -> list[dict[str, Any]]:
    """The scores as plain rows."""
    return [dataclasses.asdict(row) for row in scores]


def page(scores: tuple[Scores, ...], title: str) -> str:
    """One HTML page without outside links."""
    from workbench.report.html_page import page as whole_page

    heads = ["group", "", "images", *(name for c in COLUMNS for name in (c, "null"))]
    rows = []
    for row in scores:
        cells = [row.group, row.value, str(row.pairs)]
        for column in COLUMNS:
            cells += [f"{getattr(row, column):.4g}", f"{getattr(row, f'null_{column}'):.4g}"]
        rows.append("<tr>" + "".join(f"<td>{html.escape(c)}</td>" for c in cells) + "</tr>")
    head = "<tr>" + "".join(f"<th>{name}</th>" for name in heads) + "</tr>"
    explained = (
        "Scores in the contact box of the reference; null: what showing the reference's background "
        "scores. SSIM as Wang and others 2004; PSNR from the mean square error of the group."
    )
    body = f"<h1>{html.escape(title)}</h1><p>{explained}</p><table>{head}{''.join(rows)}</table>"
    return whole_page(title, body)
