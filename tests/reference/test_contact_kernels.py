"""Each Taichi kernel against its NumPy twin."""

import dataclasses
import itertools

import numpy as np
import pytest

from sim.contact.engine import reference
from sim.contact.engine.batch import Case
from sim.contact.engine.launcher import STEPS
from sim.contact.engine.relaxation import STEP_CAP, Relaxation
from sim.contact.motion.approach import plan_approach
from sim.contact.objects.collider import make_collider
from sim.contact.readout.problem import prepare
from sim.contact.region.domain import stencil_nodes
from sim.contact.studies.specimens import flat_block
from sim.material import elastic_solid
from workbench.core.design.design import Elastomer, Law
from workbench.core.design.inclusion import Inclusion, Where
from workbench.core.objects.kind import Shape, kind_of
from workbench.core.press.indenter import Indenter, IndenterKind, IndenterMesh
from workbench.core.press.press import ContactSettings, Press
from workbench.core.result.results import Label

MATERIAL = Elastomer()
ANALYTIC = [kind for kind in IndenterKind if kind_of(kind).shape is not Shape.GRID]
# Single precision has 6e-8; sums of 27 to 200 terms and the cancellation of the position lose
# two digits.
RELATIVE = 1e-5


def box_mesh(half_mm: float = 2.0) -> IndenterMesh:
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half_mm
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [f for a, b, c, d in quads for f in ((a, b, c), (a, c, d))]
    return IndenterMesh(points_mm=corners.astype(float), faces=np.array(faces, np.int32))


ONE = np.ones(1, bool)


def alone(domain, collider) -> Relaxation:
    return Relaxation([Case(domain=domain, collider=collider, friction=0.3)])


def row(pose, share: float = 1.0) -> np.ndarray:
    origin, rotation = pose
    return np.concatenate([origin, rotation.ravel(), [share]])[None]


def evaluate(relaxation: Relaxation, pose, share: float = 1.0):
    relaxation.set_poses(0, row(pose, share))
    return relaxation.evaluate(ONE).of(0)


def setup(
    indenter: Indenter,
    depth_mm: float = 0.4,
    backing_mm: float = 0.0,
    material: Elastomer = MATERIAL,
):
    mesh, points = flat_block(width_mm=6.0, height_mm=2.0, grid_mm=0.5, skin_mm=0.5)
    if backing_mm:
        labels = np.full(len(mesh.inner.faces), Label.INNER | Label.BACKED, dtype=np.uint8)
        inner = dataclasses.replace(mesh.inner, labels=labels)
        mesh = dataclasses.replace(mesh, inner=inner, backing_mm=backing_mm)
    collider = make_collider(indenter, grid_mm=0.5)
    press = Press(target_mm=(0.1, 0.2, 2.0), depth_mm=depth_mm, twist_deg=20.0, frames=1)
    approach = plan_approach(mesh.outer, collider, press)
    domain = prepare(mesh, points, material, approach, ContactSettings(), radius_mm=3.0)
    relaxation = alone(domain, collider)
    return domain, collider, approach, relaxation


def wobble(domain, amplitude_mm: float = 0.02) -> np.ndarray:
    noise = np.random.default_rng(5).uniform(-1.0, 1.0, domain.node_mm.shape)
    return (amplitude_mm * noise).astype(np.float32)


@pytest.mark.parametrize("kind", ANALYTIC)
def test_forces_equal_the_twin(taichi_device: str, kind: IndenterKind) -> None:
    """Elastic, bonding, contact and friction forces on all nodes, with a slipping contact."""
    domain, collider, approach, relaxation = setup(Indenter(kind=kind, size_mm=4.0))
    displacement = wobble(domain)
    history = reference.ContactHistory.fresh(domain.points.count)
    relaxation.restart(0, displacement)
    for progress in (1.0, 1.05):
        pose = approach.pose(progress)
        evaluate(relaxation, pose)
        point_forces = reference.surface_forces(
            domain, displacement.astype(float), history, reference.PosedObject(collider, pose, 0.3)
        )
    exact = reference.stress_forces(domain, displacement.astype(float))
    exact = domain.ties.hand_on(exact + reference.spread_to_nodes(domain, point_forces))
    assert np.count_nonzero(history.states) > 5
    bound = RELATIVE * np.abs(point_forces).max()
    assert np.abs(relaxation.point_forces() - point_forces).max() < bound
    assert np.abs(relaxation.node_forces() - exact).max() < RELATIVE * np.abs(exact).max()


