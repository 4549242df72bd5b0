"""How a network is trained, in numbers, and the presets. Imports nothing heavy.

What of the publication cannot be meant, and what the preset `paper` does instead:

- The rate is said to fall tenfold every ten epochs, to 1e-12 in the last; in the published code
  the decay never reaches the optimiser. It stays at 1e-3.
- Voxels of 0.11 mm on points 0.9 mm apart leave one of 27 neighbours at the two finest levels.
  They stay, as a ratio; `small` has larger ones for this reason.
- The network of the last epoch was kept. Here, as always, it is that of the best validation.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from sim.forces.network.spec import PAPER, SMALL, NetworkSpec
from workbench.core.base.check import within
from workbench.core.base.errors import DesignError

OUR_VOXEL = 0.75
"""`sim.forces.network.voxels.VOXEL_PER_SPACING`, which cannot be imported without PyTorch."""


class Numbers(StrEnum):
    """Type in which a step is computed; the weights themselves are always float32."""

    AUTO = "auto"
    """`HALF` on a CUDA device, `SINGLE` on a CPU."""
    SINGLE = "single"
    HALF = "half"
    """bfloat16 where the device multiplies it, else float16 with a scaled loss."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TrainingSettings:
    """Everything but the data and the seed that a training depends on."""

    name: str
    spec: NetworkSpec
    voxel_per_spacing: float = OUR_VOXEL
    """Edge of a voxel over the spacing of the points."""
    takes_force: bool = False
    """Whether the contact solver's force enters beside its displacement."""
    corrects: bool = False
    """Whether the network learns what is missing in the contact solver's own field, where it has
    one; else the field itself."""
    patch_spacings: float = 0.0
    """Reach of the patch that the network looks at beyond what touches, over the spacing of the
    points, see `sim.forces.network.patches`; 0: it looks at the whole skin."""
    rate: float = 1e-3
    """Largest learning rate."""
    batch: int = 16
    """Samples of a step."""
    epochs: int = 100
    passes: int = 1
    """How often an epoch goes through the samples: more where they are few."""
    warm_up: float = 0.0
    """Share of all steps in which the rate rises from zero."""
    cosine: bool = False
    """Let the rate fall along half a cosine, to a hundredth; else it stays."""
    weight_decay: float = 0.0
    """Of Adam, decoupled from the gradient."""
    clip: float = 0.0
    """Largest norm of the gradient, for a loss of 1 at zero output; 0: any."""
    averaging: float = 0.0
    """What an average of the weights keeps of itself at each step: the network that is kept is the
    average; 0: the last weights are."""
    foot: float = 0.0
    """Error, over the scale of the output, below which it counts by its square, at the largest
    rate; it shrinks as the rate does. 0: the plain mean absolute error, see `trainer`."""
    peak_heed: float = 0.0
    """How much more an error at the largest value of a sample counts in the loss, see `trainer`."""
    turns: int = 1
    """Orientations about the sensor's axis in which a whole skin is looked at, see `frames`; a
    patch is turned by any angle."""
    patience: int = 0
    """Epochs without a better validation before it stops; 0: never."""

    def __post_init__(self) -> None:
        within(self.voxel_per_spacing, 0.02, 4.0, what="voxel", unit="spacings", at="voxel")
        within(self.patch_spacings, 0.0, 1e3, what="patch", unit="spacings", at="patch_spacings")
        within(self.rate, 1e-7, 1.0, what="rate", unit="", at="rate")
        within(self.batch, 1, 4096, what="batch", unit="samples", at="batch")
        within(self.epochs, 1, 100_000, what="epochs", unit="", at="epochs")
        within(self.passes, 1, 10_000, what="passes", unit="", at="passes")
        within(self.warm_up, 0.0, 0.9, what="warm-up", unit="", at="warm_up")
        within(self.weight_decay, 0.0, 1.0, what="weight decay", unit="", at="weight_decay")
        within(self.clip, 0.0, 1e6, what="gradient limit", unit="", at="clip")
        within(self.averaging, 0.0, 0.99999, what="averaging", unit="", at="averaging")
        within(self.foot, 0.0, 100.0, what="foot", unit="scales", at="foot")
        within(self.peak_heed, 0.0, 100.0, what="heed of peaks", unit="", at="peak_heed")
        within(self.turns, 1, 64, what="turns", unit="", at="turns")
        if self.turns > 1 and self.patch_spacings:
            raise DesignError(
                f"{self.turns} turns are of whole skins; a patch is turned by any angle",
                hint="leave --turns out, or choose the preset paper",
                at="turns",
            )
        within(self.patience, 0, 100_000, what="patience", unit="epochs", at="patience")


def rate_factor(step: int, steps: int, settings: TrainingSettings) -> float:
    """Share of the rate at a step, counted from 0, of so many."""
    from math import cos, pi

    warming = settings.warm_up * steps
    factor = min(1.0, (step + 1) / warming) if warming else 1.0
    if settings.cosine and step > warming:
        share = (step - warming) / max(steps - warming, 1.0)
        factor *= LAST_RATE + (1.0 - LAST_RATE) * 0.5 * (1.0 + cos(pi * share))
    return factor


LAST_RATE = 0.01
"""Of the largest rate, at the end of a cosine."""

TINY = NetworkSpec(name="tiny", planes=(4, 6, 8, 8, 8, 6, 6, 4), stem_planes=4, stem_edge=3)
"""For tests: 10,000 parameters."""

PRESETS = {
    settings.name: settings
    for settings in (
        TrainingSettings(
            name="paper", spec=PAPER, voxel_per_spacing=0.11 / 0.9, rate=1e-3, batch=32, epochs=100
        ),
        TrainingSettings(
            name="small",
            spec=SMALL,
            takes_force=True,
            corrects=True,
            patch_spacings=4.5,
            rate=3e-3,
            batch=8,
            epochs=120,
            warm_up=0.03,
            cosine=True,
            weight_decay=1e-4,
            clip=1.0,
            averaging=0.99,
            foot=0.1,
            patience=40,
        ),
        TrainingSettings(
            name="tune",
            spec=SMALL,
            rate=1e-3,
            batch=8,
            epochs=60,
            warm_up=0.05,
            cosine=True,
            clip=1.0,
            averaging=0.99,
            foot=0.1,
            turns=8,
            patience=30,
        ),
        TrainingSettings(name="tiny", spec=TINY, rate=5e-3, batch=4, epochs=3, cosine=True),
    )
}
"""By name.

What `small` rests on, measured on 643 samples of 45 cases at quality, as errors of the force over
those of zero on validation, test and unseen objects (the contact solver alone: 0.28, 0.28, 0.32):

| | validation | test | unseen |
|---|---|---|---|
| whole skins, displacement alone, 8 orientations, 140 epochs | 0.192 | 0.214 | 0.246 |
| patches, force too, as a correction, 25 epochs | 0.158 | 0.157 | 0.169 |
| the same, orientations in all of space | 0.170 | 0.168 | 0.182 |
| the same, voxels as large as the spacing | 0.158 | 0.151 | 0.172 |
| patches, 120 epochs, one look | 0.122 | 0.133 | 0.165 |
| patches, 120 epochs, four looks | 0.107 | 0.120 | 0.147 |

An epoch on whole skins takes 4 s on an H100 or minutes on a CPU, on patches 7 s on one core.
"""
