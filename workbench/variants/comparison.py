"""A against B: parameters that differ, figures that differ, and which of the two they speak for.

Parameters are compared as a design file holds them, the shape with its defaults filled in. Figures
compare only where both designs were pressed alike: `press_notice` says when they were not.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workbench.core.base.digest import digest
from workbench.core.base.errors import DesignError
from workbench.core.base.mapping import to_table
from workbench.core.base.units import split_unit
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import Press
from workbench.edit.forms import resolve_shape, sliders
from workbench.project.aim import default_target_mm
from workbench.project.design_toml import design_table
from workbench.project.state import State
from workbench.variants.score_card import Figures, equal
from workbench.view.frame_words import MISSING
from workbench.view.metric_rules import RULES, Better, Rule, rule

LEFT_OUT = ("name", "schema")
"""Fields of a design that change nothing."""
GROUPS = {
    "shape": "Shape",
    "layers": "Layers",
    "material": "Material",
    "optics": "Optics",
    "meshing": "Mesh",
    "mould": "Mould",
    "housing": "Housing",
    "casting": "Casting",
    "body": "Body from a file",
    "press": "Press",
    "object": "Object",
    "solver": "Contact solver",
    "fem": "Finite elements",
    "learned": "Force network",
}
"""Tables of a design and its press in the order of the comparison."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Difference:
    """A parameter in which two designs differ."""

    group: str
    """One of the values of `GROUPS`."""
    label: str
    unit: str
    a: str
    b: str


@dataclass(frozen=True, kw_only=True, slots=True)
class Change:
    """A figure of two designs."""

    rule: Rule
    a: float | None
    b: float | None

    @property
    def percent(self) -> float | None:
        """How much larger B is than A [%]; None without both, or against nothing."""
        if self.a is None or self.b is None or self.a == 0.0:
            return None
        return 100.0 * (self.b - self.a) / abs(self.a)

    @property
    def verdict(self) -> str:
        """`better` or `worse` for B, `same`, or "" where the rule or a value says nothing."""
        if self.a is None or self.b is None:
            return ""
        if equal(self.a, self.b):
            return "same"
        if self.rule.better is Better.NEUTRAL:
            return ""
        return "better" if (self.b > self.a) == (self.rule.better is Better.HIGHER) else "worse"


def parameter_differences(a: State, b: State) -> list[Difference]:
    """What differs between two designs and their presses, by group."""
    left, right = parameters(a), parameters(b)
    labels = {**_slider_labels(b), **_slider_labels(a)}
    found = []
    for path in {**left, **right}:
        one, other = left.get(path, MISSING), right.get(path, MISSING)
        if one != other:
            group, _, rest = path.partition(".")
            label, unit = labels.get(path) or _label(rest or group)
            title = GROUPS.get(group, "Design")
            found.append(Difference(group=title, label=label, unit=unit, a=one, b=other))
    order = ["Design", *GROUPS.values()]
    return sorted(found, key=lambda row: order.index(row.group))


def parameters(state: State) -> dict[str, str]:
    """All parameters of a design and its press by dotted name, as text for people."""
    design, case = state.design, state.case
    table = {k: v for k, v in design_table(design).items() if k not in LEFT_OUT}
    shape = resolve_shape(design.family, design.shape)
    table["shape"] = {f.name: getattr(shape, f.name) for f in dataclasses.fields(shape)}
    pressed = {
        "press": _press_table(case.press),
        "object": _object_table(case.indenter),
        "solver": to_table(case.settings),
        "fem": to_table(case.fem),
        "learned": {n: Path(p).name or "shipped" for n, p in to_table(case.learned).items()},
    }
    return dict(_flat({**table, **pressed}))


def _press_table(press: Press) -> dict[str, Any]:
    """A press; of a trajectory, which may have thousands of rows, how long it is and its digest."""
    table = to_table(dataclasses.replace(press, trajectory=None, object_pose=None))
    if press.trajectory is not None:
        rows = len(press.trajectory.poses)
        table["trajectory"] = f"{rows} rows ({digest(press.trajectory)[:6]})"
        table["object_pose"] = to_table(press.object_pose) or MISSING
    return table