def test_gel_is_sheared_by_a_third_of_what_it_is_pushed_by(taichi_device: str) -> None:
    """A block moved by (1, 2, 3) um on gel: k (1/3, 2/3, 3) um per area, k = E_gel / 1.5 mm."""
    domain, _, approach, relaxation = setup(Indenter(size_mm=4.0), depth_mm=0.0, backing_mm=1.5)
    moved_mm = np.array([1e-3, 2e-3, 3e-3])
    relaxation.restart(0, np.tile(moved_mm, (len(domain.node_mm), 1)))
    evaluate(relaxation, approach.pose(0.0))
    held = domain.points.bonded
    per_mm = MATERIAL.backing_MPa / 1.5 * moved_mm * [1 / 3, 1 / 3, 1.0]
    stiffness = domain.points.stiffness_N_mm[held] / (MATERIAL.backing_MPa / 1.5)
    exact = -stiffness[:, None] * per_mm
    assert held.sum() > 50
    np.testing.assert_allclose(relaxation.point_forces()[held], exact, rtol=RELATIVE)


def test_gel_forces_equal_the_twin_for_any_normal(taichi_device: str) -> None:
    """Axes in all directions and any spring sideways, with an indenter in contact."""
    flat, collider, approach, _ = setup(Indenter(size_mm=4.0), backing_mm=1.5)
    random = np.random.default_rng(8)
    axis = random.normal(size=flat.points.axis.shape)
    points = dataclasses.replace(
        flat.points,
        axis=axis / np.linalg.norm(axis, axis=1, keepdims=True),
        sideways=random.uniform(0.0, 1.0, len(axis)),
    )
    domain = dataclasses.replace(flat, points=points)
    relaxation = alone(domain, collider)
    displacement, pose = wobble(domain), approach.pose(1.0)
    relaxation.restart(0, displacement)
    evaluate(relaxation, pose)
    history = reference.ContactHistory.fresh(points.count)
    exact = reference.surface_forces(
        domain, displacement.astype(float), history, reference.PosedObject(collider, pose, 0.3)
    )
    held = points.bonded
    for group in (held, ~held):
        bound = RELATIVE * np.abs(exact[group]).max()
        assert bound > 0.0
        assert np.abs(relaxation.point_forces()[group] - exact[group]).max() < bound


def test_commit_equals_the_twin(taichi_device: str) -> None:
    """Anchors after a frame in which the indenter turned by 10 degrees; places are good to 1e-6."""
    domain, collider, approach, relaxation = setup(Indenter(size_mm=4.0))
    displacement = wobble(domain)
    history = reference.ContactHistory.fresh(domain.points.count)
    relaxation.restart(0, displacement)
    for progress in (1.0, 1.5):
        pose = approach.pose(progress)
        evaluate(relaxation, pose)
        met = reference.PosedObject(collider, pose, 0.3)
        arguments = (domain, displacement.astype(float), history, met)
        reference.surface_forces(*arguments)
    relaxation.commit(0)
    reference.commit_history(*arguments)
    anchors, states = relaxation.contact_history()
    np.testing.assert_array_equal(states, history.states)
    held = states >= reference.HELD
    assert {reference.HELD, reference.SLID} <= set(states.tolist())
    np.testing.assert_allclose(anchors[held], history.anchors[held], atol=2e-6)
    assert history.slips.max() > 0.05
    np.testing.assert_allclose(relaxation.slips_mm(), history.slips, atol=2e-6)


