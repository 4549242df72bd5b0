"""A ball, a flat end and a line on a layer bonded to a rigid base, beside their exact solutions.

The closed forms are for small strain, so every ball has a contact radius of about a tenth of its
own radius (a strain of some 3 %): chi = sqrt(R d) / h fixes the contact radius, the ball follows.
The layer is cut where nothing moves any more: what that costs is the force across the cut.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np

from sim.contact.press import press_membrane
from sim.contact.studies import closed_forms, specimens
from sim.contact.studies.closed_forms import LayerContact
from workbench.core.design.design import Elastomer, Law
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.sensing import Contact

HEIGHT_MM = 4.0
FLATNESS = 10.0
"""Radius of the ball over sqrt(R d): the contact is a tenth of the ball."""
CELLS_PER_RADIUS = 4.0
"""Grid cells in sqrt(R d), which is below the contact radius on a layer."""
SKIN_CELLS = 0.5
"""Edge of the skin's triangles in cells: as fine as contact points, so that each has a vertex."""

END_MM = 6.0
"""Diameter of the flat end [mm]."""
END_EDGE_MM = 0.5
END_DEPTH_MM = 0.12
END_GRID_MM = 0.375

LINE_MM = 24.0
"""Diameter and length of the cylinder that presses with its side [mm]."""
LINE_EDGE_MM = 0.5
LINE_HEIGHT_MM = 2.0
LINE_DEPTH_MM = 0.06
LINE_GRID_MM = 0.2
LINE_LENGTH_MM = 2.0
"""Length of the block under it: without Poisson's effect any length is in plane strain."""


@dataclass(frozen=True, kw_only=True, slots=True)
class LayerPress:
    """A press of a layer."""

    contact: Contact
    skin_mm: np.ndarray
    """Undeformed vertices of the free face [mm], shape (V, 3)."""

    @property
    def force_N(self) -> float:
        """Normal force of the solver."""
        return float(self.contact.normal_N[-1])

    @property
    def moment_radius_mm(self) -> float:
        """sqrt(5/2 <r^2>) of the contact forces where the vertices are now."""
        contact = self.contact
        force_N = contact.contact_force_N[-1].astype(np.float64) @ -contact.normal
        place_mm = self.skin_mm + contact.displacement_mm[-1] - contact.target_mm
        square_mm2 = np.einsum("vc,vc->v", place_mm, place_mm) - (place_mm @ contact.normal) ** 2
        return math.sqrt(2.5 * float(force_N @ square_mm2) / float(force_N.sum()))


@dataclass(frozen=True, kw_only=True, slots=True)
class Ball:
    """Which ball on which layer."""

    chi: float
    """sqrt(R d) / h."""
    poisson: float = 0.45
    cells: float = CELLS_PER_RADIUS
    flatness: float = FLATNESS
    law: Law = Law.NEO_HOOKEAN
    tolerance: float = 1e-3

    @property
    def radius_mm(self) -> float:
        """Radius of the ball."""
        return self.flatness * self.chi * HEIGHT_MM

    @property
    def depth_mm(self) -> float:
        """Depth d = (chi h)^2 / R."""
        return (self.chi * HEIGHT_MM) ** 2 / self.radius_mm

    @property
    def grid_mm(self) -> float:
        """Grid cell sqrt(R d) / cells."""
        return self.chi * HEIGHT_MM / self.cells

    @property
    def margin_mm(self) -> float:
        """Layer around the contact: 3 thicknesses under a wide contact, 1.6 under a narrow one.

        The cut costs 0.15 % at chi 0.6, against 5 thicknesses. At chi 0.2, where the force is 24 %
        above the half-space's, 1.5 thicknesses cost 0.9 % and 1.7 cost 0.3 %, against 2.2; at chi
        0.1, where it is 12 %, half of that.
        """
        return HEIGHT_MM * min(3.0, max(1.4 + 1.5 * self.chi, 6.0 * self.chi))

    @property
    def material(self) -> Elastomer:
        """Without friction, as in the closed form."""
        return Elastomer(poisson=self.poisson, friction=0.0, law=self.law)


