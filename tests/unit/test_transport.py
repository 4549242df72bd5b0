"""Traced light: kernels against their plain twins, drivers against each other, and the nodes."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from sim.optics.light.lights import Leds
from sim.optics.proof.specimen import finger
from sim.optics.proof.transport_scenes import plane
from sim.optics.transport import reference
from sim.optics.transport.constants import AT_NODES, FIXED_POINT, FLYING
from sim.optics.transport.gather import gather_light
from sim.optics.transport.nodes import coarse_nodes, neighbours
from sim.optics.transport.paths import Driver, Photons, trace_paths
from sim.optics.transport.radiance import trace_radiance
from sim.optics.transport.scene import Scene, build_scene, open_scene
from sim.optics.transport.sources import open_sources
from sim.optics.transport.tally import Tally, ledger_only, tally_at_nodes
from sim.optics.transport.view import directions_to_camera
from sim.specimens import finger_skin
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import Baking
from workbench.core.design.optics import Coating, Transport
from workbench.core.result.light import AZIMUTHS
from workbench.core.result.results import MembraneMesh

PHOTONS = 60_000
TRANSPORT = Transport(
    coating=Coating(albedo=0.6, specular=0.04, roughness=0.35),
    refractive_index=1.41,
    baking=Baking(photons=PHOTONS, nodes=400),
)
CAMERA = Camera(position_mm=(1.0, 2.0, 0.3))


def lights(*, in_shell: bool = False) -> Leds:
    """A red, a green and a blue LED, in the cavity or in the shell."""
    azimuth = np.array([0.3, 2.4, 4.5])
    radius = 12.5 if in_shell else 9.0
    where = np.column_stack([radius * np.cos(azimuth), radius * np.sin(azimuth), np.full(3, 0.5)])
    return Leds(
        position_mm=where,
        axis=np.tile([0.0, 0.0, 1.0], (3, 1)),
        rgb=np.eye(3),
        exponent=np.ones(3),
        cone=np.zeros(3),
        size_mm=np.full(3, 1.5),
        in_shell=np.full(3, in_shell),
    )


@pytest.fixture(scope="module")
def mesh() -> MembraneMesh:
    """A finger with edges of 1.5 mm."""
    return finger(edge_mm=1.5)


def step(
    scene: Scene,
    photons: reference.Photons,
    hits: tuple[np.ndarray, ...],
    seed: int,
    event: int,
    tally: Tally | None = None,
    power: tuple[float, float, float] = (1.0, 1.0, 1.0),
) -> tuple[reference.Photons, np.ndarray]:
    """One event of photons 0, 1, ... by the kernel; the photons after it and the ledger.

    All are of one light of that power in red, green and blue.
    """
    from sim.optics.transport import bundles, wavefront_kernels

    happen_to_all: Any = wavefront_kernels.happen_to_all
    tally = tally or ledger_only()
    origin, direction = photons.origin.astype(np.float32), photons.direction.astype(np.float32)
    flux, alive = photons.flux.astype(np.float32), np.zeros(len(photons.flux), dtype=np.int32)
    marks = (photons.fresh + 2 * photons.crossed).astype(np.int32)
    face, u, v = hits
    none = np.zeros((1, 3), dtype=np.float32)
    happen_to_all(
        tally.gather,
        0,
        event,
        seed,
        np.arange(len(flux), dtype=np.int32),
        bundles.Flight(origins=origin, directions=direction, fluxes=flux, marks=marks, alive=alive),
        bundles.Hits(face=face, u=u, v=v),
        bundles.scene_arrays(scene),
        bundles.Lamps(
            positions=none,
            axes=none,
            emission=none,
            in_shell=np.zeros(1, dtype=np.int32),
            power=np.array([power], dtype=np.float32),
        ),
        bundles.books_of(tally)[0],
    )
    after = reference.Photons(
        origin=origin,
        direction=direction,
        flux=flux,
        fresh=marks % 2 == 1,
        crossed=marks >= 2,
        fate=np.where(alive == 1, FLYING, -1),
    )
    return after, tally.ledger.sum(axis=1) / 2.0**24


def flying(scene: Scene, count: int, seed: int) -> tuple[reference.Photons, tuple[Any, ...]]:
    """Random photons at random places of all triangles, from both sides."""
    rng = np.random.default_rng(seed)
    face = rng.integers(0, len(scene.faces), count).astype(np.int32)
    weights = rng.dirichlet((1.0, 1.0, 1.0), count).astype(np.float32)
    direction = rng.normal(size=(count, 3)).astype(np.float32)
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    photons = reference.Photons(
        origin=np.zeros((count, 3), dtype=np.float32),
        direction=direction,
        flux=rng.uniform(0.2, 1.0, count).astype(np.float32),
        fresh=rng.random(count) < 0.5,
        crossed=rng.random(count) < 0.5,
        fate=np.full(count, FLYING),
    )
    return photons, (face, weights[:, 1].copy(), weights[:, 2].copy())


@pytest.mark.parametrize("index", [1.0, 1.41])
@pytest.mark.parametrize("specular", [0.0, 0.04, 0.6])
def test_one_event_equals_its_plain_twin(
    taichi_device: str, mesh: MembraneMesh, index: float, specular: float
) -> None:
    """Every field of 20,000 photons after an event is that of the twin."""
    coating = Coating(albedo=0.7, specular=specular, roughness=0.3)
    transport = dataclasses.replace(TRANSPORT, coating=coating, refractive_index=index)
    scene = open_scene(mesh, transport)
    photons, hits = flying(scene, 20_000, 1)
    after, ledger = step(scene, photons, hits, 7, 3)
    chances = reference.random4(np.arange(20_000), 7, 3)
    face, u, v = hits
    plain, absorbed, cut = reference.meet(photons, scene, face, u, v, chances)
    ended = plain.fate != FLYING
    # Where a random number is within rounding of its threshold the twins choose differently.
    same = (after.fate == FLYING) == ~ended
    assert same.mean() > 0.9995
    both = same & ~ended
    gap = np.linalg.norm(after.direction - plain.direction, axis=1)[both]
    # Near the critical angle single precision turns 1e-7 of a cosine into 3e-4 of a direction.
    assert np.mean(gap > 1e-3) < 5e-4
    assert np.median(gap) < 1e-6
    off = np.abs(after.origin - plain.origin)[both].max(axis=1)
    assert np.mean(off > 2e-5) < 5e-4
    assert np.mean(np.abs(after.flux - plain.flux)[both] > 1e-3) < 5e-4
    assert np.mean(after.fresh[both] != plain.fresh[both]) < 5e-4
    assert np.mean(after.crossed[both] != plain.crossed[both]) < 5e-4
    # One different choice moves up to 1 of about 5,000.
    assert ledger[0] == pytest.approx(absorbed.sum(), abs=10.0)
    assert ledger[3] == pytest.approx(cut.sum(), abs=10.0)


def test_light_is_divided_among_bins_as_its_plain_twin_says(taichi_device: str) -> None:
    """20,000 photons of one direction fill the twin's bins, in each node's share."""
    skin = plane(0.0, 1.0, 1)
    scene = build_scene((skin.points_mm, skin.normals, skin.faces), None, coating=Coating())
    nodes = coarse_nodes(skin, 10)
    count, toward = 20_000, np.array([0.5, -0.2, -np.sqrt(0.71)])
    photons = reference.Photons(
        origin=np.zeros((count, 3)),
        direction=np.tile(-toward, (count, 1)),
        flux=np.ones(count),
        fresh=np.ones(count, dtype=bool),
        crossed=np.zeros(count, dtype=bool),
        fate=np.full(count, FLYING),
    )
    hits = (
        np.zeros(count, dtype=np.int32),
        np.full(count, 0.2, dtype=np.float32),
        np.full(count, 0.3, dtype=np.float32),
    )
    tally = tally_at_nodes(nodes, 1)
    step(scene, photons, hits, 7, 0, tally)
    received = count / np.sqrt(0.71)
    for node, share in zip(skin.faces[0], (0.5, 0.2, 0.3), strict=True):
        found = tally.bins[0, node, 0].reshape(-1, AZIMUTHS) / FIXED_POINT
        twin = reference.expected_bins(toward, nodes.frame[node], received * share)
        # Counts in a bin of 4,000 photons differ by 60.
        np.testing.assert_allclose(found, twin, atol=5 * 60 * share / np.sqrt(0.71))
        assert found.sum() == pytest.approx(received * share, rel=1e-5)
        lamp = tally.lamps[node, 0] / FIXED_POINT
        np.testing.assert_allclose(lamp[:3] / lamp[3], toward, atol=1e-5)
    assert not tally.bins[1].any()


def test_a_node_receives_the_colours_of_the_lamp(taichi_device: str) -> None:
    """A photon of 0.6 straight down at weights 0.5, 0.2, 0.3 of a lamp of 4, 0.5 and 0 W: at the
    nodes 2.4 and 0.3 W so divided, and nothing in blue; virtual lights count photons, 0.6."""
    skin = plane(0.0, 1.0, 1)
    scene = build_scene((skin.points_mm, skin.normals, skin.faces), None, coating=Coating())
    photons = reference.Photons(
        origin=np.zeros((1, 3)),
        direction=np.array([[0.0, 0.0, 1.0]]),
        flux=np.array([0.6]),
        fresh=np.ones(1, dtype=bool),
        crossed=np.zeros(1, dtype=bool),
        fate=np.full(1, FLYING),
    )
    hits = (
        np.zeros(1, dtype=np.int32),
        np.full(1, 0.2, dtype=np.float32),
        np.full(1, 0.3, dtype=np.float32),
    )
    tally = tally_at_nodes(coarse_nodes(skin, 10), 1)
    step(scene, photons, hits, 7, 0, tally, power=(4.0, 0.5, 0.0))
    for node, share in zip(skin.faces[0], (0.5, 0.2, 0.3), strict=True):
        found = tally.bins[0, node].sum(axis=-1) / FIXED_POINT
        np.testing.assert_allclose(found, np.array([2.4, 0.3, 0.0]) * share, rtol=1e-5)
        assert tally.lamps[node, 0, 3] / FIXED_POINT == pytest.approx(0.6 * share, rel=1e-5)


def test_random_numbers_are_even_and_the_twins_equal(taichi_device: str) -> None:
    """Means of 100,000 numbers are 1/2, of products of two 1/4: no two of the four are tied."""
    numbers = reference.random4(np.arange(100_000), 1, 0)
    # Standard errors are 9e-4 and 7e-4.
    np.testing.assert_allclose(numbers.mean(axis=0), 0.5, atol=4e-3)
    products = np.einsum("pi,pj->ij", numbers, numbers) / len(numbers)
    np.testing.assert_allclose(products[~np.eye(4, dtype=bool)], 0.25, atol=4e-3)


@pytest.mark.parametrize("in_shell", [False, True])
def test_both_drivers_give_the_same_light(
    taichi_device: str, mesh: MembraneMesh, in_shell: bool
) -> None:
    """Photons carry the same random numbers in both, so their light agrees but for rounding."""
    leds = lights(in_shell=in_shell)
    one, other = (gather_light(mesh, leds, TRANSPORT, driver=driver) for driver in Driver)
    # A ray that rounding sends to another triangle changes a whole path: a few of 60,000.
    for name, share in (("first", 1e-3), ("rest", 2e-2)):
        light, again = getattr(one[2], name), getattr(other[2], name)
        assert np.abs(light - again).sum() < share * light.sum()
    np.testing.assert_allclose(one[1].sum(), other[1].sum(), rtol=1e-3)
    for key, value in one[2].balance.items():
        assert other[2].balance[key] == pytest.approx(value, abs=2e-3)


def test_light_is_the_same_whatever_the_batches_and_threads(
    taichi_device: str, mesh: MembraneMesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Sums of whole numbers are equal bit by bit, in one batch or in four."""
    from sim.optics.transport import wavefront

    whole = gather_light(mesh, lights(), TRANSPORT, driver=Driver.WAVEFRONT)
    monkeypatch.setattr(wavefront.Wavefront, "batch", PHOTONS // 4)
    monkeypatch.setattr(wavefront, "LEAST_PART", 100)
    parts = gather_light(mesh, lights(), TRANSPORT, driver=Driver.WAVEFRONT)
    np.testing.assert_array_equal(whole[2].first, parts[2].first)
    np.testing.assert_array_equal(whole[2].rest, parts[2].rest)
    np.testing.assert_array_equal(whole[0], parts[0])


def test_batches_of_radiance_add_up_to_one_run(taichi_device: str, mesh: MembraneMesh) -> None:
    """Photons 0 to n and n to 2 n give what photons 0 to 2 n give."""

    def trace(first: int, photons: int) -> Any:
        batch = Photons(count=photons, seed=TRANSPORT.baking.seed, first=first)
        return trace_radiance(mesh, lights(), CAMERA, TRANSPORT, batch)

    half, other, whole = trace(0, 15_000), trace(15_000, 15_000), trace(0, 30_000)
    np.testing.assert_allclose(half.radiance + other.radiance, whole.radiance, rtol=1e-5)
    assert whole.radiance.sum() > 0.0
    assert half.photons + other.photons == whole.photons == 30_000


def test_a_shell_led_sends_no_unscattered_light_through_the_cavity(
    taichi_device: str, mesh: MembraneMesh
) -> None:
    """What a shell LED sends across the cavity was bent twice, so it counts as scattered.

    Its virtual LED is lit only where a straight line from it misses the cavity.
    """
    direction, irradiance, scattered = gather_light(mesh, lights(in_shell=True), TRANSPORT)
    from geometry.surface.rays import RayCaster

    leds, points = lights(in_shell=True), mesh.seen.points_mm
    line = points - leds.position_mm[0]
    blocked = RayCaster(mesh.cavity.points_mm, mesh.cavity.faces).occluded(
        np.broadcast_to(leds.position_mm[0], points.shape), line, 1.0
    )
    # Opposite; the smoothing of nodes 3 mm apart blurs the edge of the shadow nearer by.
    far = blocked & (points @ leds.position_mm[0] < 0.0)
    assert far.sum() > 500
    assert irradiance[0, far].sum() < 5e-3 * irradiance[0].sum()
    assert np.isfinite(direction).all()
    np.testing.assert_allclose(np.linalg.norm(direction, axis=2), 1.0, atol=1e-5)
    assert scattered.rest.sum() > scattered.first.sum()


def test_nodes_cover_the_skin_once() -> None:
    """Areas of nodes sum to the skin's; weights sum to 1; each vertex lies by its nodes."""
    skin = finger_skin(15.0, 27.0, 0.8)
    nodes = coarse_nodes(skin, 1000)
    exact = 2.0 * np.pi * 15.0 * 27.0 + 2.0 * np.pi * 15.0**2
    assert 900 <= len(nodes.points_mm) <= 1000
    # The polyhedron of 0.8 mm edges is 0.2 % smaller than the body.
    assert nodes.area_mm2.sum() == pytest.approx(exact, rel=3e-3)
    np.testing.assert_allclose(nodes.weights.sum(axis=1), 1.0, atol=1e-6)
    interpolated = np.einsum("vk,vkd->vd", nodes.weights, nodes.points_mm[nodes.nodes])
    away = np.linalg.norm(interpolated - skin.points_mm, axis=1)
    # Nodes are 2.1 mm apart: chords lie 0.04 mm inside, the rim up to a spacing outside.
    assert np.median(away) < 0.05
    assert away.max() < 2.5
    gram = np.einsum("nij,nkj->nik", nodes.frame, nodes.frame)
    np.testing.assert_allclose(gram, np.broadcast_to(np.eye(3), gram.shape), atol=1e-6)


def test_nodes_never_mix_two_sides_of_a_thin_fin() -> None:
    """Vertices of one side of a fin 0.2 mm thick have nodes on that side only."""
    rows, columns = np.meshgrid(np.arange(41), np.arange(81), indexing="ij")
    # A sheet folded over along its middle column.
    u, v = columns.ravel() - 40, rows.ravel() * 0.5
    side = np.sign(u) * 0.1
    points = np.column_stack([side, v, 20.0 - np.abs(u) * 0.5])
    normals = np.column_stack([np.where(u == 0, 0.0, np.sign(u)), 0 * v, np.where(u == 0, 1.0, 0)])
    cell = np.arange(41 * 81).reshape(41, 81)
    a, b, c, d = (
        part.ravel() for part in (cell[:-1, :-1], cell[:-1, 1:], cell[1:, 1:], cell[1:, :-1])
    )
    faces = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    from workbench.core.result.results import Skin

    skin = Skin(points_mm=points, faces=faces.astype(np.int32), normals=normals)
    nodes = coarse_nodes(skin, 150)
    deep = np.abs(u) > 8
    mixed = np.sign(nodes.points_mm[nodes.nodes[deep], 0]) != np.sign(side[deep])[:, None]
    assert not (mixed & (nodes.weights[deep] > 1e-6)).any()


def test_a_node_without_area_takes_the_light_of_its_neighbours(mesh: MembraneMesh) -> None:
    """A stray photon over an area of 0 is no light: all means are those of sound nodes, 1."""
    nodes = coarse_nodes(mesh.seen, 300)
    area = nodes.area_mm2.copy()
    area[7] = 0.0
    light = np.ones(len(area))
    light[7] = 1e9
    found = neighbours(dataclasses.replace(nodes, area_mm2=area)) @ light
    assert found == pytest.approx(np.ones(len(area)))


def test_the_bent_way_to_the_camera_meets_the_rays_of_the_camera(mesh: MembraneMesh) -> None:
    """A point on a pixel's refracted ray sees the camera along that ray."""
    from sim.optics.camera.camera import refracted_rays

    camera = dataclasses.replace(CAMERA, width_px=64, height_px=48)
    rays = refracted_rays(camera, mesh.cavity, 1.41)
    bent = rays.transmittance < 1.0
    origin, direction = rays.origin_mm[bent].astype(float), rays.direction[bent].astype(float)
    found = directions_to_camera(origin + 2.5 * direction, mesh, camera, 1.41)
    gap = np.degrees(np.arccos(np.clip(-np.einsum("ij,ij->i", found, direction), -1.0, 1.0)))
    assert bent.sum() > 1000
    # A miss of 5 um over 2.5 mm is 0.1 degree; facets of 1.5 mm edges fold a few.
    assert np.median(gap) < 0.1
    assert np.mean(gap > 1.0) < 0.01


def test_sources_shrink_to_the_shell(mesh: MembraneMesh) -> None:
    """An LED of 1.5 mm in a shell of 1 mm, 0.5 mm from both faces, emits from 0.475 mm."""
    scene = open_scene(mesh, TRANSPORT)
    leds = lights(in_shell=True)
    radius_mm = open_sources(leds, scene).emission[:, 2]
    # The cavity's polygon lies up to 0.02 mm inside its circle.
    np.testing.assert_allclose(radius_mm, 0.95 * 0.5, atol=0.03)


def test_the_ledger_sums_to_all_that_was_emitted(taichi_device: str, mesh: MembraneMesh) -> None:
    """Shares of power sum to 1 within the rounding of whole numbers, 6e-8 an event."""
    scene = open_scene(mesh, TRANSPORT)
    tally = ledger_only()
    trace_paths(scene, open_sources(lights(), scene), tally, Photons(count=PHOTONS, seed=1))
    assert sum(tally.balance.values()) == pytest.approx(1.0, abs=1e-6)
    assert tally.balance["leaked"] < 1e-3
    assert tally.gather != AT_NODES
