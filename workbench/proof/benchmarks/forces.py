"""Forces: frames per second of the network on membranes of 1,000, 5,000 and 25,000 points.

Weights are untrained, which takes the same time. A frame is one displacement field in and one force
field out, the copies to and from the device included: on the whole skin with its voxels and kernel
maps at hand, in the fastest type and in float32; and as the source `learned` asks for it, in
float32 on the patch around a dent, which is found anew each time and looked at from several sides.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from workbench.proof.benchmarks.timing import RUNS, median_s
from workbench.proof.row import Row, bounded, stated

if TYPE_CHECKING:
    from sim.forces.network.predictor import Predictor
    from sim.forces.network.spec import NetworkSpec
    from sim.forces.network.weights import NetworkWeights

SIZES = (
    ("1k", 1_000, {"cpu": 75.0, "cuda": 1500.0}),
    ("5k", 5_000, {"cpu": 25.0, "cuda": 1000.0}),
    ("25k", 25_000, {"cpu": 5.0, "cuda": 500.0}),
)
"""Name, points, and frames per second asked of two CPU cores and of a data-centre GPU."""
NETWORKS = ("paper", "small")
DENT_MM = 2.5
PATCH_LEAST_FPS = {"cuda": 300.0}
"""Asked of a data-centre GPU, of patches; of a CPU nothing is."""
CPU_THREADS = 2
WARMING = 3
RUN_S = 0.3
"""A run counts frames for about this long, so that a clock's grain does not matter."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Measured:
    """Frame rate of a network on a membrane."""

    name: str
    """Of the size."""
    case: str
    """Network, points, type and device."""
    fps: float
    least_fps: float
    """What is asked of the device; 0: nothing."""


def rows() -> list[Row]:
    """All rows of the room: as fast as it goes, in float32, and as `learned` asks for it."""
    found = []
    for network in NETWORKS:
        for live, single in zip(paces(network), paces(network, single=True), strict=True):
            found += [live_row("inference", live), _single_row(single)]
    return [*found, patch_row()]


def live_row(name: str, live: Measured) -> Row:
    """Frames per second with voxels and kernel maps at hand, in the fastest type."""
    row, least = f"{name}_{live.name}", live.least_fps
    return bounded(row, live.case, live.fps, unit="1/s", limit=least, sense="min")


def _single_row(single: Measured) -> Row:
    """The same in float32, as an evaluation uses it; nothing is asked of it."""
    return stated(f"inference_{single.name}", single.case, single.fps, unit="1/s")


def patch_row() -> Row:
    """A dent of 2.5 mm in the largest membrane, as `learned` asks for it."""
    found = patch_pace()
    name = f"inference_patch_{found.name}"
    if not found.least_fps:
        return stated(name, found.case, found.fps, unit="1/s")
    return bounded(name, found.case, found.fps, unit="1/s", limit=found.least_fps, sense="min")


def patch_pace() -> Measured:
    """The same as a frame rate."""
    from sim.forces.network.patches import LOOKS, PatchPredictor
    from sim.forces.training.settings import PRESETS
    from workbench.pipeline.devices import torch_device

    name, points, _ = SIZES[-1]
    places_mm, device = shell(points), torch_device()
    small = untrained("small")
    spec = dataclasses.replace(small.spec, input_channels=6)
    weights = dataclasses.replace(
        small,
        spec=spec,
        arrays=_arrays(spec),
        force_scale_N=1.0,
        corrects=True,
        patch_spacings=PRESETS["small"].patch_spacings,
    )
    given = np.zeros((points, 6), np.float32)
    dent = np.linalg.norm(places_mm - places_mm[0], axis=1) < DENT_MM
    given[dent] = np.random.default_rng(0).normal(size=(int(dent.sum()), 6))
    predictor = PatchPredictor(weights, places_mm, device=device)
    fps = _rate(lambda: predictor.predict(given))
    case = f"small network, learned: a dent of {int(dent.sum())} of {points} points, {LOOKS} looks"
    return Measured(
        name=name,
        case=f"{case}, float32, {device}",
        fps=fps,
        least_fps=PATCH_LEAST_FPS.get(device, 0.0),
    )


