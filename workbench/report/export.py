"""`workbench export`: what there is of a design without a press, kind by kind.

A kind of export is one file of `workbench.report.exports` with an `EXPORT`. Command line, the list
of files that an earlier export left and what is computed come from there.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DeviceError
from workbench.core.base.records import records
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.store import Store
from workbench.planning.plan import InlineRunner, StageMonitor, evaluate, plan, results
from workbench.system.folder import RUN_FILES, prepare, remove_stale
from workbench.system.whole_files import write_atomically

Files = Iterable[tuple[str, bytes]]
"""Names relative to the folder, and what stands in them."""


def nothing_to_say(design: SensorDesign) -> str:
    """Of most kinds of export."""
    return ""


@dataclass(frozen=True, kw_only=True, slots=True)
class Export:
    """One kind of files."""

    place: int
    """Where it stands among the others."""
    makes: tuple[str, ...]
    """Its files as patterns of `Path.glob`, for the documents and for what goes before."""
    stages: tuple[str, ...]
    """Whose results it is written from."""
    files: Callable[[SensorDesign, dict[str, Any]], Files]
    """The files, from the design and the results by stage."""
    option: str = ""
    """Option of the command that asks for it; \"\": always written."""
    help: str = ""
    """What the option adds."""
    if_possible: bool = False
    """Whether a machine that cannot make it leaves it out."""
    kept: tuple[str, ...] = ()
    """Files among `makes` that may be the very design that is asked for."""
    notice: Callable[[SensorDesign], str] = nothing_to_say
    """What it leaves out of a design, as a sentence.

    Raises:
        DesignError: If it has no like of something in the design.
    """
    fits: Callable[[SensorDesign, MembraneMesh], None] | None = None
    """Raises a DesignError where what it writes cannot be where it is; asked before the rest."""


def exports() -> dict[str, Export]:
    """All kinds of export by name, in the order in which they are written."""
    found = records("workbench.report.exports", "EXPORT")
    return {name: found[name] for name in sorted(found, key=lambda name: found[name].place)}


def chosen_exports(options: Collection[str]) -> list[Export]:
    """What is always written, and what these options add."""
    return [kind for kind in exports().values() if not kind.option or kind.option in options]


def clear_exports(out: Path, *, but: Path) -> None:
    """Make the folder, without what an earlier run or export made there.

    Args:
        but: The design or body that is asked for, which stays.

    Raises:
        DesignError: If a file has that name.
        StoreError: If the folder cannot be made or written.
    """
    made = {name for kind in exports().values() for name in kind.makes if name not in kind.kept}
    prepare(
        out,
        clear=[name for name in (*RUN_FILES, *made) if (out / name).resolve() != but.resolve()],
    )


def export_design(
    design: SensorDesign,
    out: Path,
    store: Store,
    monitor: StageMonitor,
    options: Collection[str] = (),
) -> Iterator[Path]:
    """Write the files of a design and yield their paths.

    Such files of an earlier export that this one does not replace go.

    Args:
        design: The sensor.
        out: Made where there is none.
        store: Where results are kept.
        monitor: Progress by stage.
        options: Kinds of export beside those that are always written.

    Raises:
        DesignError: If a kind has no like of something in the design, or it cannot be where it is.
        WorkbenchError: If a stage fails or the folder cannot be written.
    """
    chosen = chosen_exports(options)
    for kind in chosen:
        kind.notice(design)
    prepare(out, clear=())
    for kind in (kind for kind in chosen if kind.fits is not None):
        _compute(design, store, monitor, ("mesh",))
        assert kind.fits is not None
        kind.fits(design, results(store, plan(design, PressCase()), ("mesh",))["mesh"])
    wanted = dict.fromkeys(stage for kind in chosen for stage in kind.stages)
    for kind in chosen:
        # A machine without an off-screen renderer still gets all files but the drawing.
        with contextlib.suppress(*((DeviceError,) if kind.if_possible else ())):
            _compute(design, store, monitor, kind.stages)
    found = results(store, plan(design, PressCase()), tuple(wanted))
    written: set[str] = set()
    for kind in chosen:
        for name, content in kind.files(design, found):
            write_atomically(out / name, content)
            written.add(name)
            yield out / name
    made = [name for kind in exports().values() for name in kind.makes]
    remove_stale(out, made, keep=written)


def _compute(
    design: SensorDesign, store: Store, monitor: StageMonitor, wanted: tuple[str, ...]
) -> None:
    for _ in evaluate(design, PressCase(), InlineRunner(store), wanted=wanted, monitor=monitor):
        pass
