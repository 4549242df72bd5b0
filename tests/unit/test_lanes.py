"""Worker lanes: results through the store, cancel within 3 s, a dead worker is an error."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from sim.contact import press as contact
from workbench.core.base.errors import Cancelled, DesignError, LaneError
from workbench.core.base.monitor import silent
from workbench.core.design.design import Layers
from workbench.edit.forms import resolve_shape
from workbench.live import lane_process, lanes
from workbench.live.lanes import Lane
from workbench.pipeline.stage import Call
from workbench.pipeline.stages import build
from workbench.pipeline.store import Store
from workbench.planning.stage_table import STAGES

CANCEL_LIMIT_S = 3.0
"""The promise to the designer; the lane kills after 2 s."""

START_LIMIT_S = 10.0
"""A new process imports for a second or two; two noisy cores stretch it."""


@pytest.fixture(scope="module")
def lane(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lane]:
    """A worker with the stages of `tests.unit.slow_stages` beside the real ones."""
    folder = tmp_path_factory.mktemp("store")
    patch = pytest.MonkeyPatch()
    patch.setenv("PYTHONPATH", str(Path(__file__).parent))
    patch.setitem(lanes.WARM_UP, "cad", ("slow_stages",))
    patch.syspath_prepend(str(Path(__file__).parent))
    import slow_stages  # noqa: F401

    lane = Lane("cad", Store(folder))
    yield lane
    lane.close()
    for name in ("nap", "deaf", "die", "compile_one"):
        del STAGES[name]
    patch.undo()


THICK = Layers(elastomer_mm=15.0)


def call_of(name: str, value: float | str) -> Call:
    """A call of a stage that the worker can import too."""
    import slow_stages

    return slow_stages.call_of(name, value)


def finger() -> Call:
    return build.STAGE.call(
        build.BuildInputs(family="finger", shape=resolve_shape("finger", {}), layers=Layers())
    )


def test_result_arrives_through_the_store(lane: Lane) -> None:
    """The outcome names the key; the store holds a finger of 7.46 ml."""
    call = finger()
    outcome = lane.run(call, silent)
    assert outcome.key == call.key
    assert not outcome.cached
    # pi (15^2 - 13^2) 27 + 2/3 pi (15^3 - 13^3) mm3.
    assert lane.store.load("build", call.key).volume_mm3 == pytest.approx(7217.0, rel=1e-3)


def test_refused_input_raises_here(lane: Lane) -> None:
    """A DesignError of the worker keeps its field."""
    call = build.STAGE.call(
        build.BuildInputs(
            family="finger", shape=resolve_shape("finger", {}), layers=Layers(elastomer_mm=15.0)
        )
    )
    with pytest.raises(DesignError) as caught:
        lane.run(call, silent)
    assert caught.value.at == "layers.elastomer_mm"


@pytest.mark.parametrize("stage", ["nap", "deaf"])
def test_cancel_returns_within_3_seconds(lane: Lane, stage: str) -> None:
    """A stage that listens stops at once; one that never listens is killed and replaced."""
    asked: list[float] = []

    def monitor(fraction: float, note: str = "") -> None:
        if fraction > 0 or stage == "deaf":
            asked.append(time.monotonic())
            raise Cancelled("stop")

    with pytest.raises(Cancelled):
        lane.run(call_of(stage, 60.0), monitor)
    assert time.monotonic() - asked[0] < CANCEL_LIMIT_S
    assert not lane.store.has(stage, call_of(stage, 60.0).key)
    assert lane.run(call_of("nap", 0.01), silent).stage == "nap"


def test_dead_worker_is_an_error_and_is_replaced(lane: Lane) -> None:
    """Signal 11 in the worker is a LaneError that names it; the next call works."""
    with pytest.raises(LaneError, match="signal 11"):
        lane.run(call_of("die", int(signal.SIGSEGV)), silent)
    assert lane.run(call_of("nap", 0.02), silent).stage == "nap"


def test_bug_in_a_stage_brings_its_traceback(lane: Lane) -> None:
    """An unforeseen exception is a LaneError whose hint holds the traceback."""
    with pytest.raises(LaneError, match="TypeError") as caught:
        lane.run(call_of("nap", "soon"), silent)
    assert "Traceback" in caught.value.hint


def test_monitor_that_breaks_frees_the_lane(lane: Lane) -> None:
    """A bug in the monitor is raised as it is, and the next call neither waits nor mixes up."""

    def broken(fraction: float, note: str = "") -> None:
        raise ZeroDivisionError("bug")

    with pytest.raises(ZeroDivisionError):
        lane.run(call_of("deaf", 60.0), broken)
    start = time.monotonic()
    assert lane.run(call_of("nap", 0.03), silent).key == call_of("nap", 0.03).key
    assert time.monotonic() - start < START_LIMIT_S


def test_reply_to_another_job_is_dropped(lane: Lane, monkeypatch: pytest.MonkeyPatch) -> None:
    """An answer that carries an older number is not taken for this job's."""
    call = call_of("nap", 0.04)
    pipe = lane._pipe
    replies = [(-7, "done", "foreign")]

    class Mixed:
        """The lane's pipe, with a foreign answer in front."""

        send = staticmethod(pipe.send)

        def poll(self, seconds: float) -> bool:
            return bool(replies) or pipe.poll(seconds)

        def recv(self) -> Any:
            return replies.pop() if replies else pipe.recv()

    monkeypatch.setattr(lane, "_pipe", Mixed())
    assert lane.run(call, silent).key == call.key


