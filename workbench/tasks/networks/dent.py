"""A network that tells objects by their dents: taught by drawn dents, then by pressed ones.

What it learns first, dents of the objects' own shapes (`dents`), costs no press; with it a hundred
presses are enough to learn what a real dent, and a reading of it, has besides. Each dent is moved
to the middle and shown twice, over its depth and in millimetres, with how the skin lay before: a
ball dents the wall of a finger in an ellipse, as an ellipsoid dents a plane. What is told is the
mean over eight ways to turn and mirror it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import torch
from torch import Tensor, nn

from workbench.core.base.digest import digest
from workbench.core.base.monitor import Monitor, part
from workbench.core.press.indenter import OF_TRIANGLES, IndenterKind
from workbench.tasks.networks import dents as drawn
from workbench.tasks.networks.dents import Dents, misread
from workbench.tasks.networks.kept_training import read_training, write_training
from workbench.tasks.networks.learn import SMOOTHING, Learned, Part, told_by
from workbench.tasks.networks.patch import DENT, DROP, GREY_PER_MM
from workbench.tasks.networks.shown import GREY, plain, turned

CHANNELS = ((16, 2), (32, 2), (32, 1), (64, 2), (64, 1), (96, 2))
"""Of each convolution, with its stride."""
HIDDEN, DROPOUT = 64, 0.1
SHALLOW_MM, USUAL_MM = 0.05, 0.8
"""Depth that counts as none where a dent is shown over its own, and that which counts as one."""
TAUGHT_STEPS, TAUGHT_BATCH, TAUGHT_RATE = 2000, 64, 3e-3
"""Of the drawn dents alone."""
PRESSED, DRAWN, RATE, DECAY = 48, 24, 1.5e-3, 1e-3
"""Pressed and drawn dents of a batch, largest step and weight decay of the second part."""
EPOCHS, FEWEST_STEPS = 20, 300
"""How often each pressed dent is seen, and steps at least."""
ZOOM, SHIFT, GAIN = 0.15, 0.1, 0.2
"""By which pressed dents are enlarged, moved and made deeper at most."""
TOLD_EVERY = 50
"""Steps after which the validation part is told."""
SETTINGS = {
    "taught_steps": TAUGHT_STEPS,
    "taught_batch": TAUGHT_BATCH,
    "taught_rate": TAUGHT_RATE,
    "pressed": PRESSED,
    "drawn": DRAWN,
    "rate": RATE,
    "decay": DECAY,
    "epochs": EPOCHS,
    "fewest_steps": FEWEST_STEPS,
}
"""How it learns, as results tell it."""


class DentNet(nn.Module):
    """Dents (B, 1, 3, h, w), as `DentSight` shows them, to K numbers."""

    def __init__(self, outputs: int) -> None:
        super().__init__()
        layers: list[nn.Module] = []
        before = 3
        for after, stride in CHANNELS:
            layers.append(nn.Conv2d(before, after, 3, stride=stride, padding=1, bias=False))
            layers += [nn.BatchNorm2d(after), nn.ReLU()]
            before = after
        self.eye = nn.Sequential(*layers)
        self.head = nn.Sequential(
            nn.Dropout(DROPOUT),
            nn.Linear(3 * before, HIDDEN),
            nn.ReLU(),
            nn.Linear(HIDDEN, outputs),
        )

    def forward(self, images: Tensor, at: Tensor) -> Tensor:
        """Numbers, shape (B, K): mean of the logarithms of shares, over eight ways round."""
        dents_mm = in_mm(images)
        ways = [torch.rot90(dents_mm, turn, (2, 3)) for turn in range(4)]
        ways += [way.flip(3) for way in ways]
        return torch.stack([self.told(way).log_softmax(dim=1) for way in ways]).mean(dim=0)

    def told(self, dents_mm: Tensor) -> Tensor:
        """Numbers of dents and skin at rest (B, 2, h, w) as they lie, shape (B, K)."""
        middle = in_the_middle(dents_mm)
        dent = middle[:, :1]
        depth = dent.amax(dim=(2, 3), keepdim=True).clamp(min=SHALLOW_MM)
        found = self.eye(torch.cat([dent / depth, middle / USUAL_MM], dim=1))
        flat = found.flatten(2)
        return self.head(torch.cat([flat.amax(2), flat.mean(2), flat.std(2)], dim=1))


def in_mm(images: Tensor) -> Tensor:
    """Dents and skin at rest (B, 2, h, w) [mm] of what `plain` gives of them, (B, 1, 3, h, w)."""
    return images[:, 0, [DENT, DROP]] * (GREY / GREY_PER_MM)


def in_the_middle(dents_mm: Tensor) -> Tensor:
    """Dents and skin at rest (B, 2, h, w), moved so that the middle of what is pressed in is that
    of the image."""
    weight = dents_mm[:, :1].clamp(min=0.0)
    weight = weight / (weight.sum(dim=(2, 3), keepdim=True) + 1e-6)
    count, _, height, width = dents_mm.shape
    affine = torch.zeros((count, 2, 3), device=dents_mm.device)
    affine[:, 0, 0] = affine[:, 1, 1] = 1.0
    for row, (size, kept) in enumerate(((width, 2), (height, 3))):
        places = (torch.arange(size, device=dents_mm.device) + 0.5) / size * 2.0 - 1.0
        affine[:, row, 2] = (weight.sum(dim=(1, kept)) * places).sum(dim=1)
    grid = nn.functional.affine_grid(affine, list(dents_mm.shape), align_corners=False)
    return nn.functional.grid_sample(dents_mm, grid, align_corners=False)


@dataclass(frozen=True, kw_only=True, slots=True)
class Lesson:
    """What a training of dents needs besides its examples."""

    names: tuple[str, ...]
    """Of the classes; where all are objects, drawn dents teach as well."""
    seed: int
    kept: Path
    """File of what drawn dents taught, for the next training."""


def learn_dents(
    network: DentNet, parts: tuple[Part, Part], lesson: Lesson, monitor: Monitor
) -> Learned:
    """Train a network on drawn dents, once, and then on pressed and drawn ones.

    It learns for a fixed number of steps and ends with its last weights: the validation part only
    tells how far it came.

    Args:
        network: On the device where it learns.
        parts: What it learns from, and what tells how far it came.
        lesson: Classes and where the first part is kept.
        monitor: Progress and cancellation.

    Raises:
        Cancelled: If the monitor says so; what drawn dents taught is kept.
    """
    train, validation = parts
    device = next(network.parameters()).device
    source = None
    if drawable(lesson.names):
        source = Dents(lesson.names, lesson.seed, str(device))
        _teach(network, source, lesson, part(monitor, 0.0, 0.5))
    generator = torch.Generator(device=device).manual_seed(lesson.seed)
    steps = max(FEWEST_STEPS, EPOCHS * len(train.truth) // PRESSED)
    optimiser, rates = _optimiser(network, RATE, steps)
    known = in_mm(plain(train.inputs, torch.device("cpu")))
    truth = torch.as_tensor(train.truth)
    order = torch.Generator().manual_seed(lesson.seed)
    curve, loss = [], torch.zeros(())
    for step in range(steps):
        network.train()
        chosen = torch.randint(len(truth), (PRESSED,), generator=order)
        shown = pressed_anew(known[chosen].to(device), generator)
        told = truth[chosen].to(device)
        if source is not None:
            more, classes = source.draw(DRAWN)
            shown, told = torch.cat([shown, more]), torch.cat([told, classes])
        loss = _step(network, (shown, told), optimiser)
        rates.step()
        monitor(0.5 + 0.5 * step / steps, f"step {step + 1} of {steps}")
        if (step + 1) % TOLD_EVERY == 0 or step + 1 == steps:
            told_now = told_by(network, validation.inputs, validation.at)
            left = float((told_now.argmax(axis=1) != validation.truth).mean())
            curve.append({"train": float(loss), "validation": left})
    return Learned(epoch=len(curve), curve=curve)


def drawable(names: Sequence[str]) -> bool:
    """Whether all classes are objects whose shape is known."""
    kinds = {kind.value for kind in IndenterKind} - {OF_TRIANGLES.value}
    return set(names) <= kinds


def pressed_anew(dents_mm: Tensor, generator: torch.Generator) -> Tensor:
    """Dents with the skin at rest (B, 2, h, w) turned, mirrored, enlarged and moved.

    The dents are also deeper or less deep, and misread.
    """
    gain = torch.rand((len(dents_mm), 1, 1, 1), generator=generator, device=dents_mm.device)
    there = turned(dents_mm[:, None], generator, ZOOM, SHIFT)[:, 0]
    dents = misread(there[:, :1] * (1.0 + GAIN * (2.0 * gain - 1.0)), generator)
    return torch.cat([dents, there[:, 1:]], dim=1)


def _teach(network: DentNet, source: Dents, lesson: Lesson, monitor: Monitor) -> None:
    """Train on drawn dents alone, or take what they taught a training before."""
    settings = {name: value for name, value in vars(drawn).items() if name.isupper()}
    shape = [str(each.shape) for each in network.parameters()]
    own = [TAUGHT_STEPS, TAUGHT_BATCH, TAUGHT_RATE, DECAY, SMOOTHING]
    key = digest([settings, shape, own, list(lesson.names)])
    before = read_training(lesson.kept, key)
    if before is not None:
        network.load_state_dict(before["state"])
        return
    optimiser, rates = _optimiser(network, TAUGHT_RATE, TAUGHT_STEPS)
    network.train()
    for step in range(TAUGHT_STEPS):
        _step(network, source.draw(TAUGHT_BATCH), optimiser)
        rates.step()
        monitor(step / TAUGHT_STEPS, f"drawn dents, step {step + 1} of {TAUGHT_STEPS}")
    write_training(lesson.kept, key, {"state": network.state_dict()})


def _optimiser(
    network: DentNet, rate: float, steps: int
) -> tuple[torch.optim.Optimizer, torch.optim.lr_scheduler.LRScheduler]:
    found = torch.optim.AdamW(network.parameters(), lr=rate, weight_decay=DECAY)
    return found, torch.optim.lr_scheduler.OneCycleLR(found, rate, total_steps=steps)


def _step(
    network: DentNet, shown: tuple[Tensor, Tensor], optimiser: torch.optim.Optimizer
) -> Tensor:
    """One step on dents and their classes; the loss."""
    dents_mm, classes = shown
    told = network.told(dents_mm)
    loss = nn.functional.cross_entropy(told, classes, label_smoothing=SMOOTHING)
    optimiser.zero_grad()
    loss.backward()
    optimiser.step()
    return loss.detach()
