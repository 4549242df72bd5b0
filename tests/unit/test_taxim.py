"""Tables for Taxim: light that they can hold is found again, programs read what is written."""

from __future__ import annotations

import dataclasses
import io
import json
from pathlib import Path

import numpy as np
import pytest

from sim.optics.raster.skin_view import SkinView
from workbench.core.base.errors import DesignError
from workbench.core.result.results import Skin
from workbench.taxim.files import files_of
from workbench.taxim.flatness import flat_view
from workbench.taxim.programs import PROGRAMS, shown, smoothed
from workbench.taxim.table import BINS, TableFit, looked_up

ROWS, COLUMNS = 60, 80
ISAAC_LAB, TAXIM = PROGRAMS
GAIN = np.array([[60.0, 0.0], [-30.0, 40.0], [-20.0, -50.0]])
"""Grey values of a colour by a slope of 1 across and down: three LEDs about the gel."""


def dent(middle: np.ndarray, radius_px: float) -> np.ndarray:
    """Height of a round bump in pixels, steepest slope 1.1, shape (H, W)."""
    v, u = np.mgrid[:ROWS, :COLUMNS]
    away = np.hypot(u - middle[0], v - middle[1]) / radius_px
    return 0.7 * radius_px * np.clip(1.0 - away**2, 0.0, None) ** 2


def light(height_px: np.ndarray) -> np.ndarray:
    """A change of colour that a table can hold: linear in slope, quadratic over the image."""
    down, across = np.gradient(height_px)
    v, u = np.mgrid[:ROWS, :COLUMNS]
    x, y = u / COLUMNS, v / ROWS
    lit = 1.0 - 0.5 * x + 0.3 * y**2 + 0.2 * x * y
    return lit[..., None] * np.einsum("hws,cs->hwc", np.stack([across, down], axis=-1), GAIN)


@pytest.fixture(scope="module")
def table() -> np.ndarray:
    """Fitted to 80 dents, with 2 grey values everywhere at rest."""
    rng = np.random.default_rng(0)
    fit = TableFit(ROWS, COLUMNS)
    fit.rest(np.full((ROWS, COLUMNS, 3), 2.0), np.ones((ROWS, COLUMNS), dtype=bool))
    for _ in range(80):
        height_px = dent(rng.uniform((8, 8), (72, 52)), rng.uniform(8.0, 14.0))
        fit.add(height_px, light(height_px), height_px > 0.0)
    return fit.table()


def test_a_light_that_a_table_can_hold_is_found_again(table: np.ndarray) -> None:
    """In a dent at another place; a bin is .7 by 2.9 degrees, some grey values."""
    height_px = dent(np.array([33.3, 27.1]), 11.0)
    there = height_px > 0.0
    truth = light(height_px)[there]
    off = np.abs(looked_up(table, height_px)[there] - truth)
    assert off.mean() < 2.0
    assert np.abs(truth).mean() > 10.0
    assert table.shape == (BINS, BINS, 6, 3)
    assert looked_up(table, np.zeros((ROWS, COLUMNS))) == pytest.approx(2.0)


