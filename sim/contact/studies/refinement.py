"""What a quantity tends to as the grid is refined: F(h) = F0 + c h^p through three grids."""

from __future__ import annotations

from dataclasses import dataclass

ORDERS = (0.5, 6.0)
"""Orders of convergence that are looked for; outside them three values do not converge."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Limit:
    """Where three values lead."""

    value: float
    order: float
    """The observed order p."""


def extrapolate(sizes_mm: tuple[float, ...], values: tuple[float, ...]) -> Limit:
    """The limit F0 and order p through three grids, coarse to fine (Richardson, 1911).

    p solves (F1 - F2) / (F2 - F3) = (h1^p - h2^p) / (h2^p - h3^p), by bisection. Differences that
    shrink too slowly or too fast give p at the border of `ORDERS`; ones that change sign do not
    follow a power at all, and the finest value is returned with order 0.
    """
    (h1, h2, h3), (f1, f2, f3) = sizes_mm, values
    if (f1 - f2) * (f2 - f3) <= 0.0:
        return Limit(value=f3, order=0.0)
    wanted = (f1 - f2) / (f2 - f3)
    low, high = ORDERS
    for _ in range(60):
        order = 0.5 * (low + high)
        ratio = (h1**order - h2**order) / (h2**order - h3**order)
        low, high = (order, high) if ratio < wanted else (low, order)
    return Limit(value=f3 - (f2 - f3) / ((h2 / h3) ** order - 1.0), order=order)
