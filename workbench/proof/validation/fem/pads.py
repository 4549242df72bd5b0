"""Both solvers on a flat pad of nearly incompressible gel, beside figures that others published.

The figures are of ANSYS, for a gel of 25.25 x 20.75 x 4 mm, E .1 MPa, nu .49: .3609 N under a ball
of 3 mm that is .8 mm deep, and .457 to .502 N under one of 50 mm that is .2266 mm deep. Friction is
not stated: at .3 the limit of a disc about as large (`fem_limits`) under the large ball, .525 N,
lies above that range, so only mu 0 is compared with it.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator

from workbench.core.design.design import Elastomer
from workbench.core.press.fem import QUALITY_MM, FemSettings
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.proof.row import Row, compared
from workbench.proof.validation.contact.presses import GRID_MM, on_device
from workbench.proof.validation.fem.fem_limits import limit_N

PAD_MM = (25.25, 20.75, 4.0)
YOUNG_MPa, POISSON = 0.1, 0.49
FRICTIONS = (0.0, 0.3)
BALLS = {3.0: 0.8, 50.0: 0.2266}
"""Depth by radius [mm]."""
PUBLISHED_N = {3.0: (0.3609, 0.3609), 50.0: (0.457, 0.502)}
"""Range of the published force [N] by radius [mm]."""
LIMIT = 0.05


def rows() -> list[Row]:
    """Both solvers under both balls, with and without friction."""
    return [
        row for radius_mm in BALLS for friction in FRICTIONS for row in _rows(radius_mm, friction)
    ]


def _rows(radius_mm: float, friction: float) -> Iterator[Row]:
    pad = " x ".join(f"{side_mm:g}" for side_mm in PAD_MM)
    depth_mm = BALLS[radius_mm]
    words = (
        f"pad of {pad} mm, nu {POISSON:g}, ball of {radius_mm:g} mm, {depth_mm:g} mm deep, "
        f"friction {friction:g}"
    )
    solvers: dict[str, tuple[str, Callable[[], float]]] = {
        f"contact solver, grid {GRID_MM:g} mm": (
            "mpm_limit",
            on_device(functools.partial(_mpm_N, radius_mm, friction)),
        ),
        f"finite elements of {QUALITY_MM:g} mm": (
            "fem_limit",
            functools.partial(_fem_N, radius_mm, friction),
        ),
    }
    low_N, high_N = PUBLISHED_N[radius_mm]
    middle_N = 0.5 * (low_N + high_N)
    for solver, (name, force_N) in solvers.items():
        yield compared(
            name,
            f"{words}; limit of a disc of 11.5 mm; {solver}",
            force_N,
            limit_N(f"ball_{radius_mm:g}", friction, depth_mm, body="disc"),
            unit="N",
            limit=LIMIT,
        )
        if low_N == high_N or friction == 0.0:
            ranged = low_N < high_N
            yield compared(
                "published_pad",
                f"{words}; {f'range of ANSYS, {low_N:g} to {high_N:g} N' if ranged else 'ANSYS'}; "
                f"{solver}",
                force_N,
                middle_N,
                unit="N",
                limit=(high_N - low_N) / 2.0 / middle_N if ranged else LIMIT,
            )


def _case(radius_mm: float, friction: float) -> tuple[Elastomer, PressCase]:
    path = Press(target_mm=(0.0, 0.0, PAD_MM[2]), depth_mm=BALLS[radius_mm], frames=1)
    gel = Elastomer(young_MPa=YOUNG_MPa, poisson=POISSON, friction=friction)
    return gel, PressCase(
        indenter=Indenter(size_mm=2.0 * radius_mm),
        press=path,
        settings=ContactSettings(grid_mm=GRID_MM),
        fem=FemSettings(error=False, radius_mm=0.0),
    )


@functools.cache
def _mpm_N(radius_mm: float, friction: float) -> float:
    from sim.contact.press import press_membrane
    from sim.contact.studies.specimens import flat_block

    width_mm, length_mm, height_mm = PAD_MM
    mesh, points = flat_block(
        width_mm=width_mm, length_mm=length_mm, height_mm=height_mm, grid_mm=GRID_MM
    )
    gel, case = _case(radius_mm, friction)
    return float(press_membrane(mesh, points, gel, case).normal_N[-1])


@functools.cache
def _fem_N(radius_mm: float, friction: float) -> float:
    from sim.fem.press import solve_press
    from sim.fem.studies.blocks import flat_membrane

    width_mm, length_mm, height_mm = PAD_MM
    pad = flat_membrane(
        width_mm=width_mm,
        length_mm=length_mm,
        height_mm=height_mm,
        edge_mm=QUALITY_MM,
        layers=round(height_mm / QUALITY_MM),
    )
    gel, case = _case(radius_mm, friction)
    return float(solve_press(pad, gel, case).normal_N[-1])