def as_taxim_draws(folder: dict[str, bytes], height_px: np.ndarray) -> np.ndarray:
    """An image by Taxim's own steps, from its files alone: blue, green, red, (H, W, 3)."""
    calibration = np.load(io.BytesIO(folder["polycalib.npz"]))
    base = smoothed(np.load(io.BytesIO(folder["dataPack.npz"]))["f0"].astype(float))
    steps = int(calibration["bins"]) - 1
    rows, columns = height_px.shape
    size, direction = np.zeros((2, rows, columns))
    for v in range(1, rows - 1):
        for u in range(1, columns - 1):
            down = (height_px[v + 1, u] - height_px[v - 1, u]) / 2.0
            across = (height_px[v, u + 1] - height_px[v, u - 1]) / 2.0
            size[v, u] = np.arctan(np.sqrt(down**2 + across**2))
            direction[v, u] = np.arctan2(down, across) if size[v, u] else 0.0
    at = (
        (size // (0.5 * np.pi / steps)).astype(int),
        ((direction + np.pi) // (2.0 * np.pi / steps)).astype(int),
    )
    image = base.copy()
    v, u = np.mgrid[:rows, :columns]
    for colour, name in enumerate(("grad_r", "grad_g", "grad_b")):
        a, b, c, d, e, f = np.moveaxis(calibration[name][at], -1, 0)
        image[..., colour] += a * u * u + b * v * v + c * u * v + d * u + e * v + f
    return np.clip(image, 0.0, 255.0)


def test_taxims_own_steps_draw_the_same_image(table: np.ndarray) -> None:
    """From `polycalib.npz` and `dataPack.npz`, in OpenCV's order of colours."""
    rng = np.random.default_rng(2)
    rest = rng.integers(60, 120, (ROWS, COLUMNS, 3)).astype(np.uint8)
    height_px = dent(np.array([40.0, 30.0]), 12.0)
    folder = files_of(TAXIM, rest, table, 0.05)
    theirs = as_taxim_draws(folder, height_px)[1:-1, 1:-1, ::-1]
    ours = shown(TAXIM.base(rest), table, height_px)[1:-1, 1:-1]
    assert theirs == pytest.approx(ours, abs=1e-6)


def as_isaac_lab_draws(folder: dict[str, bytes], height_m: np.ndarray, scale: float) -> np.ndarray:
    """An image by the steps of Isaac Lab, from its files alone, in PyTorch: (H, W, 3), uint8.

    Args:
        folder: The files.
        height_m: Depth of the gel beyond that at rest [m], negative where it is pressed in.
        scale: mm per pixel.
    """
    import cv2
    import torch

    encoded = np.frombuffer(folder["bg.jpg"], np.uint8)
    image = cv2.imdecode(encoded, cv2.IMREAD_COLOR)
    assert image is not None
    base = torch.tensor(cv2.cvtColor(image, cv2.COLOR_BGR2RGB))
    calibration = np.load(io.BytesIO(folder["polycalib.npz"]))
    height = torch.tensor(height_m) * -1000.0 / scale
    binomial = torch.tensor([1.0, 4.0, 6.0, 4.0, 1.0], dtype=torch.float64) / 16.0
    kernel = torch.outer(binomial, binomial)[None, None]
    height = torch.nn.functional.conv2d(height[None, None], kernel, padding="same")[0, 0]
    down, across = torch.gradient(height)
    steep = torch.sqrt(down**2 + across**2)
    size, direction = torch.arctan(steep), torch.arctan2(down, across)
    direction[steep == 0] = 0
    at = (
        torch.floor(size / (0.5 * np.pi / 124)).long().clamp(0, 124),
        torch.floor((direction + np.pi) / (2.0 * np.pi / 124)).long().clamp(0, 124),
    )
    v, u = torch.meshgrid(*map(torch.arange, height.shape), indexing="ij")
    terms = torch.stack([u * u, v * v, u * v, u, v, torch.ones_like(u)], dim=-1)
    added = [(terms * torch.tensor(calibration[f"grad_{colour}"])[at]).sum(-1) for colour in "rgb"]
    return (torch.stack(added, dim=-1) + base).clip(0, 255).to(torch.uint8).numpy()


def test_isaac_labs_steps_draw_nearly_the_same_image(table: np.ndarray) -> None:
    """Heights in metres; it blurs them by 5 pixels, and rounds down: some grey values apart."""
    rest = np.full((ROWS, COLUMNS, 3), (90, 120, 60), np.uint8)
    height_px = dent(np.array([40.0, 30.0]), 12.0)
    folder = files_of(ISAAC_LAB, rest, table, 0.05)
    theirs = as_isaac_lab_draws(folder, -height_px * 0.05e-3, 0.05).astype(float)
    ours = shown(ISAAC_LAB.base(rest), table, height_px)
    there = height_px > 0.0
    assert np.abs(theirs - ours)[there].mean() < 3.0
    assert np.abs(ours - rest)[there].mean() > 8.0


def test_all_files_that_taxim_opens_are_there(table: np.ndarray) -> None:
    """Names, shapes and types as its programs ask for them; shadows darken nothing."""
    rest = np.full((ROWS, COLUMNS, 3), (90, 120, 60), np.uint8)
    folder = files_of(TAXIM, rest, table, 0.05)
    calibration = np.load(io.BytesIO(folder["polycalib.npz"]))
    assert int(calibration["bins"]) == BINS
    assert all(calibration[f"grad_{c}"].shape == (BINS, BINS, 6) for c in "rgb")
    assert np.array_equal(calibration["grad_r"], table[..., 2])
    other = np.load(io.BytesIO(files_of(ISAAC_LAB, rest, table, 0.05)["polycalib.npz"]))
    assert np.array_equal(other["grad_r"], table[..., 0])
    shadows = np.load(io.BytesIO(folder["shadowTable.npz"]), allow_pickle=True)
    directions, values = shadows["shadowDirections"], shadows["shadowTable"]
    assert values.shape == (3, len(directions), 9)
    assert int(2.0 * np.pi // 0.1) < len(directions)
    assert {tuple(each) for each in values.ravel()} == {(255.0,)}
    read: dict[str, float] = {}
    exec(folder["sensorParams.py"].decode(), read)
    assert (read["pixmm"], read["h"], read["w"]) == (0.05, ROWS, COLUMNS)
    sensor = json.loads(folder["params.json"])["sensor"]
    assert sensor == {"pixmm": 0.05, "num_bins": BINS, "w": COLUMNS, "h": ROWS}
    for name in ("gelmap5.npy", "gelmap.npy"):
        assert not np.load(io.BytesIO(folder[name])).any()


def test_taxims_smoothing_wipes_out_dark_dots() -> None:
    """Even light stays as it is; a dot of 3 pixels becomes what is around it."""
    even = np.full((ROWS, COLUMNS, 3), 100.0)
    assert smoothed(even) == pytest.approx(even)
    dotted = even.copy()
    dotted[30:33, 40:43] = 20.0
    assert smoothed(dotted)[31, 41] == pytest.approx([100.0] * 3, abs=1.0)


def sheet_view(bend_deg: float, from_mm: float = 0.0) -> tuple[SkinView, Skin]:
    """A sheet 20 mm above the camera, seen without refraction; bent up beyond some x."""
    from sim.optics.raster.skin_view import open_skin_view
    from tests.unit.test_dataset_cases import flat_skin
    from workbench.core.design.camera import Camera
    from workbench.core.result.results import MembraneMesh

    def raised(by_mm: float, slope: float) -> Skin:
        flat = flat_skin(20.0, 1.0)
        points = flat.points_mm + np.array([0.0, 0.0, by_mm])
        points[:, 2] += slope * np.maximum(points[:, 0] - from_mm, 0.0)
        bent = np.array([-slope, 0.0, 1.0]) / np.hypot(1.0, slope)
        normals = np.where(points[:, :1] > from_mm, bent, flat.normals)
        return dataclasses.replace(flat, points_mm=points, normals=normals)

    outer = raised(20.0, np.tan(np.radians(bend_deg)))
    cavity = raised(10.0, 0.0)
    mesh = MembraneMesh(hexes=None, outer=outer, inner=outer, cavity=cavity)
    camera = Camera(width_px=96, height_px=72, fov_x_deg=60.0, position_mm=(0.0, 0.0, 0.0))
    return open_skin_view(mesh, camera, index=1.0), outer


UP = np.array([0.0, 0.0, 1.0])


def test_a_flat_skin_has_the_cameras_scale() -> None:
    """2 tan(60 / 2 degrees) 20 mm over 96 pixels, all of it flat."""
    view = flat_view(*sheet_view(0.0), UP)
    assert view.share == 1.0
    assert view.flat.shape == (72, 96)
    assert view.mm_per_px == pytest.approx(2.0 * np.tan(np.radians(30.0)) * 20.0 / 96, rel=1e-3)


def test_the_flat_part_is_where_it_is() -> None:
    """Bent 20 degrees up beyond x = 8 mm of 11.5: whole columns on one side, (11.5 + 8) / 23."""
    flat = flat_view(*sheet_view(20.0, 8.0), UP).flat
    columns = flat.all(axis=0)
    assert np.abs(np.diff(columns.astype(int))).sum() == 1
    # A triangle of 1 mm is 4 pixels wide.
    assert columns.sum() == pytest.approx(flat.any(axis=0).sum(), abs=5)
    assert columns.sum() == pytest.approx(96 * (11.55 + 8.0) / 23.1, abs=6)


def test_curved_skins_are_refused_with_how_flat_they_are() -> None:
    """Half of a sheet is bent by 20 degrees: half of the image, less or more by perspective."""
    assert flat_view(*sheet_view(5.0), UP).share == 1.0
    with pytest.raises(DesignError, match=r"(4|5)\d% of the skin .* within 10 degrees; .* 75% or"):
        flat_view(*sheet_view(20.0), UP)


@pytest.mark.slow
def test_the_pads_table_beats_the_image_at_rest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Dents that it was not fitted to, of the ball and of a cube, for both programs; its scale."""
    from workbench.cli.command_line import main

    monkeypatch.setenv("WORKBENCH_PROJECT", str(tmp_path / "project"))
    out = tmp_path / "taxim"
    assert main(["export", "pad", "--taxim", str(out), "--width-px", "160"]) == 0
    told = json.loads((out / "taxim.json").read_text())
    assert (told["h"], told["w"], told["numBins"]) == (120, 160, BINS)
    # The pad is 20 mm wide and fills nine tenths of a view of 62 degrees, 18 mm away.
    assert told["pixmm"] == pytest.approx(0.15, abs=0.01)
    for programs in told["errors_grey"].values():
        for name, found in programs.items():
            assert found["error"] < 0.75 * found["null"], name
