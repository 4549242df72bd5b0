"""An object's signed distance sampled for the kernel, computed once.

`sample_indenter` is a pure function of the object, the grid and the window; `kept_samples` keeps
what it returned, by content, up to `MOST_BYTES`, the least recently used first to go.
"""

from __future__ import annotations

import threading
from collections import OrderedDict

import numpy as np

from sim.contact.objects import textures
from sim.contact.objects.object_measures import exact_distance, smooth_box_mm
from sim.contact.objects.redistance import redistanced
from sim.contact.objects.samples import (
    MOST_SAMPLES,
    SampleGrid,
    Window,
    make_grid,
    read_spline,
    spline,
)
from workbench.core.base.digest import digest
from workbench.core.base.errors import DesignError
from workbench.core.press.indenter import Indenter
from workbench.core.result.sampled import SampledDistance

SAMPLES_PER_CELL = 2.5
"""Distance samples per grid cell: h = 0.4 cell loses 0.12 % of the force."""
CHUNK = 200_000
"""Samples evaluated at a time."""
BAND_SAMPLES = 5.0
"""Samples about the surface of a textured body whose distance is exact."""
THICKEST_TEXTURE = 0.5
"""Largest height of a texture over the height of the body above its origin."""
MOST_BYTES = 256 * 2**20


def sample_indenter(
    indenter: Indenter,
    *,
    grid_mm: float,
    window_mm: Window | None = None,
    most: int = MOST_SAMPLES,
) -> SampledDistance:
    """Sample the signed distance of any indenter at 0.4 of the contact grid.

    Args:
        indenter: The object.
        grid_mm: Edge of a cell of the contact grid.
        window_mm: The part of the body frame that can come near the skin; all of it if None.
        most: Samples at most; the spacing grows where more were needed.

    Raises:
        DesignError: If a mesh is not closed, or rounding or texture cannot be resolved.
    """
    low, high = box_mm(indenter)
    spacing_mm = grid_mm / SAMPLES_PER_CELL
    grid = make_grid(low, high, spacing_mm=spacing_mm, window_mm=window_mm, most=most)
    values = _smooth(indenter, grid)
    if indenter.texture.raised:
        values = _textured(indenter, grid, values, top_mm=float(high[2]))
    return SampledDistance(
        coefficients=spline(values),
        origin_mm=grid.origin_mm,
        spacing_mm=grid.spacing_mm,
        cut=grid.cut,
    )


def box_mm(indenter: Indenter) -> tuple[np.ndarray, np.ndarray]:
    """Corners [mm] of a box that holds the indenter with its texture, shape (3,) each."""
    low, high = smooth_box_mm(indenter)
    raised = indenter.texture.height_mm if indenter.texture.raised else 0.0
    return low - [0.0, 0.0, raised], high


def kept_samples(
    indenter: Indenter,
    *,
    grid_mm: float,
    window_mm: Window | None = None,
    most: int = MOST_SAMPLES,
) -> SampledDistance:
    """`sample_indenter`, or what it returned for an object of the same content."""
    key = _key(indenter, grid_mm, window_mm, most)
    with _lock:
        if key in _kept:
            _kept.move_to_end(key)
            return _kept[key]
    found = sample_indenter(indenter, grid_mm=grid_mm, window_mm=window_mm, most=most)
    _keep(key, found)
    return found


def _key(indenter: Indenter, grid_mm: float, window_mm: Window | None, most: int) -> str:
    corners = () if window_mm is None else tuple(np.asarray(c, dtype=float) for c in window_mm)
    return digest((indenter, float(grid_mm), corners, most))


def _keep(key: str, field: SampledDistance) -> None:
    with _lock:
        _kept[key] = field
        while len(_kept) > 1 and sum(f.coefficients.nbytes for f in _kept.values()) > MOST_BYTES:
            _kept.popitem(last=False)


_kept: OrderedDict[str, SampledDistance] = OrderedDict()
_lock = threading.Lock()


def _smooth(indenter: Indenter, grid: SampleGrid) -> np.ndarray:
    """Signed distances without the texture, shape (A, B, C)."""
    mesh = indenter.standing_mesh
    if mesh is None:
        function, places = exact_distance(indenter), grid.places()
        parts = [function(places[i : i + CHUNK]) for i in range(0, len(places), CHUNK)]
        return np.concatenate(parts).reshape(grid.shape)
    from sim.contact.objects.mesh_distance import mesh_distance, rounded_mesh_distance

    if indenter.mesh_rounding_mm:
        return rounded_mesh_distance(mesh, grid, radius_mm=indenter.mesh_rounding_mm)
    return mesh_distance(mesh, grid)


def _textured(
    indenter: Indenter, grid: SampleGrid, values: np.ndarray, *, top_mm: float
) -> np.ndarray:
    """The distances after the lower side has been raised, shape (A, B, C)."""
    if indenter.texture.height_mm > THICKEST_TEXTURE * top_mm:
        raise DesignError(
            f"a texture {indenter.texture.height_mm:g} mm high is too high for an object that "
            f"reaches {top_mm:.3g} mm above its middle; the limit is half of that",
            hint="lower indenter.texture.height_mm",
            at="indenter.texture.height_mm",
        )
    coefficients = spline(values)

    def from_samples(place: np.ndarray) -> np.ndarray:
        return read_spline(coefficients, (place - grid.origin_mm) / grid.spacing_mm)

    body = from_samples if indenter.mesh is not None else exact_distance(indenter)
    field = textures.heights(indenter.texture, grid.spacing_mm)
    function, places = textures.textured(body, field, top_mm), grid.places()
    parts = [function(places[i : i + CHUNK]) for i in range(0, len(places), CHUNK)]
    raised = np.concatenate(parts).reshape(grid.shape)
    return redistanced(raised, grid.spacing_mm, band_mm=BAND_SAMPLES * grid.spacing_mm)
