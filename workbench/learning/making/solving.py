"""One worker of a data set: opens the device and the cameras once, then solves case after case.

A case is pressed by the contact solver first, as a whole: here, or by a presser that has a GPU, for
which the press is prepared here and its frames are read here. The finite elements then hand over
each frame as it converges, and its sample is written at once, so a killed process loses one frame
of theirs and the press before it. Both solvers press on the same skin, that of the hexahedra, so
they share vertices, first touch and path. Images show the displacement of the contact solver, as in
the paper, or of the finite elements where they are alone.
"""

from __future__ import annotations

import contextlib
import dataclasses
import time
from collections.abc import Iterator
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
from workbench.learning.making.parcels import Parcel, packed, unpacked
from workbench.learning.making.worker_messages import Report, SettledPress, Setup
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

    def solve(self, case: Case) -> Report:
        """Make the samples of a case, all of it here; what goes wrong is in the report.

        Raises:
            Cancelled: If this data set is to stop.
            StoreError: If a sample cannot be written: the disk is full, not the case at fault.
            DeviceError: If the device gave out, likewise.
            LaneError: If memory did.
        """
        report = Report(id=case.id)
        with _kept(report):
            contact = None if self.recipe.solvers is Solvers.FEM else self._press(case, report)
            self._make(case, contact, report)
        return report

    def prepare(self, case: Case) -> bytes | Report:
        """A press made ready for a presser, as a parcel; or why there is none.

        Raises:
            As `solve`.
        """
        from sim.contact.readout.problem import make_problem

        report = Report(id=case.id)
        with _kept(report):
            assert self.points is not None
            problem = make_problem(
                self.mesh, self.points, self.recipe.material(case.drawn), self._press_case(case)
            )
            return packed(problem, self.mesh)
        return report

    def finish(self, case: Case, problem: Parcel, pressed: SettledPress) -> Report:
        """Make the samples of a press that a presser has settled.

        Raises:
            As `solve`.
        """
        from sim.contact.solver.states import read_states

        report = Report(
            id=case.id, mpm_s=pressed.seconds, seconds=pressed.seconds, cpu_s=pressed.cpu_s
        )
        with _kept(report):
            begun = time.perf_counter()
            contact = read_states(unpacked(problem, self.mesh), unpacked(pressed.states))
            report.mpm_s += time.perf_counter() - begun
            self._make(case, from_contact(contact), report)
        return report

    def _make(self, case: Case, contact: ForceField | None, report: Report) -> None:
        """Write the samples of a case whose contact is known, where it is asked for."""
        if self.recipe.solvers is not Solvers.MPM:
            self._converge(case, contact, report)
            return
        assert contact is not None
        for frame in range(case.frames):
            self._write(case, frame, contact, None, report)

    def _press_case(self, case: Case) -> PressCase:
        return PressCase(
            indenter=self.recipe.indenter(case.indenter, case.drawn),
            press=case.press,
            settings=ContactSettings(grid_mm=self.recipe.grid_mm),
        )

    def _press(self, case: Case, report: Report) -> ForceField:
        from sim.contact.press import press_membrane

        begun = time.perf_counter()
        assert self.points is not None
        contact = press_membrane(
            self.mesh,
            self.points,
            self.recipe.material(case.drawn),
            self._press_case(case),
            monitor=self._watch,
        )
        report.mpm_s = time.perf_counter() - begun
        return from_contact(contact)

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
    """Put time and what goes wrong with one case into its report; other errors go on up."""
    begun, cpu = time.perf_counter(), time.process_time()
    try:
        yield
    except (Cancelled, StoreError, DeviceError):
        raise
    except MemoryError as error:
        raise LaneError(
            f"{report.id} ran out of memory",
            hint="finished samples are kept; make it again with fewer --jobs",
            at="dataset",
        ) from error
    except WorkbenchError as error:
        report.error = {**error.as_dict(), "frame": getattr(error, "frame", -1)}
    except (RuntimeError, ArithmeticError, ValueError, LookupError) as error:
        # A bug in one case must not cost the others; it is kept with its name.
        report.error = {"error": type(error).__name__, "message": str(error), "frame": -1}
    finally:
        report.seconds += time.perf_counter() - begun
        report.cpu_s += time.process_time() - cpu


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
