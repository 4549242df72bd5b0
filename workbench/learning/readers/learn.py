"""Teach a network on views until time is up, or all epochs are through.

The rate rises for a moment, then falls as a cosine of the time that is over, so that a training of
any length ends with small steps. What is used is a running average of the weights.
"""

from __future__ import annotations

import copy
import math
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.learning.readers.lesson import Lesson
from workbench.learning.readers.scoring import judged, scores
from workbench.learning.training.checkpoint import read_checkpoint, write_checkpoint

if TYPE_CHECKING:
    import torch

    from sim.reading.network.unet import UNet

LAST_RATE, WARMING = 1e-5, 0.03
WEIGHT_DECAY, LARGEST_STEP = 1e-4, 1.0
AVERAGE = 0.998
"""Share of the old in the running average of weights, after the first steps."""
BATCHES = {"cuda": 48, "cpu": 8}
ROUND_S = {"cuda": 15.0, "cpu": 120.0}
"""Time between two rows of the curves, each with a checkpoint."""
WATCHED = 48
"""Validation views of a row."""
CROPPED_UNTIL, CROPPED = {"cuda": 0.0, "cpu": 0.95}, 0.9
"""Share of the training in which this share of batches is cut to the part around the contact, which
takes a quarter of the time; the rest sees whole images."""
WINDOW = (128, 160)
"""Rows and columns of such a part."""
AHEAD = 6
"""Batches that threads make ready."""

Row = dict[str, Any]


@dataclass
class _Course:
    """How far a training is."""

    network: UNet
    average: UNet
    optimiser: Any
    views: int = 0
    seconds: float = 0.0
    rows: list[Row] = field(default_factory=list)


def learn(
    lesson: Lesson, folder: Path, tell: Callable[[float, Row | None], None]
) -> tuple[UNet, list[Row]]:
    """Train, or go on with a training.

    Args:
        lesson: What is learned.
        folder: Holds the checkpoint.
        tell: Told the share that is done, and a row where one is new; raises `Cancelled` to stop.

    Returns:
        The averaged network with its normalisation, for use; rows of the curves.

    Raises:
        StoreError: If the checkpoint is another training's, or cannot be written.
    """
    import torch

    course = _begun(lesson, folder)
    generator = torch.Generator(device=lesson.device).manual_seed(lesson.seed + course.views + 1)
    losses: list[float] = []
    clock = told_s = time.monotonic()
    for batch in _batches(lesson, course.views):
        done = _done(lesson, course)
        if done >= 1.0:
            break
        tell(done, None)
        losses.append(_step(lesson, course, batch, done, generator))
        now = time.monotonic()
        course.seconds, clock = course.seconds + now - clock, now
        course.views += len(batch[0])
        if now - told_s > ROUND_S[lesson.device]:
            told_s = now
            _row(lesson, course, losses)
            _keep(lesson, course, folder)
            tell(_done(lesson, course), course.rows[-1])
    if losses:
        _row(lesson, course, losses)
        _keep(lesson, course, folder)
    return course.average.eval(), course.rows


def _begun(lesson: Lesson, folder: Path) -> _Course:
    import torch

    from sim.reading.network.unet import channels_last

    torch.manual_seed(lesson.seed)
    network = channels_last(lesson.network().to(lesson.device))
    average = copy.deepcopy(network)
    optimiser = torch.optim.AdamW(network.parameters(), lr=lesson.rate, weight_decay=WEIGHT_DECAY)
    course = _Course(network=network, average=average, optimiser=optimiser)
    kept = read_checkpoint(folder, lesson.key)
    if kept is not None:
        network.load_state_dict(kept["network"])
        average.load_state_dict(kept["average"])
        optimiser.load_state_dict(kept["optimiser"])
        course.views, course.seconds = kept["views"], kept["seconds"]
        course.rows = kept["rows"]
    network.train()
    return course


def _keep(lesson: Lesson, course: _Course, folder: Path) -> None:
    content = {
        "network": course.network.state_dict(),
        "average": course.average.state_dict(),
        "optimiser": course.optimiser.state_dict(),
        "views": course.views,
        "seconds": course.seconds,
        "rows": course.rows,
    }
    write_checkpoint(folder, lesson.key, content)


def _done(lesson: Lesson, course: _Course) -> float:
    """Share of the training that is over: of its time or of its epochs, whichever is more."""
    by_time = course.seconds / max(lesson.seconds, 1e-3)
    by_views = course.views / (lesson.epochs * len(lesson.learned)) if lesson.epochs else 0.0
    return max(by_time, by_views)


