"""Several designs: one number in steps, and two of them side by side."""

from __future__ import annotations

from collections.abc import Sequence

from workbench.door.results import Results
from workbench.variants.comparison import Change, changes
from workbench.variants.sweep_computing import compute
from workbench.variants.sweeps import Span, Sweep, make_sweep


def sweep(base: Results, field: str, start: float, stop: float, steps: int = 5) -> Sweep:
    """Figures of a design at several values of one of its numbers.

    Results are stored: one that was stopped and is asked for again goes on where it was.

    Args:
        base: The design with its press, from `evaluate`.
        field: Dotted name, for example `layers.elastomer_mm` or `press.depth_mm`.
        start: First value, in the field's own unit.
        stop: Last value.
        steps: Values at equal distances, both ends included.

    Returns:
        The sweep; its `points` have `value`, `figures`, and `message` where a design was refused.

    Raises:
        DesignError: If the field cannot be swept, or every value is refused.
    """
    span = Span(start=start, stop=stop, steps=steps)
    what = make_sweep("sweep", base.state, field, span)
    return compute(what, base.project)


def compare(a: Results, b: Results, stages: Sequence[str] = ("shoot", "maps")) -> list[Change]:
    """Figures of two designs: `rule.name`, `a`, `b`, `percent`, and the `verdict` for B.

    Args:
        a: One design with its press.
        b: The other.
        stages: Computed for both; figures come from these and from what is stored.
    """
    for results in (a, b):
        results.compute(*stages)
    return changes(a.figures, b.figures)
