"""Make a twin: its hidden sensor, its photographs, and what they really show.

Done is what has a file: made again after it was stopped, it goes on where it was, path by path.
Tables are written after each path, so that a twin under way can be read.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from workbench.core.base.errors import Cancelled, DesignError, SolveError, StoreError
from workbench.core.base.monitor import Monitor, part
from workbench.core.design.design import SensorDesign
from workbench.core.result.force_field import ForceField
from workbench.core.result.results import MembraneMesh
from workbench.learning.dataset.lock import held
from workbench.learning.dataset.sequences import FRAMES
from workbench.pipeline.devices import chosen_device
from workbench.pipeline.store import Store
from workbench.twin.cases import (
    BALL_FRAMES,
    PRESS_FRAMES,
    Ground,
    Kind,
    TwinCase,
    case,
    seen_ground,
)
from workbench.twin.contact import pressed, seen_displacement_mm, twin_mesh
from workbench.twin.draw import Twin, draw_twin
from workbench.twin.first_camera import seen_at
from workbench.twin.mitsuba_photographer import MitsubaPhotographer, check_mitsuba
from workbench.twin.photographer import Photographer
from workbench.twin.pressing import press_ahead
from workbench.twin.stage import draw_stage
from workbench.twin.steady_photographer import SteadyPhotographer
from workbench.twin.taking import Taken, ball_row, label_row, photos_of
from workbench.twin.truth import FOLDER, truth_of, write_truth
from workbench.twin.twin_folder import TwinFolder, idle_files, open_folder
from workbench.twin.twin_plan import Light, TwinPlan

MOST_FAILED = 2
"""Paths that may fail or give nothing for each one that is wanted, and `SPARE` more."""
SPARE = 10
OPENED, PRESSED = 0.05, 0.4
"""Shares of the progress up to the light at rest, and up to presses side by side."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Made:
    """What is there of a twin."""

    folder: Path
    twin: Twin
    photos: dict[Kind, int]
    """Photographs of each kind."""
    failed: dict[str, str]
    """Paths that could not be solved, with the reason."""


def make_twin(
    design: SensorDesign, out: Path, plan: TwinPlan, store: Store, monitor: Monitor
) -> Made:
    """Make a twin of a design, or the rest of it.

    Args:
        design: What it is built from.
        out: Its folder.
        plan: How much is made, and how.
        store: Keeps mesh and presses.
        monitor: Progress and cancellation.

    Raises:
        DesignError: If another twin is in the folder, or the camera sees no skin to press.
        MeshingError: If finite elements cannot divide the body.
        DeviceError: If Mitsuba is asked for and cannot be used here.
        SolveError: If most paths cannot be solved.
        StoreError: If the folder cannot be written, or another process makes it.
        Cancelled: If the monitor says so; what is done stays.
    """
    design = _sized(design, plan)
    twin = draw_twin(design, plan.seed)
    if plan.light is Light.MITSUBA:
        check_mitsuba(twin.design.optics)
    with held(out, doing="making the twin in"):
        folder = open_folder(out, twin, design, plan)
        mesh = twin_mesh(twin, plan, store, part(monitor, 0.0, 0.5 * OPENED))
        photographer = _photographer(plan)(
            twin, mesh, plan.photons(chosen_device()), part(monitor, 0.5 * OPENED, OPENED)
        )
        camera = design.optics.camera
        ground = seen_ground(
            mesh,
            photographer.plain.vertex_pixels[:, :2] / (camera.width_px, camera.height_px),
            photographer.plain.visible,
            0.5 * max(plan.ball_mm, plan.object_mm),
        )
        work = _Work(
            twin=twin,
            plan=plan,
            store=store,
            folder=folder,
            mesh=mesh,
            ground=ground,
            photographer=photographer,
        )
        return work.run(part(monitor, OPENED, 1.0))


def _photographer(plan: TwinPlan) -> type[Photographer]:
    return MitsubaPhotographer if plan.light is Light.MITSUBA else SteadyPhotographer


def _sized(design: SensorDesign, plan: TwinPlan) -> SensorDesign:
    """The design with images of the width that is asked for, seen by its first camera."""
    camera = design.optics.camera
    width_px = plan.width_px or camera.width_px
    return seen_at(design, width_px, round(camera.height_px * width_px / camera.width_px))


