"""`workbench compare`: the images of one set of runs beside those of another, scored.

A set is the folder of one run, or a folder of such folders; runs are paired by the names of their
folders, images by their numbers. The second set is the reference, and its backgrounds are the null.
"""

from __future__ import annotations

import dataclasses
import html
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.core.errors import DesignError

if TYPE_CHECKING:
    from sim.optics.comparison import Pair, Scores

CONTACT_SHARE = 0.1
"""Pixels that changed by this share of the largest change belong to the contact box."""
COLUMNS = ("ssim_1", "psnr_dB", "mse_grey2", "mae_grey")


def compare_sets(images: Path, reference: Path) -> tuple[Scores, ...]:
    """Scores of all pairs, then by indenter, contact angle, depth and position.

    Raises:
        DesignError: If a folder holds no run, nothing pairs, or sizes differ.
    """
    from sim.optics.comparison import compare

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
    from sim.optics.comparison import Pair

    press = _press_of(theirs / "summary.json")
    null = _read(theirs / "background.png")
    depths = press.get("depths_mm", [])
    found = []
    for path in sorted(theirs.glob("frame_*.png")):
        if not (ours / path.name).is_file():
            continue
        number = int(path.stem.split("_")[1])
        image, truth = _read(ours / path.name), _read(path)
        if image.shape != truth.shape:
            raise DesignError(
                f"{ours / path.name} has {image.shape[1]} x {image.shape[0]} pixels, its "
                f"reference {truth.shape[1]} x {truth.shape[0]}",
                hint="render both with the same camera",
                at="compare",
            )
        labels = {name: str(press[name]) for name in ("indenter", "angle_deg") if name in press}
        if number < len(depths):
            labels["depth_mm"] = f"{depths[number]:.2f}"
        if "position_mm" in press:
            labels["position_mm"] = f"{press['position_mm']:.1f}"
        found.append(
            Pair(image=image, reference=truth, null=null, box=_box(truth, null), labels=labels)
        )
    return found


def _press_of(summary: Path) -> dict[str, Any]:
    """What a run says of its press; nothing of runs that hold none."""
    try:
        return json.loads(summary.read_text()).get("press", {})
    except ValueError as error:
        raise DesignError(
            f"{summary} is not JSON: {error}", hint="write the run anew", at="compare"
        ) from error


def _box(image: np.ndarray, background: np.ndarray) -> tuple[slice, slice] | None:
    from sim.metrics import contact_box

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
    from workbench.report import STYLE

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
    return (
        f"<!doctype html><html><head><meta charset='utf-8'><title>{html.escape(title)}</title>"
        f"<style>{STYLE}</style></head><body>{body}</body></html>"
    )