def test_a_frame_is_closed_without_those_beside_it(taichi_device: str) -> None:
    """Two presses in one batch; the second is closed: it alone has history, and a place to go to.

    It goes back to the displacement of that moment exactly, and to no later one.
    """
    domain, collider, approach, _ = setup(Indenter(size_mm=4.0))
    relaxation = Relaxation([Case(domain=domain, collider=collider, friction=0.3)] * 2)
    then, later = wobble(domain), wobble(domain, 0.01)
    for case in (0, 1):
        relaxation.restart(case, then)
        relaxation.set_poses(case, row(approach.pose(1.0)))
    relaxation.evaluate(np.ones(2, bool))
    relaxation.commit(1)
    open_states, closed_states = (relaxation.contact_history(case)[1] for case in (0, 1))
    assert set(open_states.tolist()) == {reference.FREE, reference.TOUCHED}
    assert reference.TOUCHED not in closed_states
    np.testing.assert_array_equal(open_states > 0, closed_states > 0)
    relaxation.restart(1, later)
    np.testing.assert_array_equal(relaxation.displacement(1), later)
    relaxation.go_back(1)
    np.testing.assert_array_equal(relaxation.displacement(1), then)


@pytest.mark.parametrize("kinetic", [0.3, 0.1])
def test_kinetic_friction_equals_the_twin(taichi_device: str, kinetic: float) -> None:
    """A turn that settles, then another: points that slid are held by the kinetic cone."""
    domain, collider, approach, _ = setup(Indenter(size_mm=4.0))
    case = Case(domain=domain, collider=collider, friction=0.3, kinetic_friction=kinetic)
    relaxation, displacement = Relaxation([case]), wobble(domain)
    history = reference.ContactHistory.fresh(domain.points.count)
    relaxation.restart(0, displacement)
    for progress in (1.0, 1.5, 2.0):
        pose = approach.pose(progress)
        evaluate(relaxation, pose)
        met = reference.PosedObject(collider, pose, 0.3, kinetic)
        held = reference.surface_forces(domain, displacement.astype(float), history, met)
        if progress == 1.5:
            slid = history.states == reference.TOUCHED
            relaxation.commit(0)
            reference.commit_history(domain, displacement.astype(float), history, met)
            slid &= history.states == reference.SLID
    assert slid.sum() > 3
    contact = ~domain.points.bonded
    bound = RELATIVE * np.abs(held[contact]).max()
    assert np.abs(relaxation.point_forces()[contact] - held[contact]).max() < bound
    # Those that slid, and slide on, resist by the kinetic coefficient.
    place = (reference.point_places(domain, displacement.astype(float)) - pose[0]) @ pose[1]
    _, gradient = collider.distance(place[slid])
    normal = gradient / np.linalg.norm(gradient, axis=1, keepdims=True)
    force = held[slid] @ pose[1]
    along = np.einsum("pc,pc->p", force, normal)
    aside = np.linalg.norm(force - along[:, None] * normal, axis=1)
    ratio = (aside / np.abs(along))[np.abs(along) > 0.0]
    assert ratio.max() == pytest.approx(kinetic, rel=1e-6)


def test_driven_points_are_pulled_to_their_goals(taichi_device: str) -> None:
    """Held points at share 0.25 of a way of (1, 2, 3) um: k times what is left, exactly."""
    domain, collider, approach, relaxation = setup(Indenter(size_mm=4.0), depth_mm=0.0)
    displacement, count = wobble(domain, 1e-3), domain.points.count
    goal_mm = np.tile([1e-3, 2e-3, 3e-3], (count, 1))
    relaxation.restart(0, displacement)
    relaxation.drive(0, np.zeros((count, 3)), goal_mm)
    pose = approach.pose(0.0)
    evaluate(relaxation, pose, 0.25)
    exact = reference.surface_forces(
        domain, displacement.astype(float), reference.ContactHistory.fresh(count),
        reference.PosedObject(collider, pose, 0.3), goals_mm=0.25 * goal_mm,
    )  # fmt: skip
    held = domain.points.bonded
    bound = RELATIVE * np.abs(exact[held]).max()
    assert np.abs(relaxation.point_forces()[held] - exact[held]).max() < bound