def _rate(largest: float, done: float) -> float:
    if done < WARMING:
        return largest * (0.05 + 0.95 * done / WARMING)
    along = (done - WARMING) / (1.0 - WARMING)
    return LAST_RATE + 0.5 * (largest - LAST_RATE) * (1.0 + math.cos(math.pi * min(along, 1.0)))


Batch = tuple[Sequence[int], Any]


def _batches(lesson: Lesson, seen: int) -> Iterator[Batch]:
    """Batches without end: all views in another order each time, made ready by threads."""
    size = min(BATCHES[lesson.device], len(lesson.learned))

    def numbers() -> Iterator[list[int]]:
        turn = 0
        while True:
            rng = np.random.default_rng((lesson.seed, seen, turn))
            order = rng.permutation(len(lesson.learned))
            for first in range(0, len(order) - size + 1, size):
                yield order[first : first + size].tolist()
            turn += 1

    wanted = numbers()
    threads = AHEAD if lesson.device == "cuda" else 1
    with ThreadPoolExecutor(threads) as pool:
        ready: list[tuple[list[int], Future[Any]]] = []
        while True:
            while len(ready) < threads + 1:
                chosen = next(wanted)
                ready.append((chosen, pool.submit(lesson.learned.batch, chosen, lesson.device)))
            chosen, future = ready.pop(0)
            yield chosen, future.result()


def _step(
    lesson: Lesson, course: _Course, batch: Batch, done: float, generator: torch.Generator
) -> float:
    """One step; returns its loss."""
    import torch

    from sim.reading.network.augment import Disturbance, disturbed
    from sim.reading.network.crops import cut_to_contact, wider
    from sim.reading.network.given import given
    from sim.reading.network.loss import loss
    from sim.reading.network.shifts import SHIFT_PX, shifted

    idle, photos, wanted = batch[1]
    rng = np.random.default_rng((lesson.seed, course.views))
    with torch.no_grad():
        idle, photos, wanted = shifted(idle, photos, wanted, generator)
        idle, photos = disturbed(idle, photos, Disturbance(), generator)
        enters = given(idle, photos)
        height = photos.shape[2]
        if done < CROPPED_UNTIL[lesson.device] and rng.random() < CROPPED:
            boxes = [wider(lesson.learned.views[n].box, round(SHIFT_PX)) for n in batch[0]]
            enters, wanted = cut_to_contact(enters, wanted, boxes, WINDOW, rng)
            height = wanted.depth_mm.shape[1]
        enters = enters.contiguous(memory_format=torch.channels_last)
    half = torch.autocast("cuda", torch.bfloat16, enabled=lesson.device == "cuda")
    with half:
        maps, force = course.network(enters)
    cut = maps[:, :, :height].float()
    total = torch.stack(list(loss(cut, force.float(), wanted, lesson.scales).values())).sum()
    course.optimiser.zero_grad(set_to_none=True)
    total.backward()
    torch.nn.utils.clip_grad_norm_(course.network.parameters(), LARGEST_STEP)
    for group in course.optimiser.param_groups:
        group["lr"] = _rate(lesson.rate, done)
    course.optimiser.step()
    steps = course.views / len(batch[0])
    _average(course, min(AVERAGE, (1.0 + steps) / (10.0 + steps)))
    return float(total.detach())


def _average(course: _Course, share: float) -> None:
    import torch

    with torch.no_grad():
        own = course.network.state_dict()
        for name, value in course.average.state_dict().items():
            if value.dtype.is_floating_point:
                value.lerp_(own[name], 1.0 - share)
            else:
                value.copy_(own[name])


def _row(lesson: Lesson, course: _Course, losses: list[float]) -> None:
    """Add a row: losses since the last one, and how good the average is on validation views."""
    course.average.eval()
    found = scores(
        judged(course.average, lesson.validation, lesson.scales, lesson.device, most=WATCHED)
    )
    course.rows.append(
        {
            "minutes": round(course.seconds / 60.0, 3),
            "views": course.views,
            "epochs": round(course.views / len(lesson.learned), 3),
            "rate": _rate(lesson.rate, _done(lesson, course)),
            "loss": float(np.mean(losses)),
            "validation_mae_mm": found["depth_mae_mm"],
            "zero_mae_mm": found["zero_mae_mm"],
            "contact_iou": found["contact_iou"],
            "force_error": found["force_error"],
        }
    )
    losses.clear()
