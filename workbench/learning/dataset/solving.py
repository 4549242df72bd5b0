"""One worker of a data set: opens the device and the cameras once, then solves case after case.

Cases are pressed by the contact solver first, as a whole and some side by side, which is what a
GPU needs; the finite elements then hand over each frame of each as it converges, and its sample is
written at once, so a killed process loses one frame of theirs and the presses before it. Both
solvers press on the same skin, that of the hexahedra, so they share vertices, first touch and path.
Images show the displacement of the contact solver, as in the paper, or of the finite elements where
they are alone.
"""

from __future__ import annotations

import contextlib
import dataclasses
import time
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.core.base.errors import Cancelled, DeviceError, LaneError, StoreError, WorkbenchError
from workbench.core.press.fem import FemSettings
from workbench.core.press.press import ContactSettings
from workbench.core.press.press_case import PressCase
from workbench.core.result.force_field import ForceField, Source, from_contact
from workbench.core.result.results import MembraneMesh
from workbench.learning.dataset.cases import Case
from workbench.learning.dataset.folder import SAMPLES, sample_name
from workbench.learning.dataset.images import Cameras, Views
from workbench.learning.dataset.recipe import Solvers
from workbench.learning.dataset.sample import Sample, Solved, to_bytes
from workbench.learning.dataset.worker_messages import Report, Setup
from workbench.pipeline.store import Store
from workbench.system.whole_files import write_atomically

if TYPE_CHECKING:
    # Its linear solver is loaded when the first case needs it.
    from sim.fem.readout import FemFrame


class Bench:
    """Mesh, material points and cameras of one process."""

    def __init__(self, setup: Setup, stop: Any) -> None:
        from workbench.pipeline.devices import open_device

        open_device()
        store = Store(setup.store)
        self.setup = setup
        self.stop = stop
        self.recipe = setup.recipe
        self.mesh: MembraneMesh = self._load(store, "mesh")
        self.points = self._load(store, "lattice") if self.recipe.solvers != Solvers.FEM else None
        self._store = store
        self._opened: dict[int, Cameras] = {}

    def _load(self, store: Store, stage: str) -> Any:
        return store.load(stage, self.setup.calls[stage].key)

    def solve(self, cases: Sequence[Case]) -> list[Report]:
        """Make the samples of some cases; what goes wrong with one is in its report.

        Raises:
            Cancelled: If this data set is to stop.
            StoreError: If a sample cannot be written: the disk is full, not the case at fault.
            DeviceError: If the device gave out, likewise.
            LaneError: If memory did.
        """
        reports = [Report(id=case.id) for case in cases]
        contacts: Sequence[ForceField | WorkbenchError | None] = [None] * len(cases)
        if self.recipe.solvers is not Solvers.FEM:
            contacts = self._press(cases, reports)
        for case, contact, report in zip(cases, contacts, reports, strict=True):
            begun, cpu = time.perf_counter(), time.process_time()
            with _kept(report):
                if isinstance(contact, WorkbenchError):
                    raise contact
                if self.recipe.solvers is Solvers.MPM:
                    assert contact is not None
                    for frame in range(case.frames):
                        self._write(case, frame, contact, None, report)
                else:
                    self._converge(case, contact, report)
            report.seconds += time.perf_counter() - begun
            report.cpu_s += time.process_time() - cpu
        return reports

    def _press(
        self, cases: Sequence[Case], reports: Sequence[Report]
    ) -> list[ForceField | WorkbenchError | None]:
        """Contact of all cases, side by side; their time is shared out by their frames."""
        from sim.contact.press import press_side_by_side

        begun, cpu = time.perf_counter(), time.process_time()
        assert self.points is not None
        settings = ContactSettings(grid_mm=self.recipe.grid_mm)
        presses = [
            (
                self.recipe.material(case.drawn),
                PressCase(
                    indenter=self.recipe.indenter(case.indenter, case.drawn),
                    press=case.press,
                    settings=settings,
                ),
            )
            for case in cases
        ]
        try:
            found = press_side_by_side(self.mesh, self.points, presses, monitor=self._watch)
        except MemoryError as error:
            raise _out_of_memory(f"{len(cases)} presses side by side") from error
        frames = sum(case.frames for case in cases)
        seconds, cpu_s = time.perf_counter() - begun, time.process_time() - cpu
        for case, report in zip(cases, reports, strict=True):
            share = case.frames / frames
            report.mpm_s, report.seconds = seconds * share, seconds * share
            report.cpu_s = cpu_s * share
        return [one if isinstance(one, WorkbenchError) else from_contact(one) for one in found]

    def _converge(self, case: Case, contact: ForceField | None, report: Report) -> None:
        """Solve by finite elements and write each frame as it converges."""
        from sim.contact.region.placing import place_object
        from sim.fem.press import sampling_grid_mm, solve_press
        from workbench.pipeline.devices import solver_device

        begun, aside_s = time.perf_counter(), 0.0
        settings = FemSettings(hex_mm=self.recipe.hex_mm, error=False)
        indenter = self.recipe.indenter(case.indenter, case.drawn)
        frame_of: Any = contact
        if contact is None:
            frame_of = place_object(
                self.mesh.outer, indenter, case.press, grid_mm=sampling_grid_mm(settings)
            )

        def converged(frame: int, outcome: FemFrame) -> None:
            nonlocal aside_s
            started = time.perf_counter()
            self._write(case, frame, contact, _one_frame(outcome, frame_of), report)
            aside_s += time.perf_counter() - started

        try:
            solve_press(
                self.mesh,
                self.recipe.material(case.drawn),
                PressCase(indenter=indenter, press=case.press, fem=settings),
                device=solver_device(),
                monitor=self._watch,
                on_frame=converged,
            )
        finally:
            report.fem_s = time.perf_counter() - begun - aside_s

    def _cameras(self, case: Case) -> Cameras:
        """Those that see a case, opened when first asked for."""
        number = case.drawn.look or 0
        if number not in self._opened:
            sight = self.setup.sights[number]
            self._opened[number] = sight.cameras(self.mesh, self._store)
        return self._opened[number]

    def _watch(self, fraction: float, note: str = "") -> None:
        if self.stop.value:
            raise Cancelled("stopped", hint="make goes on where it was")

    def _write(
        self,
        case: Case,
        frame: int,
        contact: ForceField | None,
        solved: ForceField | None,
        report: Report,
    ) -> None:
        """Write one sample unless it is there.

        Args:
            case: Whose it is.
            frame: Its frame.
            contact: All frames by the contact solver.
            solved: This frame alone by the finite elements.
            report: Told the time of images, and that it was written.
        """
        path = self.setup.folder / SAMPLES / case.id / sample_name(frame)
        if path.exists():
            return
        found = [
            (field, row) for field, row in ((contact, frame), (solved, 0)) if field is not None
        ]
        posed, row = found[0]
        begun = time.perf_counter()
        views = self._cameras(case).views(posed, row) if self.setup.sights else Views()
        report.image_s += time.perf_counter() - begun
        sample = Sample(
            case=case.id,
            frame=frame,
            recipe=self.setup.key,
            indenter=case.indenter.value,
            depth_mm=case.depth_at(frame),
            shear_mm=case.shear_at(frame),
            pose=posed.indenter_pose[row],
            target_mm=posed.target_mm,
            normal=posed.normal,
            tangent_u=posed.tangent_u,
            mpm=None if contact is None else _solved(contact, frame, stress=False),
            fem=None if solved is None else _solved(solved, 0, stress=True),
            png=views.png,
            png_markers=views.png_markers,
            markers_px=views.markers_px,
        )
        write_atomically(path, to_bytes(sample))
        report.written += 1