@dataclass(frozen=True, kw_only=True, slots=True)
class _Work:
    """A twin that is being made."""

    twin: Twin
    plan: TwinPlan
    store: Store
    folder: TwinFolder
    mesh: MembraneMesh
    ground: Ground
    photographer: Photographer

    def run(self, monitor: Monitor) -> Made:
        wanted = self._wanted()
        for path, kind in idle_files(list(wanted)).items():
            if not (self.folder.path / path).exists():
                marked = kind is Kind.SLIDE
                self.folder.write_photo(
                    kind, Path(path).name, self.photographer.at_rest(marked=marked)
                )
        begun = 0.0
        if self.plan.jobs > 1:
            begun = PRESSED
            self._press_ahead(wanted, part(monitor, 0.0, PRESSED))
        counts, total = dict.fromkeys(Kind, 0), sum(wanted.values())
        done = 0
        for kind, most in wanted.items():
            ends = done + most
            span = part(
                monitor,
                begun + (1.0 - begun) * done / total,
                begun + (1.0 - begun) * ends / total,
            )
            counts[kind] = self._photograph(kind, most, span)
            done = ends
        monitor(1.0, "made")
        return Made(
            folder=self.folder.path, twin=self.twin, photos=counts, failed=self.folder.failed()
        )

    def _wanted(self) -> dict[Kind, int]:
        """Photographs of each kind that is asked for; slides come in pairs of sequences."""
        counts = {
            Kind.CALIBRATION: self.plan.calibration,
            Kind.PRESS: self.plan.presses,
            Kind.SLIDE: FRAMES * self.plan.slides,
        }
        return {kind: count for kind, count in counts.items() if count}

    def _paths(self, kind: Kind, photos: int) -> int:
        """Paths that give so many photographs, if all of them do."""
        each = {
            Kind.CALIBRATION: BALL_FRAMES,
            Kind.PRESS: PRESS_FRAMES,
            Kind.SLIDE: 2 * FRAMES,
        }
        return -(-photos // each[kind])

    def _case(self, kind: Kind, number: int) -> TwinCase:
        return case(self.twin, self.plan, self.ground, kind, number)

    def _press_ahead(self, wanted: dict[Kind, int], monitor: Monitor) -> None:
        failed = self.folder.failed()
        cases = [
            self._case(kind, number)
            for kind, photos in wanted.items()
            for number in range(self._paths(kind, photos))
        ]
        todo = [each for each in cases if each.id not in failed]
        found = press_ahead(self.twin, self.plan, todo, self.store, monitor)
        if found:
            self.folder.write_failed(failed | found)

    def _photograph(self, kind: Kind, most: int, monitor: Monitor) -> int:
        """Photographs of a kind, with their table; returns how many there are."""
        rows: list[dict[str, str]] = []
        tried, paths = 0, self._paths(kind, most)
        for number in itertools.count():
            if len(rows) >= most:
                break
            if tried > MOST_FAILED * paths + SPARE:
                raise SolveError(
                    f"only {len(rows)} of {most} photographs after {tried} paths of {kind.value}",
                    hint="failed.json says why paths fail; slides may never slip: raise their way",
                    at="twin",
                )
            tried += 1
            each = self._case(kind, number)
            span = part(monitor, len(rows) / most, min(1.0, (len(rows) + 1) / most))
            field = self._pressed(each, span)
            if field is None:
                continue
            taken = photos_of(self.twin, each, field)[: most - len(rows)]
            for photo in taken:
                monitor(len(rows) / most, photo.name)
                self._take(photo, field, span)
                rows.append(self._row(photo, field))
            self.folder.write_table(kind, rows)
        return len(rows)

    def _row(self, photo: Taken, field: ForceField) -> dict[str, str]:
        """A photograph's line of its table."""
        if photo.case.kind is not Kind.CALIBRATION:
            return label_row(photo, field, self.mesh.outer)
        return ball_row(photo, field, self.plan.ball_mm, draw_stage(self.twin.seed))

    def _pressed(self, each: TwinCase, monitor: Monitor) -> ForceField | None:
        """A path from the store or pressed now; None of one that cannot be."""
        failed = self.folder.failed()
        if each.id in failed:
            return None
        try:
            return pressed(self.twin, self.plan, each, self.store, monitor)
        except (Cancelled, StoreError):
            raise
        except (DesignError, SolveError) as error:
            self.folder.write_failed(failed | {each.id: error.message})
        return None

    def _take(self, photo: Taken, field: ForceField, monitor: Monitor) -> None:
        """Photograph a frame and write what it shows, where that is not there."""
        kind, name = photo.case.kind, f"{photo.name}.png"
        truth = self.folder.path / FOLDER / f"{photo.name}.npz"
        if not truth.exists():
            write_truth(
                self.folder.path,
                photo.name,
                truth_of(self.mesh, photo.case, field, photo.frame),
            )
        if (self.folder.photos(kind) / name).exists():
            return
        moved = seen_displacement_mm(self.mesh, field)[photo.frame]
        image = self.photographer.photograph(moved, photo.number, monitor, marked=photo.marked)
        self.folder.write_photo(kind, name, image)


def photo_names(folder: Path, kind: Kind) -> Iterator[str]:
    """Names of a kind's photographs without ending, in order; the one at rest left out."""
    place = TwinFolder(path=folder).photos(kind)
    yield from sorted(path.stem for path in place.glob("*.png") if path.stem != "idle")
