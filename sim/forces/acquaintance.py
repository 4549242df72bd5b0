"""Whether the weights of a network know a press: compared with what their data card says.

A network is to be trusted for what it was trained on: one membrane, one material, objects and
presses of the kinds it has seen. What differs is said in plain words; nothing is refused.

Young's modulus is the exception. Equilibrium, contact and friction of a rigid object hold for the
same displacements whatever E is, with all forces and stresses in proportion to it, so forces are
scaled by E over the E of the training, exactly, and a note says so. That fails where E is not the
only modulus: with gel behind the skin, and with parts of another elastomer.

Card keys that are missing cannot be compared, which is said as well.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from sim.forces.network.spec import Target
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter
from workbench.core.press.motion import StrokeKind
from workbench.core.press.press import ContactSettings, Method, Press
from workbench.core.press.press_case import PressCase

SAME = 1e-3
"""Relative difference below which numbers of a card are the same."""
SAME_MM = 0.02
"""Corners of two bounding boxes closer than this are the same [mm]."""
AS_MANY = 0.02
"""Share by which the number of points may differ: meshers of two versions are not quite alike."""
FARTHER = 1.05
"""Displacements up to this many times the largest of the training are no farther."""
NEEDED = ("membranes", "young_MPa", "poisson", "friction", "law", "indenters", "size_mm",
          "depth_mm", "shear_mm", "grid_mm")  # fmt: skip
"""Keys without which a card leaves something open."""
BETWEEN = "; "
"""Between the reasons of a notice."""
KNOWN_STROKES = (StrokeKind.PRESS, StrokeKind.SLIDE, StrokeKind.HOLD)
"""What data sets are made of: presses, slides, and rest."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Membrane:
    """What tells a membrane from those of the training."""

    differences: tuple[str, ...] | None
    """How its design differs from the one most alike, in words; None where the card has none."""
    points_mm: np.ndarray | None = None
    """Vertices of its outer skin at the spacing of the training [mm], (V, 3), once it is meshed."""
    gel: bool = False
    """Whether its skin rests on gel instead of being bonded."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Acquaintance:
    """How well weights know a press."""

    reasons: tuple[str, ...] = ()
    """What they do not know, in words; empty when they know it."""
    covered: tuple[str, ...] = ()
    """Those of them whose error is measured on held-out presses: objects of an unseen kind."""
    factor: float = 1.0
    """What the network's forces and stresses are to be multiplied by."""
    young_ratio: float = 1.0
    """What the contact solver's forces are to be divided by before they enter: E over that of the
    training."""
    note: str = ""
    """Why forces are scaled, in words; empty for a factor of 1."""


def acquaintance(
    card: Mapping[str, Any],
    target: Target,
    membrane: Membrane,
    material: Elastomer,
    case: PressCase,
    *,
    largest_mm: float = 0.0,
) -> Acquaintance:
    """Compare a press with the data card of weights.

    Args:
        card: Of the weights.
        target: What they predict; displacements do not change with E.
        membrane: Of the design.
        material: Its elastomer.
        case: The object, its path, and the contact solver whose displacement the network is given.
        largest_mm: Largest displacement of the press [mm], once that is known.
    """
    ratio, note, open_reasons = _stiffness(card, target, membrane, material)
    covered = tuple(_of_kind(card, case.indenter))
    reasons = (
        *_missing(card),
        *_of_membrane(card, membrane),
        *open_reasons,
        *_of_material(card, material),
        *covered,
        *_of_object(card, case.indenter),
        *_of_path(card, case.press),
        *_of_solver(card, case.settings, largest_mm),
    )
    factor = 1.0 if target is Target.DISPLACEMENT else ratio
    return Acquaintance(
        reasons=reasons, covered=covered, factor=factor, young_ratio=ratio, note=note
    )


def _missing(card: Mapping[str, Any]) -> Iterator[str]:
    given = {**card, "membranes": membranes_of(card) or None}
    missing = [name for name in NEEDED if given.get(name) is None]
    if missing:
        yield f"the data card of the weights does not say: {', '.join(missing)}"