def paces(network: str, *, single: bool = False) -> Iterator[Measured]:
    """Frames per second on the three sizes, on two cores at most or on the GPU.

    Args:
        network: Name of its size.
        single: In float32, as an evaluation uses it, else as the browser does.
    """
    import torch

    from workbench.pipeline.devices import torch_device

    device = torch_device()
    for name, points, least_fps in SIZES:
        threads = torch.get_num_threads()
        torch.set_num_threads(min(CPU_THREADS, threads))
        try:
            predictor = _predictor(points, network, device, single=single)
            fps = _fps(predictor, points)
        finally:
            torch.set_num_threads(threads)
        use = "evaluation" if single else "live"
        case = _case(use, predictor, points, network, device)
        yield Measured(name=name, case=case, fps=fps, least_fps=least_fps[device])


def _predictor(points: int, network: str, device: str, *, single: bool) -> Predictor:
    """A network on the shell; only the live one is worth a minute of compiling."""
    from sim.forces.network.acceleration import Acceleration
    from sim.forces.network.predictor import Precision, Predictor

    return Predictor(
        untrained(network),
        shell(points),
        device=device,
        precision=Precision.SINGLE if single else Precision.AUTO,
        acceleration=Acceleration.GRAPH if single else Acceleration.AUTO,
    )


def _case(use: str, predictor: Predictor, points: int, network: str, device: str) -> str:
    kind = str(predictor.dtype).removeprefix("torch.")
    where = device if device == "cpu" else f"{device}, {predictor.acceleration}"
    case = f"{network} network, {use}: {points} points, {kind}, {where}"
    return "; ".join((case, *predictor.notes))


def shell(points: int) -> np.ndarray:
    """A finger-like skin: half a sphere on a tube.

    Points lie along a golden spiral, each with the same area. R = 10 mm, tube 25 mm.

    Returns:
        Points [mm], shape (points, 3), float32.
    """
    radius_mm, tube_mm = 10.0, 25.0
    cap_mm2, tube_mm2 = 2 * math.pi * radius_mm**2, 2 * math.pi * radius_mm * tube_mm
    number = np.arange(points) + 0.5
    area_mm2 = number / points * (cap_mm2 + tube_mm2)
    z_mm = np.where(area_mm2 < cap_mm2, radius_mm, 0.0) - np.where(
        area_mm2 < cap_mm2, area_mm2, area_mm2 - cap_mm2
    ) / (2 * math.pi * radius_mm)
    ring_mm = np.sqrt(radius_mm**2 - np.clip(z_mm, 0.0, None) ** 2)
    turn = number * math.pi * (3.0 - math.sqrt(5.0))
    places = np.stack([ring_mm * np.cos(turn), ring_mm * np.sin(turn), z_mm], axis=1)
    return places.astype(np.float32)


def untrained(network: str) -> NetworkWeights:
    """Weights that were never trained."""
    from sim.forces.network.spec import SPECS, Target
    from sim.forces.network.voxels import VOXEL_PER_SPACING
    from sim.forces.network.weights import NetworkWeights

    spec = SPECS[network]
    return NetworkWeights(
        spec=spec,
        arrays=_arrays(spec),
        target=Target.FORCE,
        input_scale_mm=1.0,
        output_scale=(1.0,) * spec.output_channels,
        voxel_per_spacing=VOXEL_PER_SPACING,
        spacing_mm=1.0,
        card={},
    )


def _arrays(spec: NetworkSpec) -> dict[str, np.ndarray]:
    from sim.forces.network.minkunet import arrays_of, new_network

    return arrays_of(new_network(spec))


def _fps(predictor: Predictor, points: int) -> float:
    """Frames per second on a whole skin."""
    displacement_mm = np.random.default_rng(0).normal(size=(points, 3)).astype(np.float32)
    return _rate(lambda: predictor.predict(displacement_mm))


def _rate(frame: Callable[[], object]) -> float:
    """Frames per second, median of some runs."""
    for _ in range(WARMING):
        frame()
    frames = max(1, round(RUN_S / median_s(frame, runs=1)))

    def run() -> None:
        for _ in range(frames):
            frame()

    return frames / median_s(run, runs=RUNS)
