"""What the designer chooses: the dataclasses of a sensor design.

Scalars carry their unit in the name. Sensor frame: origin at the centre of the base, +Z to the
tip. Camera frame (OpenCV): +Z forward, +X right, +Y down. Every class validates itself and raises
`DesignError` with `at`, the dotted name of the field.
"""

from __future__ import annotations

import dataclasses
import enum
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, cast

from workbench.core.base.check import within
from workbench.core.base.errors import DesignError, shown
from workbench.core.design.imported import IMPORTED, ImportedBody
from workbench.core.design.inclusion import Inclusion
from workbench.core.design.making import Casting, Housing, MouldOptions
from workbench.core.design.optics import Optics

SCHEMA = 1
"""Number of the design format; raised when a field changes its meaning."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Layers:
    """Thickness of each layer through the wall, from inside to outside."""

    support_mm: float = field(
        default=1.0,
        metadata={"min": 0.4, "max": 5.0, "step": 0.1, "hint": "Rigid transparent inner shell"},
    )
    """Rigid transparent shell that carries the elastomer [mm]."""
    elastomer_mm: float = field(
        default=2.0,
        metadata={"min": 0.8, "max": 6.0, "step": 0.1, "hint": "Soft wall: the sensing skin"},
    )
    """Elastomer wall [mm]. Source: GelTip, outer radius 15, inner 13 (SimTac, Supplementary)."""

    def __post_init__(self) -> None:
        at = "layers.support_mm"
        within(self.support_mm, 0.2, 20.0, what="support thickness", unit="mm", at=at)
        at = "layers.elastomer_mm"
        within(self.elastomer_mm, 0.2, 20.0, what="elastomer wall", unit="mm", at=at)


class Law(enum.StrEnum):
    """Stress from strain."""

    NEO_HOOKEAN = "neo_hookean"
    """Compressible neo-Hookean: large strains."""
    LINEAR = "linear"
    """Hooke's law of small strains and small turns, to compare with closed forms."""


