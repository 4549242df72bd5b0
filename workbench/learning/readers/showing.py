"""A process that makes views: what the pool calls in it.

A block is a number of views of one built sensor, and a file; one that is there is not made again.
"""

from __future__ import annotations

import signal
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.core.base.errors import WorkbenchError
from workbench.core.result.results import MembraneMesh
from workbench.learning.dataset.folder import DataSet
from workbench.learning.dataset.recipe import Recipe
from workbench.learning.dataset.sights import Sight
from workbench.learning.readers.built import open_camera
from workbench.learning.readers.dents import dent_state
from workbench.learning.readers.states import PressStates, State, solved_cases, untouched
from workbench.learning.readers.view import View, block_bytes, look_bytes, look_name, view_of
from workbench.pipeline.store import Store
from workbench.system.whole_files import write_atomically

if TYPE_CHECKING:
    # It renders on a device, which must be open before.
    from sim.reading.shown_press import PressCamera

BLOCK = 32
"""Views in a file."""
UNTOUCHED = 0.03
"""Share of views that nothing touches."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Block:
    """Views of one built sensor."""

    name: str
    """Of its file."""
    number: int
    """Seeds what it draws."""
    look: int
    judged: bool
    """Whether it shows presses that judge; they are never dents."""
    half: int = 0
    """Of those presses, the even ones (0, for validation) or the odd ones (1, to test)."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Showing:
    """What all blocks share; small, as it is sent to each worker."""

    recipe: Recipe
    sights: tuple[Sight, ...]
    store: Path
    presses: Path
    judged: Path
    out: Path
    seed: int
    press_share: float
    """Of views that show solved presses; others show dents."""
    until_s: float
    """Time of the clock at which no block is begun any more."""


_kept: tuple[Showing, Any] | None = None
"""Of this worker process; a pool has no other place to keep it."""


def open_worker(showing: Showing, stop: Any) -> None:
    """Make this process a worker: called once, by the pool."""
    global _kept  # noqa: PLW0603
    from workbench.system.processes import follow_parent

    # Ctrl-C in a terminal reaches the whole group; the parent decides when workers stop.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    follow_parent()
    _kept = showing, stop


def show_blocks(blocks: Sequence[Block]) -> int:
    """Make blocks in this worker until time is up; returns how many views are new.

    Raises:
        WorkbenchError: If a camera cannot be opened, or a file not be written.
    """
    from workbench.pipeline.devices import open_device

    assert _kept is not None
    showing, stop = _kept
    open_device()
    bench, made = _Bench(showing), 0
    for block in blocks:
        path = showing.out / block.name
        if path.exists():
            continue
        if stop.value or time.time() > showing.until_s:
            break
        views = bench.views(block)
        write_atomically(path, block_bytes(views))
        made += len(views)
    return made


class _Bench:
    """Mesh, presses and cameras of one process."""

    def __init__(self, showing: Showing) -> None:
        self._showing = showing
        self._store = Store(showing.store)
        self._mesh: MembraneMesh = self._store.load("mesh", showing.sights[0].calls["mesh"].key)
        data, judged = DataSet.open(showing.presses), DataSet.open(showing.judged)
        self._learned = PressStates(data, solved_cases(data))
        cases = solved_cases(judged)
        self._judged = [PressStates(judged, cases[half::2]) for half in range(2)]
        self._cameras: dict[int, PressCamera] = {}

    def views(self, block: Block) -> list[View]:
        """The views of a block, the same whoever makes it."""
        rng = np.random.default_rng((self._showing.seed, block.number, int(block.judged)))
        camera = self._camera(block.look)
        views = []
        while len(views) < BLOCK:
            state = self._state(block, camera, rng)
            try:
                views.append(_view(camera, state, block.look))
            except WorkbenchError:
                # A dent that cannot be drawn is no loss: the next one is another.
                continue
        return views

    def _state(self, block: Block, camera: PressCamera, rng: np.random.Generator) -> State:
        showing, presses = self._showing, self._judged[block.half] if block.judged else None
        if presses is not None:
            return presses.drawn(rng)
        kind = float(rng.random())
        if kind < UNTOUCHED:
            return untouched(len(self._mesh.seen.points_mm))
        if kind < UNTOUCHED + showing.press_share and len(self._learned):
            return self._learned.drawn(rng)
        places_mm = self._mesh.seen.points_mm[camera.studio.visible]
        return dent_state(showing.recipe, self._mesh.seen, places_mm, rng)

    def _camera(self, look: int) -> PressCamera:
        if look not in self._cameras:
            sight = self._showing.sights[look]
            camera = open_camera(sight, self._mesh, self._store)
            self._cameras[look] = camera
            path = self._showing.out / look_name(look)
            if not path.exists():
                write_atomically(path, look_bytes(camera.idle, _sees(camera)))
        return self._cameras[look]


def _sees(camera: PressCamera) -> np.ndarray:
    return camera.sees.reshape(camera.studio.imager.shape)


def _view(camera: PressCamera, state: State, look: int) -> View:
    skin = camera.skin
    along_N = np.einsum("vc,vc->v", state.force_N, skin.inward)
    shown = camera.show(state.displacement_mm, np.maximum(along_N / skin.shares_mm2, 0.0))
    return view_of(
        shown,
        (camera.idle, _sees(camera)),
        look=look,
        name=state.name,
        force_N=state.force_N.sum(axis=0) if state.solved else None,
    )