@contextlib.contextmanager
def _kept(report: Report) -> Iterator[None]:
    """Put what goes wrong with one case into its report; what is wrong with all goes on up."""
    try:
        yield
    except (Cancelled, StoreError, DeviceError):
        raise
    except MemoryError as error:
        raise _out_of_memory(report.id) from error
    except WorkbenchError as error:
        report.error = {**error.as_dict(), "frame": getattr(error, "frame", -1)}
    except (RuntimeError, ArithmeticError, ValueError, LookupError) as error:
        # A bug in one case must not cost the others; it is kept with its name.
        report.error = {"error": type(error).__name__, "message": str(error), "frame": -1}


def _out_of_memory(what: str) -> LaneError:
    return LaneError(
        f"{what} ran out of memory",
        hint="finished samples are kept; make it again with fewer --jobs or a smaller --batch",
        at="dataset",
    )


def _one_frame(outcome: FemFrame, frame_of: Any) -> ForceField:
    """A converged frame as a result of one frame; `frame_of` knows target, normal and U."""
    fields: dict[str, Any] = {
        item.name: np.asarray(getattr(outcome, item.name))[None]
        for item in dataclasses.fields(outcome)
    }
    return ForceField(
        source=Source.FEM,
        **fields,
        target_mm=frame_of.target_mm,
        normal=frame_of.normal,
        tangent_u=frame_of.tangent_u,
    )


def _solved(field: ForceField, frame: int, *, stress: bool) -> Solved:
    cauchy = {"cauchy_MPa": field.cauchy_MPa[frame]} if stress else {}
    return Solved(
        displacement_mm=field.displacement_mm[frame],
        contact_force_N=field.contact_force_N[frame],
        sliding=field.sliding[frame],
        reaction_N=field.reaction_N[frame],
        tangential_N=float(field.tangential_N[frame]),
        residual=float(field.residual[frame]),
        balance=float(field.balance[frame]),
        converged=bool(field.converged[frame]),
        seconds=float(field.frame_seconds[frame]),
        sliding_share=float(field.sliding_share[frame]),
        **cauchy,
    )
