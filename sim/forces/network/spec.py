"""What a network is, in numbers: enough to build it again. Imports nothing heavy.

The published network is MinkUNet14: a stem, four halvings of the resolution with a residual block
each, four doublings with a skip connection and a block each, and a linear layer.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from workbench.core.base.errors import DesignError

DEPTH = 4
"""Halvings of the resolution: levels 0 to 4."""


class Norm(StrEnum):
    """Where batch normalisation stands."""

    ALL = "all"
    """In the stem, at every change of resolution and in the blocks: MinkowskiEngine's network."""
    BLOCKS = "blocks"
    """In the blocks alone: the published force network."""
    NONE = "none"


class Activation(StrEnum):
    """After the stem and after each change of resolution; blocks always use ReLU."""

    RELU = "relu"
    LEAKY = "leaky"
    """Slope 0.01 below zero."""


class Target(StrEnum):
    """What a network predicts at each point of the skin."""

    FORCE = "force"
    DISPLACEMENT = "displacement"
    STRESS = "stress"

    @property
    def unit(self) -> str:
        """Unit of a value: N, mm or MPa."""
        return {"force": "N", "displacement": "mm", "stress": "MPa"}[self]

    @property
    def channels(self) -> int:
        """Numbers per point: a vector, or the six of a symmetric tensor."""
        return 6 if self is Target.STRESS else 3


@dataclass(frozen=True, kw_only=True, slots=True)
class NetworkSpec:
    """Everything that fixes the shapes and the arithmetic of a network."""

    name: str
    """Of the size, for tables and file names."""
    planes: tuple[int, ...]
    """Channels of the four encoder blocks, then of the four decoder blocks."""
    stem_planes: int
    stem_edge: int = 5
    """Edge of the stem's kernel in voxels, odd."""
    input_channels: int = 3
    output_channels: int = 3
    norm: Norm = Norm.BLOCKS
    activation: Activation = Activation.LEAKY

    def __post_init__(self) -> None:
        counts = (*self.planes, self.stem_planes, self.input_channels, self.output_channels)
        if len(self.planes) != 2 * DEPTH or min(counts) < 1:
            raise DesignError(
                f"a network has {2 * DEPTH} planes of 1 channel or more, not {self.planes}",
                hint="give the four encoder blocks, then the four decoder blocks",
                at="planes",
            )
        if self.stem_edge not in (3, 5):
            raise DesignError(
                f"a stem of {self.stem_edge} voxels is not 3 or 5",
                hint="use 5, as published",
                at="stem_edge",
            )


PAPER = NetworkSpec(name="paper", planes=(32, 64, 128, 256, 256, 128, 96, 96), stem_planes=32)
"""MinkUNet14 as published: 11,577,475 parameters."""
SMALL = NetworkSpec(name="small", planes=(16, 32, 48, 64, 48, 32, 32, 32), stem_planes=16)
"""The everyday network. On a skin the two finest levels hold nine voxels of ten, so their width
sets the time: 32 channels in place of 96 there. The coarse levels, which see the whole dent and
hold most parameters, narrow by four: 0.87 million parameters suit the thousands of samples that a
workstation can solve."""
SPECS = {spec.name: spec for spec in (PAPER, SMALL)}
FIELDS = {Target.FORCE: "contact_force_N", Target.DISPLACEMENT: "displacement_mm"}
"""What of a solver's answer each target is."""