def _of_membrane(card: Mapping[str, Any], membrane: Membrane) -> Iterator[str]:
    yield from membrane.differences or ()
    if membrane.differences or membrane.points_mm is None:
        return
    here_mm = np.array([membrane.points_mm.min(axis=0), membrane.points_mm.max(axis=0)])
    known = [one for one in membranes_of(card) if "bounds_mm" in one]
    if not known:
        return
    away_mm = [np.abs(np.array(one["bounds_mm"], dtype=float) - here_mm).max() for one in known]
    nearest = known[int(np.argmin(away_mm))]
    there_mm = np.array(nearest["bounds_mm"], dtype=float)
    count, vertices = len(membrane.points_mm), nearest.get("vertices")
    if min(away_mm) > SAME_MM:
        sizes = (" x ".join(f"{side:.1f}" for side in high - low)
                 for low, high in (here_mm, there_mm))  # fmt: skip
        yield "the membrane is another: {} mm, trained on one of {} mm".format(*sizes)
    elif vertices and abs(count / vertices - 1.0) > AS_MANY:
        yield f"the skin has {count} points, trained on {vertices}"


def membranes_of(card: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """What a card says of each membrane of the training; weights of before knew one."""
    known = card.get("membranes")
    if known is not None:
        return list(known)
    one, data = card.get("membrane"), card.get("dataset")
    design = data.get("design", {}) if isinstance(data, Mapping) else {}
    return [{**one, "design": design}] if isinstance(one, Mapping) else []


def _stiffness(
    card: Mapping[str, Any], target: Target, membrane: Membrane, material: Elastomer
) -> tuple[float, str, tuple[str, ...]]:
    """E over that of the training, the note on it, and what stands against it."""
    young_MPa = _number(card, "young_MPa")
    if not young_MPa or _same(material.young_MPa, young_MPa):
        return 1.0, "", ()
    ratio = material.young_MPa / young_MPa
    words = f"E is {material.young_MPa:.4g} MPa, trained at {young_MPa:.4g} MPa"
    if membrane.gel and material.backing_MPa > 0.0:
        return ratio, "", (f"{words}, and the gel behind the skin does not change with it",)
    if target is Target.DISPLACEMENT:
        return ratio, "", ()
    note = f"{words}: forces are scaled by {ratio:.4g}, which is exact in statics"
    return ratio, note, ()


def _of_material(card: Mapping[str, Any], material: Elastomer) -> Iterator[str]:
    poisson, friction = (_number(card, name) for name in ("poisson", "friction"))
    law = card.get("law")
    if poisson is not None and not _same(material.poisson, poisson):
        yield f"Poisson's ratio is {material.poisson:g}, trained at {poisson:g}"
    if friction is not None and not _same(material.friction, friction):
        yield f"friction is {material.friction:g}, trained at {friction:g}"
    kinetic = _number(card, "kinetic_friction")
    if kinetic is None:
        # Networks of before there were two coefficients.
        kinetic = friction
    apart = not _same(material.sliding_friction, material.friction)
    if kinetic is not None and apart and not _same(material.sliding_friction, kinetic):
        yield f"kinetic friction is {material.sliding_friction:g}, trained at {kinetic:g}"
    if law is not None and material.law.value != law:
        yield f"the material's law is {material.law.value}, trained with {law}"
    if material.inclusions:
        yield "the membrane has parts of another elastomer, trained without"


def _of_kind(card: Mapping[str, Any], indenter: Indenter) -> Iterator[str]:
    kinds = card.get("indenters")
    if indenter.mesh is None and kinds is not None and indenter.kind.value not in kinds:
        name = indenter.kind.value.replace("_", " ")
        yield f"the object is of a kind that training never showed: {name}"


def _of_object(card: Mapping[str, Any], indenter: Indenter) -> Iterator[str]:
    if indenter.mesh is not None:
        yield "the object comes from a file, trained on none such"
    sizes_mm = np.atleast_1d(np.array(card.get("size_mm", ()), dtype=float))
    between = bool(card.get("sizes_between")) and (
        sizes_mm.min() - SAME <= indenter.size_mm <= sizes_mm.max() + SAME
    )
    known = "" if between else _unlike(card, "size_mm", indenter.size_mm)
    if known:
        yield f"the object is {indenter.size_mm:g} mm wide, trained on {known} mm"
    known = _unlike(card, "edge_radius_mm", indenter.edge_radius_mm)
    if known and indenter.record.edge_share is not None:
        yield f"edges are rounded by {indenter.edge_radius_mm:g} mm, trained on {known} mm"
    about_way_only = not any(indenter.turn_deg[:2])
    if indenter.turned and not (card.get("spun") and about_way_only):
        yield "the object is turned, trained on objects as they came"
    if indenter.texture.raised:
        yield "the object has a texture, trained on smooth ones"
    if indenter.soft is not None:
        yield "the object is soft, trained on rigid ones"


def _of_path(card: Mapping[str, Any], press: Press) -> Iterator[str]:
    if press.actuations:
        yield "regions of the membrane are driven, which training never showed"
    if press.trajectory is not None:
        yield "the object follows a trajectory, trained on straight presses and slides"
        return
    odd = {s.kind.value for s in press.strokes if s.kind not in KNOWN_STROKES}
    odd |= {StrokeKind.TWIST.value} if press.twist_deg else set()
    if odd:
        yield f"the path has strokes that training never showed: {', '.join(sorted(odd))}"
    depth_mm, aside_mm = _reach_mm(press)
    deepest_mm, widest_mm = _number(card, "depth_mm"), _number(card, "shear_mm")
    if deepest_mm is not None and depth_mm > deepest_mm * (1.0 + SAME):
        yield f"the press is {depth_mm:.3g} mm deep, trained to {deepest_mm:.3g} mm"
    if widest_mm is not None and aside_mm > widest_mm * (1.0 + SAME):
        yield f"the object goes {aside_mm:.3g} mm aside, trained to {widest_mm:.3g} mm"


def _reach_mm(press: Press) -> tuple[float, float]:
    """Largest depth, and largest way along U or V [mm], of a path without trajectory."""
    deep, aside = press.depth_mm, np.array(press.shear_mm)
    deepest, widest = deep, float(np.abs(aside).max())
    for stroke in press.strokes:
        u_mm, v_mm, out_mm = stroke.shift_mm
        deep, aside = deep - out_mm, aside + np.array([u_mm, v_mm])
        deepest, widest = max(deepest, deep), max(widest, float(np.abs(aside).max()))
    return deepest, widest


def _of_solver(
    card: Mapping[str, Any], settings: ContactSettings, largest_mm: float
) -> Iterator[str]:
    grid_mm, farthest_mm = _number(card, "grid_mm"), _number(card, "max_displacement_mm")
    if settings.method is not Method.LATTICE:
        yield f"the contact solver's method is {settings.method.value}, trained on lattice"
    if grid_mm is not None and not _same(settings.grid_mm, grid_mm):
        yield f"the contact solver's grid is {settings.grid_mm:g} mm, trained on {grid_mm:g} mm"
    if farthest_mm is not None and largest_mm > FARTHER * farthest_mm:
        yield f"the skin moves by {largest_mm:.2f} mm, in training by {farthest_mm:.2f} mm at most"


def _number(card: Mapping[str, Any], name: str) -> float | None:
    """A number of the card; None where it has none."""
    value = card.get(name)
    return float(value) if isinstance(value, (int, float)) else None


def _unlike(card: Mapping[str, Any], name: str, value: float) -> str:
    """The numbers of the card in words if it has some, and this is none of them; else ""."""
    known = np.atleast_1d(np.array(card.get(name, ()), dtype=float))
    alike = any(_same(value, number) for number in known)
    return "" if alike else ", ".join(f"{number:g}" for number in known)


def _same(one: float, other: float) -> bool:
    return math.isclose(one, other, rel_tol=SAME, abs_tol=1e-9)
