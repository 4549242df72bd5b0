"""Learned readers and views that no rendering made: small, quick, and of known truth."""

from __future__ import annotations

import numpy as np
import torch

from sim.reading.network.reader_file import ReaderFile
from sim.reading.network.rest_view import RestView
from sim.reading.network.spec import ReaderSpec, Scales
from sim.reading.network.unet import UNet, folded_state
from workbench.learning.readers.view import View
from workbench.learning.readers.view_set import ViewSet

ROWS, COLUMNS = 32, 48
GREY_PER_MM = 60.0
"""How much darker a made photograph is by depth."""
NEWTON_PER_MM = 2.0


def spec() -> ReaderSpec:
    """A network of a few thousand parameters."""
    return ReaderSpec(widths=(8, 8, 12, 12), rows=ROWS, columns=COLUMNS)


def rest_view(vertices: int = 5) -> RestView:
    """Skin everywhere but in the first column, that looks along +z; the first vertex is unseen."""
    sees = np.ones((ROWS, COLUMNS), bool)
    sees[:, 0] = False
    normals = np.zeros((ROWS, COLUMNS, 3))
    normals[:, :, 2] = 1.0
    places = np.column_stack(
        [np.linspace(4.5, COLUMNS - 4.5, vertices), np.full(vertices, ROWS / 2)]
    )
    places[0] = np.nan
    return RestView.made(sees, normals, places)


def reader_file(**changes: object) -> ReaderFile:
    """An untrained reader, the same each time."""
    torch.manual_seed(3)
    state = folded_state(UNet(spec(), normed=True).eval())
    given = {
        "spec": spec(),
        "arrays": {name: value.numpy() for name, value in state.items()},
        "scales": Scales(pressure_MPa=0.1, force_N=2.0),
        "rest": rest_view(),
        "design": "made",
        "digest": "0" * 32,
        "camera_px": (96, 64),
        "card": {},
    }
    return ReaderFile(**{**given, **changes})  # pyright: ignore[reportArgumentType]


def views(count: int, seed: int = 0) -> ViewSet:
    """Round dents that darken the photograph in proportion to their depth, of two sensors."""
    rng = np.random.default_rng(seed)
    across, down = np.meshgrid(np.arange(COLUMNS), np.arange(ROWS))
    sees = np.stack([rest_view().sees] * 2)
    idle = np.stack([np.full((ROWS, COLUMNS, 3), level, np.uint8) for level in (120, 150)])
    return ViewSet(
        views=[_view(rng, idle, (across, down)) for _ in range(count)], idle=idle, sees=sees
    )


def _view(
    rng: np.random.Generator, idle: np.ndarray, pixels: tuple[np.ndarray, np.ndarray]
) -> View:
    across, down = pixels
    x, y = rng.uniform(12, COLUMNS - 12), rng.uniform(10, ROWS - 10)
    peak_mm, radius = rng.uniform(0.3, 1.2), rng.uniform(4.0, 8.0)
    away = np.hypot(across - x, down - y) / radius
    depth_mm = peak_mm * np.maximum(1.0 - away**2, 0.0)
    look = int(rng.integers(2))
    dark = np.round(idle[look] - GREY_PER_MM * depth_mm[:, :, None]).clip(0, 255).astype(np.uint8)
    rows, columns = np.flatnonzero(depth_mm.any(axis=1)), np.flatnonzero(depth_mm.any(axis=0))
    box = (int(rows[0]), int(rows[-1]) + 1, int(columns[0]), int(columns[-1]) + 1)
    cut = (slice(box[0], box[1]), slice(box[2], box[3]))
    shape = depth_mm[cut].shape
    return View(
        look=look,
        name="dent",
        solved=True,
        force_N=np.array([0.0, 0.0, NEWTON_PER_MM * peak_mm], np.float32),
        box=box,
        photo=dark[cut],
        depth_mm=depth_mm[cut].astype(np.float16),
        surface_mm=depth_mm[cut].astype(np.float16),
        turn=np.zeros((*shape, 3), np.float16),
        pressure_MPa=(0.1 * depth_mm[cut]).astype(np.float16),
    )