@pytest.mark.parametrize("law", Law)
def test_two_elastomers_and_both_laws_equal_the_twin(taichi_device: str, law: Law) -> None:
    """A box ten times as stiff inside the block; forces of every node as the twin has them."""
    stiff = Inclusion(
        where=Where.BOX, centre_mm=(1.0, 0.0, 1.0), size_mm=(2.0, 9.0, 9.0), young_MPa=1.45
    )
    material = dataclasses.replace(MATERIAL, law=law, inclusions=(stiff,))
    domain, collider, approach, relaxation = setup(Indenter(size_mm=4.0), material=material)
    displacement = wobble(domain)
    relaxation.restart(0, displacement)
    evaluate(relaxation, approach.pose(-3.0))
    forces = reference.stress_forces(domain, displacement.astype(float))
    history = reference.ContactHistory.fresh(domain.points.count)
    held = reference.surface_forces(
        domain,
        displacement.astype(float),
        history,
        reference.PosedObject(collider, approach.pose(-3.0), 0.3),
    )
    exact = forces + reference.spread_to_nodes(domain, held)
    assert len(np.unique(domain.moduli_MPa[:, 0])) == 2
    assert np.abs(relaxation.node_forces() - exact).max() < RELATIVE * np.abs(exact).max()


def test_a_batch_relaxes_each_case_as_if_alone(taichi_device: str) -> None:
    """Three different presses side by side: the same bits as one by one, even when one rests."""
    kinds = (IndenterKind.SPHERE, IndenterKind.CUBE, IndenterKind.CONE)
    cases, rows, starts = [], [], []
    for number, kind in enumerate(kinds):
        domain, collider, approach, _ = setup(Indenter(kind=kind, size_mm=4.0 + number))
        cases.append(Case(domain=domain, collider=collider, friction=0.3))
        rows.append(row(approach.pose(1.0)))
        starts.append(wobble(domain))

    def relax(chosen: list[int], resting: int | None) -> list[np.ndarray]:
        relaxation = Relaxation([cases[number] for number in chosen])
        for place, number in enumerate(chosen):
            relaxation.set_poses(place, rows[number])
            relaxation.restart(place, starts[number])
        moving = np.ones(len(chosen), bool)
        for turn in range(4):
            if resting is not None:
                moving[resting] = turn < 2
            relaxation.advance(moving)
            relaxation.balances(moving)
        return [relaxation.displacement(place) for place in range(len(chosen))]

    together = relax([0, 1, 2], resting=1)
    for number in (0, 2):
        (alone_mm,) = relax([number], resting=None)
        np.testing.assert_array_equal(together[number], alone_mm)


@pytest.mark.parametrize("kind", ["sphere", "cone"])
def test_step_equals_the_twin(taichi_device: str, kind: str) -> None:
    """Five damped steps from rest; the cap of 0.1 cell holds for the wildest nodes.

    Under the cone cells are halved, and nodes tied.
    """
    indenter = Indenter(kind=IndenterKind(kind), size_mm=4.0)
    domain, collider, approach, relaxation = setup(indenter)
    assert (len(domain.ties.nodes) > 0) == (kind == "cone")
    displacement = domain.ties.lead(wobble(domain, 0.1).astype(float))
    relaxation.restart(0, displacement)
    history = reference.ContactHistory.fresh(domain.points.count)
    velocity, pose = np.zeros_like(displacement), approach.pose(1.0)
    for _ in range(STEPS):
        forces = reference.stress_forces(domain, displacement)
        met = reference.PosedObject(collider, pose, 0.3)
        held = reference.surface_forces(domain, displacement, history, met)
        forces = domain.ties.hand_on(forces + reference.spread_to_nodes(domain, held))
        velocity = reference.damped_step(
            domain,
            velocity,
            forces,
            damping=relaxation.damping[0],
            mass_scale=1.0,
            largest_step=STEP_CAP * domain.grid_mm,
        )
        displacement = domain.ties.lead(displacement + velocity)
    relaxation.set_poses(0, row(pose))
    relaxation.advance(ONE)
    assert np.abs(velocity).max() <= STEP_CAP * domain.grid_mm + 1e-12
    np.testing.assert_allclose(relaxation.displacement(), displacement, atol=2e-6)