@functools.cache
def press_ball(ball: Ball) -> LayerPress:
    """A ball on the layer."""
    radius_mm = math.sqrt(2.0) * ball.chi * HEIGHT_MM + ball.margin_mm
    mesh, points = specimens.flat_block(
        width_mm=2.0 * (radius_mm + 2.0 * ball.grid_mm),
        height_mm=HEIGHT_MM,
        grid_mm=ball.grid_mm,
        skin_mm=SKIN_CELLS * ball.grid_mm,
    )
    contact = press_membrane(
        mesh,
        points,
        ball.material,
        PressCase(
            indenter=Indenter(size_mm=2.0 * ball.radius_mm),
            press=Press(target_mm=(0.0, 0.0, HEIGHT_MM), depth_mm=ball.depth_mm, frames=1),
            settings=ContactSettings(
                grid_mm=ball.grid_mm, active_radius_mm=radius_mm, tolerance=ball.tolerance
            ),
        ),
    )
    return LayerPress(contact=contact, skin_mm=mesh.outer.points_mm)


@functools.cache
def exact_ball(ball: Ball) -> LayerContact:
    """The same in exact linear elasticity."""
    return closed_forms.press_ball(
        ball.material, radius_mm=ball.radius_mm, height_mm=HEIGHT_MM, depth_mm=ball.depth_mm
    )


@functools.cache
def press_flat_end(*, poisson: float = 0.45) -> LayerPress:
    """The flat end of a cylinder with a rounded edge on the layer."""
    material = Elastomer(poisson=poisson, friction=0.0)
    radius_mm = 0.5 * END_MM + 2.0 * HEIGHT_MM
    mesh, points = specimens.flat_block(
        width_mm=2.0 * radius_mm + 1.0, height_mm=HEIGHT_MM, grid_mm=END_GRID_MM
    )
    contact = press_membrane(
        mesh,
        points,
        material,
        PressCase(
            indenter=Indenter(
                kind=IndenterKind("cylinder_end"), size_mm=END_MM, edge_radius_mm=END_EDGE_MM
            ),
            press=Press(target_mm=(0.0, 0.0, HEIGHT_MM), depth_mm=END_DEPTH_MM, frames=1),
            settings=ContactSettings(grid_mm=END_GRID_MM, active_radius_mm=radius_mm),
        ),
    )
    return LayerPress(contact=contact, skin_mm=mesh.outer.points_mm)


@functools.cache
def exact_flat_end(*, poisson: float = 0.45) -> LayerContact:
    """The same in exact linear elasticity."""
    return closed_forms.press_flat_end(
        Elastomer(poisson=poisson),
        radius_mm=0.5 * END_MM,
        edge_mm=END_EDGE_MM,
        height_mm=HEIGHT_MM,
        depth_mm=END_DEPTH_MM,
    )


def half_space_end_N(*, poisson: float = 0.45) -> float:
    """The same end with a sharp edge on a half-space: F = 2 a E d / (1 - nu^2) [N]."""
    young_MPa = Elastomer().young_MPa
    return END_MM * young_MPa * END_DEPTH_MM / (1.0 - poisson**2)


LINE_MATERIAL = Elastomer(poisson=0.0, friction=0.0)


@functools.cache
def press_line() -> LayerPress:
    """The side of a cylinder on a strip narrower than the cylinder is long; force per mm."""
    width_mm = 8.0 * LINE_HEIGHT_MM
    mesh, points = specimens.flat_block(
        width_mm=width_mm,
        height_mm=LINE_HEIGHT_MM,
        length_mm=LINE_LENGTH_MM,
        grid_mm=LINE_GRID_MM,
    )
    contact = press_membrane(
        mesh,
        points,
        LINE_MATERIAL,
        PressCase(
            indenter=Indenter(
                kind=IndenterKind("cylinder_side"), size_mm=LINE_MM, edge_radius_mm=LINE_EDGE_MM
            ),
            press=Press(target_mm=(0.0, 0.0, LINE_HEIGHT_MM), depth_mm=LINE_DEPTH_MM, frames=1),
            settings=ContactSettings(grid_mm=LINE_GRID_MM, active_radius_mm=width_mm),
        ),
    )
    return LayerPress(contact=contact, skin_mm=mesh.outer.points_mm)


@functools.cache
def exact_line() -> LayerContact:
    """The same in exact linear elasticity, force per mm."""
    return closed_forms.press_line(
        LINE_MATERIAL,
        radius_mm=0.5 * LINE_MM,
        height_mm=LINE_HEIGHT_MM,
        depth_mm=LINE_DEPTH_MM,
    )


def half_space_line_N_mm() -> float:
    """The exact contact width on a half-space: F / l = pi E a^2 / (4 R (1 - nu^2)) [N/mm]."""
    exact = exact_line()
    modulus = LINE_MATERIAL.young_MPa / (1.0 - LINE_MATERIAL.poisson**2)
    return math.pi * modulus * exact.radius_mm**2 / (2.0 * LINE_MM)
