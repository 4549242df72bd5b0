"""Balance of forces of a body against the object at one pose: residual, energy and tangent."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.contact.objects.collider import Collider
from sim.fem.body import Body
from sim.fem.contact_law import Lag, Law, Touch, Traction, traction
from sim.fem.elements import ElementState, evaluate
from sim.fem.obstacle import RigidPose, curvature, distance

LEAST_MM2 = 7e-4
"""A force of Young's modulus times this counts as no load: 1e-4 N at 0.145 MPa."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Load:
    """What an increment ends with: the object's pose, and the friction's memory carried there."""

    law: Law
    collider: Collider
    pose: RigidPose
    anchor_mm: np.ndarray
    """Where each contact point was, carried along by the object, shape (P, 3)."""
    elastic_mm: np.ndarray
    """Elastic slip kept before, turned with the object, shape (P, 3)."""
    slides: np.ndarray
    """Whether each slid in the last increment, shape (P,), bool."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Balance:
    """Forces of one displacement; of P contact points, T touch the object."""

    energy_Nmm: float
    """Potential of elements, gel and contact; of friction only with a lag."""
    residual_N: np.ndarray
    """Contact and gel minus internal forces at the free equations, shape (E,)."""
    relative: float
    """Largest residual over the largest nodal load."""
    contact_N: np.ndarray
    """Force of the object on the nodes, shape (N, 3)."""
    internal_N: np.ndarray
    """Internal forces of elements, shape (N, 3)."""
    gel_N: np.ndarray
    """Forces of the gel on the nodes, shape (N, 3)."""
    elements: ElementState
    places_mm: np.ndarray
    """Contact points as displaced, shape (P, 3)."""
    distance_mm: np.ndarray
    """Their distance from the object, shape (P,)."""
    members: np.ndarray
    """Numbers of the contact points that touch, shape (T,)."""
    traction: Traction
    """At those points."""
    touching_faces: np.ndarray
    """Faces that hold them, shape (F,)."""
    face_N_mm: np.ndarray | None
    """Stiffness of contact of those faces, shape (F, 12, 12)."""

    def lag(self) -> Lag:
        """Pressure and normal of all contact points, for friction that is held."""
        pressure, normal = np.zeros(len(self.distance_mm)), np.zeros((len(self.distance_mm), 3))
        pressure[self.members] = self.traction.lag.pressure_MPa
        normal[self.members] = self.traction.lag.normal
        return Lag(pressure_MPa=pressure, normal=normal)


@dataclass(frozen=True, kw_only=True, slots=True)
class Equations:
    """Balance of forces of a body against the object at one pose."""

    body: Body
    load: Load
    lag: Lag | None = None
    """Pressure and normal of friction that is held, for all contact points; None: each state's own
    friction."""

    def balance(
        self,
        displacement_mm: np.ndarray,
        *,
        tangent: bool = True,
        convex: bool = False,
        known: ElementState | None = None,
    ) -> Balance | None:
        """Forces at a displacement, shape (N, 3); None where an element is inverted.

        Args:
            displacement_mm: Displacement of all nodes; held ones are where they belong.
            tangent: Whether stiffnesses are wanted.
            convex: As in `contact_law.traction`.
            known: Forces of the elements, where they were found at this displacement before.
        """
        body, load, lag = self.body, self.load, self.lag
        elements = evaluate(
            body.elements, displacement_mm, tangent=tangent, leading=body.near, known=known
        )
        if not np.isfinite(elements.energy_Nmm):
            return None
        faces = body.faces
        places_mm = faces.places(body.points_mm + displacement_mm)
        distance_mm, gradient = distance(load.collider, load.pose, places_mm)
        touches = distance_mm < 0.0
        if lag is not None:
            touches |= lag.pressure_MPa > 0.0
        members = np.flatnonzero(touches)
        touch = Touch(
            distance_mm=distance_mm[members],
            gradient=gradient[members],
            curvature=curvature(load.collider, load.pose, places_mm[members]) if tangent else None,
            slip_mm=(load.elastic_mm + places_mm - load.anchor_mm)[members],
            slides=load.slides[members],
        )
        held = None if lag is None else lag.take(members)
        pull = traction(load.law, touch, lag=held, convex=convex)
        touching_faces, spots = _by_face(members, faces.areas_mm2.shape)
        meeting = faces.take(touching_faces)
        contact_N = body.system.gather(
            meeting.nodes, meeting.forces(_spread(pull.total_MPa, spots))
        )
        gel_N, gel_Nmm = body.spring_forces(displacement_mm)
        internal_N = body.system.gather(body.elements.cells, elements.force_N)
        residual_N = body.system.reduced(contact_N + gel_N - internal_N)
        load_N = max(
            np.abs(contact_N).max(initial=0.0),
            np.abs(internal_N[body.driven]).max(initial=0.0),
            LEAST_MM2 * body.young_MPa,
        )
        contact_Nmm = float(pull.energy_N_mm @ faces.areas_mm2.ravel()[members])
        bent = pull.stiffness_MPa_mm
        return Balance(
            energy_Nmm=elements.energy_Nmm + gel_Nmm + contact_Nmm,
            residual_N=residual_N,
            relative=float(np.abs(residual_N).max(initial=0.0) / load_N),
            contact_N=contact_N,
            internal_N=internal_N,
            gel_N=gel_N,
            elements=elements,
            places_mm=places_mm,
            distance_mm=distance_mm,
            members=members,
            traction=pull,
            touching_faces=touching_faces,
            face_N_mm=None if bent is None else meeting.stiffness(_spread(bent, spots)),
        )


Spots = tuple[np.ndarray, np.ndarray, tuple[int, int]]


def _by_face(members: np.ndarray, shape: tuple[int, ...]) -> tuple[np.ndarray, Spots]:
    """Faces that hold the points, and (row, point) of each among them."""
    face, point = np.divmod(members, shape[1])
    touching_faces, row = np.unique(face, return_inverse=True)
    return touching_faces, (row, point, (len(touching_faces), shape[1]))


def _spread(values: np.ndarray, spots: Spots) -> np.ndarray:
    """Values of touching points (T, ...) as (F, P, ...), zero elsewhere."""
    row, point, shape = spots
    found = np.zeros((*shape, *values.shape[1:]))
    found[row, point] = values
    return found