def _object_table(indenter: Indenter) -> dict[str, Any]:
    """An object; of triangles and pictures, which are too long to read, the digest."""
    table: dict[str, Any] = {}
    for item in dataclasses.fields(indenter):
        value = getattr(indenter, item.name)
        if item.name == "mesh" and value is not None:
            table["mesh"] = f"{len(value.faces)} triangles ({digest(value)[:6]})"
        elif item.name == "texture":
            table |= _flat_texture(value)
        elif value is not None:
            table[item.name] = to_table(value)
    return table


def _flat_texture(texture: Any) -> dict[str, Any]:
    plain = {f.name: getattr(texture, f.name) for f in dataclasses.fields(texture)}
    image = plain.pop("image")
    if image is not None:
        plain["image"] = f"picture ({digest(image)[:6]})"
    return {"texture": to_table(plain)}


def _flat(table: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, str]]:
    """Leaves of nested tables and lists of tables by dotted name."""
    for name, value in table.items():
        path = f"{prefix}{name}"
        if isinstance(value, Mapping):
            yield from _flat(value, f"{path}.")
        elif isinstance(value, (list, tuple)) and any(isinstance(v, Mapping) for v in value):
            for number, item in enumerate(value, start=1):
                yield from _flat({f"{path}[{number}]": item})
        else:
            yield path, text_of(value)


def text_of(value: Any) -> str:
    """A value of a design file as people read it."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, (list, tuple)):
        return ", ".join(text_of(item) for item in value) or "none"
    return str(value)


def _slider_labels(state: State) -> dict[str, tuple[str, str]]:
    """Labels and units of the family's own parameters."""
    try:
        found = sliders(state.design.family)
    except DesignError:
        return {}
    return {f"shape.{slider.name}": (slider.label, slider.unit) for slider in found}


def _label(path: str) -> tuple[str, str]:
    """Words and unit of a dotted name, for example `ring.radius_mm`."""
    owner, _, name = path.rpartition(".")
    label, unit = split_unit(name)
    return f"{owner.replace('.', ' ').replace('_', ' ')} {label}".strip(), unit


def changes(a: Figures, b: Figures) -> list[Change]:
    """All figures that either design has, in the order of the score card."""
    names = [name for name in RULES if name in a or name in b]
    names += sorted({*a, *b} - set(RULES))
    return [Change(rule=rule(name), a=a.get(name), b=b.get(name)) for name in names]


def tally(found: list[Change]) -> tuple[int, int]:
    """How many figures speak for B, and how many against it."""
    verdicts = [change.verdict for change in found]
    return verdicts.count("better"), verdicts.count("worse")


def summary(found: list[Change], notice: str) -> str:
    """What a comparison comes to in words: what stands in the way of it first.

    Args:
        found: All figures.
        notice: Why figures do not compare (`press_notice`), "" where they do.
    """
    better, worse = tally(found)
    counts = f"B is better in {better} figures, worse in {worse}."
    missing = [
        f"{letter} lacks {lacking} figures that {other} has."
        for letter, other, lacking in (
            ("A", "B", sum(c.a is None and c.b is not None for c in found)),
            ("B", "A", sum(c.b is None and c.a is not None for c in found)),
        )
        if lacking
    ]
    if not notice and not missing:
        return counts
    return " ".join(("Compare with care.", notice, *missing, "Of what both have:", counts)).replace(
        "  ", " "
    )


def press_notice(a: State, b: State) -> str:
    """Why figures do not compare, "" where both were pressed alike."""
    rows = parameter_differences(
        State(design=a.design, case=a.case), State(design=a.design, case=b.case)
    )
    aimed = all(s.case.press.target_mm == default_target_mm(s.design) for s in (a, b))
    # Where the family itself aims, another place belongs to another shape.
    where = [row for row in rows if row.label != "target" or not aimed]
    if not where:
        return ""
    words = "; ".join(f"{row.group.lower()} {row.label} {row.a} and {row.b}" for row in where[:3])
    more = f" and {len(where) - 3} more" if len(where) > 3 else ""
    return f"They were not pressed alike ({words}{more}): figures of the touch compare only so far."


def number_text(value: float | None) -> str:
    """A figure for people; a dash where there is none."""
    if value is None or not math.isfinite(value):
        return MISSING
    return f"{value:.4g}"