def test_process_that_died_before_the_call_is_an_error(
    lane: Lane, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A pipe that broke before the call was sent is a LaneError, not a crash."""
    lane._process.kill()
    lane._process.join()
    with monkeypatch.context() as patch:
        patch.setattr(lane._process, "is_alive", lambda: True)
        with pytest.raises(LaneError, match="signal 9"):
            lane.run(call_of("nap", 0.05), silent)
    assert lane.run(call_of("nap", 0.05), silent).stage == "nap"


def test_failed_warm_up_names_the_missing_module(tmp_path: Path) -> None:
    """A library that cannot be imported is named in a LaneError; the process lives on."""
    patch = pytest.MonkeyPatch()
    patch.setitem(lanes.WARM_UP, "cad", ("no_such_library",))
    lane = Lane("cad", Store(tmp_path))
    patch.undo()
    try:
        for _ in range(2):
            with pytest.raises(LaneError, match="cannot import no_such_library") as caught:
                lane.run(finger(), silent)
            assert "workbench doctor" in caught.value.hint
        assert lane._process.is_alive()
    finally:
        lane.close()


def test_closing_ends_a_running_call(tmp_path: Path) -> None:
    """close() while a call runs raises Cancelled in the waiting thread."""
    patch = pytest.MonkeyPatch()
    patch.setitem(lanes.WARM_UP, "cad", ())
    lane = Lane("cad", Store(tmp_path))
    patch.undo()
    caught: list[Any] = []

    def work() -> None:
        try:
            lane.run(finger(), silent)
        except Cancelled as error:
            caught.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    time.sleep(0.3)
    lane.close()
    thread.join(10)
    assert len(caught) == 1


def test_what_an_idle_worker_compiled_is_kept_when_the_workbench_closes(
    lane: Lane, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Taichi writes its kernels when a process ends; who is killed has compiled for nothing."""
    kernels = tmp_path / "kernels"
    monkeypatch.setenv("TI_OFFLINE_CACHE_FILE_PATH", str(kernels))
    monkeypatch.setattr(lanes, "WARM_UP", {"cad": ("slow_stages",)})
    runner = lanes.LaneRunner(Store(tmp_path / "store"))
    runner.run(call_of("compile_one", 7), silent)
    assert not list(kernels.rglob("*.tic"))
    runner.close()
    assert list(kernels.rglob("*.tic"))
    with pytest.raises(Cancelled):
        runner.run(call_of("nap", 0.02), silent)


def test_worker_follows_a_killed_parent(tmp_path: Path) -> None:
    """After kill -9 of the server no worker is left within a few seconds."""
    import subprocess
    import sys

    code = (
        "import time; from workbench.live.lanes import Lane, WARM_UP;"
        "from workbench.pipeline.store import Store;"
        f"WARM_UP['cad'] = (); lane = Lane('cad', Store({str(tmp_path)!r}));"
        "print(lane._process.pid, flush=True); time.sleep(60)"
    )
    guarded = f"if __name__ == '__main__':\n    {code}"
    script = tmp_path / "parent.py"
    script.write_text(guarded)
    with subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE, text=True) as run:
        assert run.stdout is not None
        worker = int(run.stdout.readline())
        time.sleep(1.0)
        run.kill()
    deadline = time.monotonic() + 10
    while time.monotonic() < deadline and _alive(worker):
        time.sleep(0.1)
    assert not _alive(worker)


def _alive(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False
    os.kill(pid, 0)
    return state != "Z"


@pytest.mark.slow
def test_rehearsal_is_a_press_that_settles(monkeypatch: pytest.MonkeyPatch) -> None:
    """The block pushes back, so the kernels loaded are those of a real press."""
    pressed: list[Any] = []
    real = contact.press_membrane

    def recorded(*inputs: Any) -> Any:
        pressed.append(real(*inputs))

    monkeypatch.setattr(contact, "press_membrane", recorded)
    lane_process._rehearse()
    (found,) = pressed
    assert found.normal_N[-1] > 0
