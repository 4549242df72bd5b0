"""A light model: how light travels from an LED to a point of the skin, and how that is shaded.

A model is one file of `sim.optics.field.models`, whose name stands in design files and whose
`MODEL` says the rest. No model knows the camera or the press, so that changing those never bakes
again. Left out of all but the traced ones: refraction of the light's own path, and light scattered
by the skin.
"""

from __future__ import annotations

import enum
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from sim.optics.light.lights import Leds
from workbench.core.base.monitor import Monitor
from workbench.core.base.records import records
from workbench.core.design.lighting import LightModel
from workbench.core.design.optics import Transport
from workbench.core.result.light import Scattered
from workbench.core.result.results import MembraneMesh


class Shading(enum.IntEnum):
    """What an image makes of the light at a vertex; the numbers are those of the kernels."""

    FIELD = 0
    """The paper's: directions of even strength, Phong's reflection."""
    DIRECT = 1
    """Irradiance that falls off, cast shadows, a GGX coating."""
    HYBRID = 2
    """Unscattered light as one virtual LED each, as `DIRECT`, and a table of the rest."""
    TABLE = 3
    """All light from a table over the tilt of the skin's normal."""
    GIVEN = 4
    """Radiance comes from outside, with every frame."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Baked:
    """What arrives at the V vertices of the skin from each of L lights."""

    direction: np.ndarray
    """Unit vectors toward the light, shape (L, V, 3), float32."""
    irradiance: np.ndarray
    """Shape (L, V), float32."""
    scattered: Scattered | None = None
    """Of traced light."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Lights:
    """What a model bakes from."""

    mesh: MembraneMesh
    leds: Leds
    fields: Sequence[str]
    """Field of the design that places each light, for messages."""
    transport: Transport | None
    """What traced photons meet."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Model:
    """One way of light."""

    place: int
    """Where it stands in lists."""
    hint: str
    """What it is, in a line below the choice."""
    shading: Shading
    bake: Callable[[Lights, Monitor], Baked]
    """Light of each LED at each vertex of the undeformed skin."""
    title: str = ""
    """What designers read in the list; "" of one that goes by its name."""
    quick: bool = False
    """Whether it bakes while a hand moves a slider."""
    straight: bool = False
    """Of a `FIELD`: along straight lines, as the paper renders every background."""

    @property
    def paper(self) -> bool:
        """One of the paper's fields."""
        return self.shading is Shading.FIELD

    @property
    def tabulated(self) -> bool:
        """Looks radiance up in a table over the tilt of the normal."""
        return self.shading in (Shading.TABLE, Shading.HYBRID)

    @property
    def per_frame(self) -> bool:
        """Traces photons anew for every frame: there is no baked light."""
        return self.shading is Shading.GIVEN

    @property
    def traced(self) -> bool:
        """Traces photons, and so knows the coating and the refractive index."""
        return self.tabulated or self.per_frame


def models() -> dict[LightModel, Model]:
    """All models in the order of lists."""
    found = records("sim.optics.field.models", "MODEL")
    return {
        LightModel(name): found[name] for name in sorted(found, key=lambda name: found[name].place)
    }


def model_of(name: LightModel | str) -> Model:
    """What a model says of itself."""
    return records("sim.optics.field.models", "MODEL")[str(name)]


def quick_model() -> LightModel:
    """The best model that bakes while a hand moves: it stands in for those that do not."""
    return [name for name, model in models().items() if model.quick][-1]


def baked_model() -> LightModel:
    """The best model that need not trace every frame."""
    return [name for name, model in models().items() if not model.per_frame][-1]


def background_model() -> LightModel:
    """The paper's field of straight lines, in which it renders what is not touched."""
    return next(name for name, model in models().items() if model.paper and model.straight)