def test_sums_equal_numpy(taichi_device: str) -> None:
    """Residual, reaction and net force from fixed chunks equal sums on the host."""
    domain, _, approach, relaxation = setup(Indenter(size_mm=4.0))
    relaxation.restart(0, wobble(domain))
    balance = evaluate(relaxation, approach.pose(1.0))
    free = relaxation.node_forces()[~domain.fixed].astype(float)
    touching = relaxation.point_forces()[~domain.points.bonded].astype(float)
    np.testing.assert_allclose(balance.unbalanced_N, np.linalg.norm(free), rtol=1e-12)
    np.testing.assert_allclose(balance.net_N, free.sum(axis=0), atol=1e-12)
    np.testing.assert_allclose(balance.reaction_N, -touching.sum(axis=0), atol=1e-12)


def test_affine_field_has_no_interior_force(taichi_device: str) -> None:
    """The patch test: a homogeneous deformation is in balance; 1e-6 of the stress times dx^2."""
    domain, _, approach, relaxation = setup(Indenter(size_mm=4.0), depth_mm=0.0)
    gradient = np.array([[0.1, 0.05, 0.0], [-0.02, -0.08, 0.03], [0.0, 0.04, 0.12]])
    relaxation.restart(0, domain.node_mm @ gradient.T)
    evaluate(relaxation, approach.pose(0.0))
    full = np.isclose(domain.volumes_mm3.sum(axis=1), domain.grid_mm**3)
    touches = np.bincount(stencil_nodes(domain.rows)[full].ravel(), minlength=len(domain.masses))
    spoilt = np.zeros(len(domain.masses), bool)
    spoilt[stencil_nodes(domain.rows[domain.owners]).ravel()] = True
    interior = (touches == 27) & ~spoilt
    from sim.material import first_piola

    stress = first_piola(gradient[None], elastic_solid(MATERIAL))[0]
    scale_N = np.abs(stress).max() * domain.grid_mm**2
    assert interior.sum() >= 20
    assert np.abs(relaxation.node_forces()[interior]).max() < 2e-6 * scale_N


@pytest.mark.parametrize("offset_mm", [0.0, 0.25])
def test_a_cone_is_as_near_as_its_slant_or_its_top(taichi_device: str, offset_mm: float) -> None:
    """A right cone from (0, 0, 0) to the rim (2, 2): inside, on its slant, above it, and beside.

    An offset, which rounds its edges, is taken from the distance and leaves the gradient.
    """
    import taichi as ti
    import taichi.math as tm

    from sim.contact.objects.shape_distance_functions import CONE, signed_distance

    @ti.kernel
    def measure(
        places: ti.types.ndarray(dtype=tm.vec3, ndim=1),  # pyright: ignore
        size: tm.vec4,  # pyright: ignore
        samples: ti.types.ndarray(dtype=ti.f32, ndim=1),  # pyright: ignore
        out: ti.types.ndarray(dtype=tm.vec4, ndim=1),  # pyright: ignore
    ):
        for i in range(places.shape[0]):
            none = ti.Vector([0, 0, 0])
            whole = ti.Vector([size[0], size[1], size[2], size[3], 0.0, 0.0, 0.0, 0.0])
            distance, gradient = signed_distance(places[i], CONE, whole, samples, none, 0)
            out[i] = tm.vec4(distance, gradient)

    root = 0.5**0.5
    exact = {
        (0.3, 0.4, 1.0): (-0.5 * root, 0.6 * root, 0.8 * root, -root),
        (0.0, 0.0, 0.5): (-0.5 * root, 0.0, 0.0, -root),
        (0.3, 0.4, 1.9): (-0.1, 0.0, 0.0, 1.0),
        (0.6, 0.8, 1.0): (0.0, 0.6 * root, 0.8 * root, -root),
        (1.0, 0.0, 0.0): (root, root, 0.0, -root),
        (0.0, 0.0, -2.0): (2.0, 0.0, 0.0, -1.0),
        (0.0, 1.0, 4.0): (2.0, 0.0, 0.0, 1.0),
        (0.0, 5.0, 6.0): (5.0, 0.0, 0.6, 0.8),
    }
    places, found = np.array(list(exact), np.float32), np.zeros((len(exact), 4), np.float32)
    measure(places, tm.vec4(2.0, 2.0, offset_mm, 0.0), np.zeros(1, np.float32), found)
    wanted = np.array(list(exact.values())) - [offset_mm, 0.0, 0.0, 0.0]
    np.testing.assert_allclose(found, wanted, atol=1e-6)


