"""Three seeds of a network on the examples of a task: on renders held out, and on photographs."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from workbench.core.base.monitor import Monitor, part
from workbench.tasks.examples import Examples
from workbench.tasks.outcome import Run, Tested, Trial, tested
from workbench.tasks.scores import trivial
from workbench.tasks.splits import Parts, at_random, by_place
from workbench.tasks.task import Task
from workbench.tasks.trained import Trained, Trainer

SEEDS = (0, 1, 2)


@dataclass(frozen=True, kw_only=True, slots=True)
class Lessons:
    """Examples to learn from, and who learns."""

    name: str
    """Of the task."""
    task: Task
    trainer: Trainer
    found: Examples

    def parts(self, test: Trial) -> list[Parts]:
        """The split of each seed: by place, or at random.

        Raises:
            DesignError: If there are too few places.
        """
        if test is Trial.PLACE:
            return [by_place(self.found.places, seed) for seed in SEEDS]
        return [at_random(len(self.found), seed) for seed in SEEDS]

    def learned(self, test: Trial, monitor: Monitor) -> list[Run]:
        """The networks of all seeds, each on what its split holds out.

        Raises:
            Cancelled: If the monitor says so; finished trainings are kept.
        """
        runs = []
        for number, (seed, parts) in enumerate(zip(SEEDS, self.parts(test), strict=True)):
            span = part(monitor, number / len(SEEDS), (number + 1) / len(SEEDS))
            begun = time.monotonic()
            trained = self.trainer.trained(test.value, self.found, parts, seed, span)
            test_part = self.found.only(parts.test)
            runs.append(self._run(seed, trained, parts, test_part, begun))
        return runs

    def told_of(self, network: Trained) -> dict[str, Any]:
        """What a result tells of one of the networks, and of what all of them learn from."""
        trainer, found = self.trainer, self.found
        scale = {} if trainer.safety is None else dataclasses.asdict(trainer.safety)
        return {
            "network": trainer.net.value,
            "weights_from": network.weights_from,
            "parameters": sum(each.numel() for each in network.network.parameters()),
            "learning": trainer.learning,
            "device": trainer.device,
            "seeds": list(SEEDS),
            "examples": len(found),
            "places": len(np.unique(found.places)),
            "input_px": list(found.inputs.shape[2:4][::-1]),
            "look": self.task.look.value,
            "formula": self.task.formula,
            **scale,
        }

    def on_renders(self, test: Trial, runs: Sequence[Run]) -> Tested:
        """What the networks of `learned` say of what was held out."""
        return tested(self.name, self.task, test, runs)

    def on_photos(self, test: Trial, seen: Examples, networks: Sequence[Trained]) -> Tested:
        """What networks that learned from a random split of renders say of photographs."""
        runs = [
            self._run(seed, trained, parts, seen, time.monotonic())
            for seed, trained, parts in zip(SEEDS, networks, self.parts(Trial.SIM), strict=True)
        ]
        return tested(self.name, self.task, test, runs)

    def _run(self, seed: int, trained: Trained, parts: Parts, test: Examples, begun: float) -> Run:
        learned = self.found.only(parts.train)
        return Run(
            seed=seed,
            trained=trained,
            learned_from=len(learned),
            test=test,
            told=trained.told(test),
            null=trivial(self.task, learned, test),
            seconds=time.monotonic() - begun,
        )
