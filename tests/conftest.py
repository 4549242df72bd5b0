"""Bodies that several tests look at, built once."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

from designs.family import family, resolve_shape
from workbench.core.design.design import Layers, Meshing, SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MembraneMesh, Solid
from workbench.pipeline.store import Store
from workbench.planning.plan import InlineRunner, evaluate, plan

# Other work on the machine must not fail an example that is merely slow.
settings.register_profile("patient", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("patient")
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # A shell's background job ignores Ctrl-C, and so would the programs that tests stop by it.
    signal.signal(signal.SIGINT, signal.default_int_handler)


LONGEST = tuple(
    f"test_{name}.py"
    for name in (
        *("calibrate_twin", "calibrate", "whole_task", "tabs", "sources", "compare", "view"),
        *("browser", "labels", "soak", "kill"),
    )
)
"""Files that take minutes; a few of them are most of what a browser is tested with."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files with slow tests come first, of them the longest in their order: one that begins last
    leaves the other cores idle."""
    slow = {item.path for item in items if item.get_closest_marker("slow")}

    def place(item: pytest.Item) -> tuple[bool, int]:
        long = item.path in slow and item.path.name in LONGEST
        return item.path not in slow, LONGEST.index(item.path.name) if long else len(LONGEST)

    items.sort(key=place)


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip what is marked `gpu` on a machine without one."""
    if item.get_closest_marker("gpu"):
        import torch

        if not torch.cuda.is_available():
            pytest.skip("needs a CUDA device")


@pytest.fixture(scope="session")
def results(tmp_path_factory: pytest.TempPathFactory) -> Store:
    """Results that tests look at, wherever they were computed: all workers of a test run have one
    store. What is about computing itself, or makes results up, has a store of its own."""
    base = tmp_path_factory.getbasetemp()
    return Store((base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "results")


@pytest.fixture(scope="session")
def made(results: Store) -> Callable[[SensorDesign, str], Any]:
    """A function of a design and a stage that returns the result, computed once in a test run."""

    def result(design: SensorDesign, stage: str) -> Any:
        case = PressCase()
        for _ in evaluate(design, case, InlineRunner(results), wanted=(stage,)):
            pass
        return results.load(stage, plan(design, case)[stage].key)

    return result


@pytest.fixture(scope="session")
def default_solid(made: Callable[[SensorDesign, str], Any]) -> Callable[[str], Solid]:
    """A function that returns the default shape of a family."""
    return lambda family: made(SensorDesign(family=family), "build")


@pytest.fixture(scope="session")
def build_finger() -> Callable[..., Solid]:
    """A function that builds a finger: shape parameters by name, and `layers`."""
    from geometry.body.solid import assemble

    def build(layers: Layers | None = None, **shape: Any) -> Solid:
        bodies = family("finger").build(resolve_shape("finger", shape), layers or Layers())
        return assemble(bodies)

    return build


@pytest.fixture(scope="session")
def finger(build_finger: Callable[..., Solid]) -> Solid:
    """The default finger: R 15, cylinder 27, wall 2, support 1 mm."""
    return build_finger()


@pytest.fixture(scope="session")
def finger_mesh(finger: Solid) -> MembraneMesh:
    """The default finger in hexahedra of 0.4 mm."""
    from geometry.volume.hexmesh import mesh_membrane

    return mesh_membrane(finger, Meshing())


@pytest.fixture(scope="session")
def taichi_device() -> str:
    """Taichi, initialised once in the thread of the tests: `cpu` or `cuda`."""
    from workbench.pipeline.devices import open_device

    return open_device()