@pytest.mark.parametrize("order", itertools.permutations(range(3)))
def test_distances_to_the_seven_parts_of_a_triangle(
    taichi_device: str, order: tuple[int, int, int]
) -> None:
    """To corners, edges and face of (0, 0), (4, 0), (0, 4), whichever corner comes first."""
    from sim.contact.objects.mesh_distance_kernels import band_distance

    exact = {
        (-1, -2, 2): 1 + 4 + 4,
        (6, -1, 0): 4 + 1,
        (-1, 6, 1): 1 + 4 + 1,
        (1, -2, 1): 4 + 1,
        (-2, 3, 2): 4 + 4,
        (4, 4, 1): 4**2 / 2 + 1,  # From the line x + y = 4.
        (1, 2, 3): 9,
    }
    places = np.array(list(exact)) + 3
    triangle = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0]], dtype=np.float32)[list(order)] + 3.0
    squared = np.full((12, 12, 12), 1e3, dtype=np.float32)
    band_distance(triangle[None], squared, 1.0, 5.0)
    np.testing.assert_allclose(squared[tuple(places.T)], list(exact.values()), rtol=RELATIVE)


def test_a_face_beyond_the_grid_is_near_its_last_samples_alone(taichi_device: str) -> None:
    """One step over three layers: 3, 2 and 1 steps away, squared; what lies behind is untouched."""
    from sim.contact.objects.mesh_distance_kernels import band_distance

    memory = np.full((5, 3, 3), 99.0, dtype=np.float32)
    wide = np.array([[[-40.0, -40.0, 3.0], [80.0, -40.0, 3.0], [-40.0, 80.0, 3.0]]])
    band_distance((0.5 * wide).astype(np.float32), memory[:3], 0.5, 4.0)
    steps = np.broadcast_to([3.0, 2.0, 1.0], (3, 3, 3))
    np.testing.assert_allclose(memory[:3], (0.5 * steps) ** 2, rtol=RELATIVE)
    assert (memory[3:] == 99.0).all()


def test_mesh_distance_equals_the_twin(taichi_device: str) -> None:
    """The sampled distance of a box: band exact to 1e-5 mm, sign exact, at every sample."""
    from sim.contact.objects.mesh_distance import BAND_SAMPLES, _distance, _inside
    from sim.contact.objects.samples import SampleGrid

    mesh, spacing = box_mesh(1.0), 0.25
    shape = np.array([21, 21, 21])
    grid = SampleGrid(origin_mm=np.full(3, -2.5), spacing_mm=spacing, shape=(21, 21, 21))
    corners = mesh.points_mm[mesh.faces] + 2.5
    places = np.stack(np.meshgrid(*[np.arange(21) * spacing] * 3, indexing="ij"), -1)
    distance = _distance(corners, grid, BAND_SAMPLES).ravel()
    exact = np.sqrt(reference.squared_distances(corners, places.reshape(-1, 3)))
    near = exact < 5 * spacing - 1e-6
    np.testing.assert_allclose(distance[near], exact[near], atol=1e-5)
    assert (distance <= exact + 1e-5).all()
    inside = _inside(corners, shape, spacing).ravel()
    nudged = places.reshape(-1, 3) + spacing * np.array([1.37e-4, 2.33e-4, 3.15e-4])
    winding = reference.winding_along_z(corners, nudged)
    clear = exact > 1e-3
    np.testing.assert_array_equal(inside[clear], winding[clear] > 0)