STIFFEST_MPa = 1e3
USUAL_YOUNG_MPa = (0.005, 10.0)
"""Softer than any silicone gel that stands by itself, stiffer than any rubber used for a skin."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Elastomer:
    """A silicone: neo-Hookean with C10 = mu / 2, D1 = 2 / K, or linear elastic."""

    young_MPa: float = 0.145
    """Young's modulus [MPa]. Source: SimTac, 1.45e5 Pa (the paper prints kPa)."""
    poisson: float = 0.45
    """Poisson's ratio. Source: SimTac, Supplementary."""
    density_g_cm3: float = 1.0
    """Density [g/cm3]; statics do not use it, the casting recipe does."""
    friction: float = 0.3
    """Static Coulomb coefficient against the indenter. Source: SimTac, FEM model."""
    kinetic_friction: float | None = None
    """Coefficient where the skin slides, at most `friction`; left out: the same."""
    backing_MPa: float = 0.02
    """Young's modulus of the gel behind skins with a gap [MPa]; 0 is air. Bonded skins ignore it.

    Source: our choice, a very soft silicone gel (Shore 00-10 or below) as in TacTips.
    """
    law: Law = Law.NEO_HOOKEAN
    inclusions: tuple[Inclusion, ...] = ()
    """Parts of another elastomer."""
    source: str = field(default="SimTac, Supplementary", metadata={"cosmetic": True})

    @staticmethod
    def of_constants(*, c10_MPa: float, d1_per_MPa: float, **others: Any) -> Elastomer:
        """The elastomer of given neo-Hookean constants; `others` are further fields.

        E = 9 K mu / (3 K + mu), nu = (3 K - 2 mu) / (6 K + 2 mu) with mu = 2 C10, K = 2 / D1.

        Raises:
            DesignError: If a constant is not positive or Poisson's ratio leaves its range.
        """
        within(c10_MPa, 1e-5, 1e3, what="C10", unit="MPa", at="material.c10_MPa")
        within(d1_per_MPa, 1e-5, 1e5, what="D1", unit="1/MPa", at="material.d1_per_MPa")
        shear, bulk = 2.0 * c10_MPa, 2.0 / d1_per_MPa
        young_MPa = 9.0 * bulk * shear / (3.0 * bulk + shear)
        poisson = (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear)
        return Elastomer(young_MPa=young_MPa, poisson=poisson, **others)

    def __post_init__(self) -> None:
        hint = "silicones for tactile skins have 0.03 to 3 MPa"
        at = "material.young_MPa"
        if self.young_MPa > STIFFEST_MPa and math.isfinite(self.young_MPa):
            hint = f"this looks like Pa: type {self.young_MPa * 1e-6:.6g}; {hint}"
        most = STIFFEST_MPa
        within(self.young_MPa, 1e-4, most, what="Young's modulus", unit="MPa", at=at, hint=hint)
        hint = "use 0.45 to 0.49 for silicone; 0.5 cannot be simulated"
        at = "material.poisson"
        within(self.poisson, 0.0, 0.495, what="Poisson's ratio", unit="", at=at, hint=hint)
        at = "material.friction"
        within(self.friction, 0.0, 2.0, what="friction coefficient", unit="", at=at)
        if self.kinetic_friction is not None:
            hint = "what slides rubs no harder than what sticks: lower it, or raise friction"
            most, at = self.friction, "material.kinetic_friction"
            within(
                self.kinetic_friction, 0.0, most, what="kinetic friction", unit="", at=at, hint=hint
            )
        at = "material.density_g_cm3"
        within(self.density_g_cm3, 0.1, 10.0, what="density", unit="g/cm3", at=at)
        at = "material.backing_MPa"
        within(self.backing_MPa, 0.0, 1.0, what="modulus of the backing", unit="MPa", at=at)

    @property
    def sliding_friction(self) -> float:
        """Coefficient where the skin slides."""
        return self.friction if self.kinetic_friction is None else self.kinetic_friction

    @property
    def notice(self) -> str:
        """What is unlikely about this material but allowed, else ""."""
        low_MPa, high_MPa = USUAL_YOUNG_MPa
        if low_MPa <= self.young_MPa <= high_MPa:
            return ""
        kilo = ""
        if self.young_MPa > high_MPa:
            kilo = f"; if it was meant in kPa, type {self.young_MPa * 1e-3:.4g}"
        return (
            f"Young's modulus {self.young_MPa:g} MPa is unlikely for a silicone skin, which has "
            f"{low_MPa:g} to {high_MPa:g} MPa{kilo}"
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class Meshing:
    """How finely the body is divided."""

    hex_mm: float = 0.4
    """Edge of a hexahedron and of a skin triangle [mm]."""
    tet_mm: float = field(default=1.2, metadata={"cosmetic": True})
    """Edge of a tetrahedron [mm]; `tets` is given it by itself, so no other stage depends on it."""

    def __post_init__(self) -> None:
        hint = "0.4 mm suits walls of 1 mm and more"
        at = "meshing.hex_mm"
        within(self.hex_mm, 0.1, 5.0, what="mesh spacing", unit="mm", at=at, hint=hint)
        hint = "1.2 mm takes about a minute, and the time grows with its inverse square"
        at = "meshing.tet_mm"
        within(self.tet_mm, 0.5, 10.0, what="tetrahedron edge", unit="mm", at=at, hint=hint)


@dataclass(frozen=True, kw_only=True, slots=True)
class SensorDesign:
    """A whole sensor. `shape` holds the family's own parameters by name."""

    name: str = field(default="untitled", metadata={"cosmetic": True})
    family: str = "finger"
    shape: Mapping[str, Any] = field(default_factory=dict[str, Any])
    layers: Layers = field(default_factory=Layers)
    material: Elastomer = field(default_factory=Elastomer)
    optics: Optics = field(default_factory=Optics)
    meshing: Meshing = field(default_factory=Meshing)
    mould: MouldOptions = field(default_factory=MouldOptions)
    housing: Housing = field(default_factory=Housing)
    casting: Casting = field(default_factory=Casting)
    body: ImportedBody | None = None
    """File of the body, for the family `imported`."""
    schema: int = field(default=SCHEMA, metadata={"cosmetic": True})

    def replace(self, dotted: str, value: Any) -> SensorDesign:
        """A copy with one field changed, for example `optics.camera.fov_x_deg`.

        Raises:
            DesignError: If there is no such field or the value is refused.
        """
        return _replace(self, dotted.split("."), value, dotted)


def _replace(owner: Any, path: list[str], value: Any, dotted: str) -> Any:
    head, *rest = path
    if isinstance(owner, Mapping):
        return {**cast("Mapping[str, Any]", owner), head: value}
    if head not in {f.name for f in dataclasses.fields(owner)}:
        raise DesignError(
            f"there is no field {shown(dotted)}", hint="see docs/fields.md", at=dotted
        )
    if rest:
        inner = _replace(getattr(owner, head), rest, value, dotted)
    else:
        inner = _chosen(getattr(owner, head), value, dotted)
    return dataclasses.replace(owner, **{head: inner})


def _chosen(now: Any, value: Any, dotted: str) -> Any:
    """The choice of that name where a field holds one of several, else the value itself."""
    if not isinstance(now, enum.Enum) or not isinstance(value, str):
        return value
    names = [str(item.value) for item in type(now)]
    if value not in names:
        raise DesignError(
            f"{dotted} is {shown(value)}", hint=f"choose one of {', '.join(names)}", at=dotted
        )
    return type(now)(value)


def check_body(design: SensorDesign) -> None:
    """Refuse an imported design without a file.

    Raises:
        DesignError: Saying how to give one.
    """
    if design.family == IMPORTED and design.body is None:
        raise DesignError(
            "an imported design needs the file of its body",
            hint="load a STEP or STL file, or write [body] outer = 'file.step' in the design",
            at="body.outer",
        )
