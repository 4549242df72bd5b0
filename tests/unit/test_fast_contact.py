"""Fast contact on a small synthetic skin: the kernels against their twin, and what must not be."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from sim.condensed.assemble import symmetric
from sim.condensed.hardening import Hardening, PlayedFrame, PlayedPress, factor, fit, reaction_N
from sim.condensed.lessons import collider_of
from sim.condensed.surface import surface_of
from tests.synthetic_skin import flat_skin, soft_skin
from workbench.core.base.errors import SolveError
from workbench.core.base.poses import rotations
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.result.condensed import CondensedSkin, SkinColumns

EDGE, SPACING_MM = 11, 0.6
DOME_MM = 10.0
UP = np.array([0.0, 0.0, 1.0])


def path(shear_mm: float = 0.2) -> np.ndarray:
    """A few poses down and sideways of an object whose lowest point is 3 mm below its origin."""
    down = [(0.1, 0.05, 3.05 - depth) for depth in (0.0, 0.2, 0.4, 0.5)]
    side = [(0.1 + shear_mm * k / 2, 0.05, 2.55) for k in (1, 2)]
    turn = [np.cos(0.05), 0.0, np.sin(0.05), 0.0]
    return np.array([[*place, *turn] for place in (*down, *side)])


@pytest.fixture
def skin(taichi_device: str) -> CondensedSkin:
    return flat_skin(EDGE, SPACING_MM)


SLOWER = (pytest.param(kind, marks=pytest.mark.slow) for kind in ("cube", "flower"))


@pytest.mark.parametrize("kind", ["sphere", *SLOWER])
def test_the_kernels_are_their_twin(skin: CondensedSkin, kind: str) -> None:
    """Forces and displacements of every frame of a press with friction and shear."""
    from sim.condensed.fast_contact import FastContact
    from sim.condensed.reference import PlainContact

    thing = collider_of(Indenter(kind=IndenterKind(kind), size_mm=6.0))
    fast = FastContact(skin, Hardening(), Elastomer(friction=0.3))
    plain = PlainContact(skin=skin, friction=0.3)
    for pose in path()[[0, 1, 3, 5]]:
        touch = fast.step(thing, pose[None])
        force, moved = plain.step(thing, pose[:3], rotations(pose[None, 3:])[0])
        found = -force.sum(axis=0)
        scale = max(np.abs(found).max(), 1e-3)
        assert np.abs(touch.force_N[0] - found).max() < 5e-3 * scale
        assert np.abs(touch.displacement_mm[0] - moved).max() < 4e-3
    assert touch.force_N[0, 2] > 0.1
    assert touch.force_N[0, 0] < -0.01, "the skin holds back what is dragged over it"


def test_the_kernels_are_their_twin_on_a_round_skin(taichi_device: str) -> None:
    """Beside the top of a dome, where the normals of nodes that move each other differ."""
    from sim.condensed.fast_contact import FastContact
    from sim.condensed.reference import PlainContact

    flat = flat_skin(EDGE, SPACING_MM)
    x, y = flat.points_mm[:, 0], flat.points_mm[:, 1]
    points = np.column_stack([x, y, np.sqrt(DOME_MM**2 - x**2 - y**2) - DOME_MM])
    normals = (points - np.array([0.0, 0.0, -DOME_MM])) / DOME_MM
    skin = soft_skin(points, normals, flat.faces)
    thing = collider_of(Indenter(size_mm=6.0))
    fast = FastContact(skin, Hardening(), Elastomer(friction=0.3))
    plain = PlainContact(skin=skin, friction=0.3)
    for pose in path()[[0, 2, 4]]:
        touch = fast.step(thing, pose[None])
        force, _ = plain.step(thing, pose[:3], rotations(pose[None, 3:])[0])
        found = -force.sum(axis=0)
        assert np.abs(touch.force_N[0] - found).max() < 5e-3 * max(np.abs(found).max(), 1e-3)
    assert touch.force_N[0, 2] > 0.1


def test_side_by_side_is_alone_to_the_last_bit(skin: CondensedSkin) -> None:
    """Three presses of different depth in one call, and each of them by itself."""
    from sim.condensed.fast_contact import FastContact

    thing = collider_of(Indenter(size_mm=6.0))
    fast = FastContact(skin, Hardening(normal=(0.3, 1.0, 0.0)), Elastomer())
    lower = np.array([0.0, 0.1, 0.25])
    fast.reset(3)
    together = []
    for pose in path():
        poses = np.tile(pose, (3, 1))
        poses[:, 2] -= lower
        together.append(fast.step(thing, poses))
    for number in range(3):
        fast.reset(1)
        for frame, pose in zip(together, path(), strict=True):
            alone = fast.step(thing, (pose - np.r_[0, 0, lower[number], 0, 0, 0, 0])[None])
            assert np.array_equal(alone.force_N[0], frame.force_N[number])
            assert np.array_equal(alone.displacement_mm[0], frame.displacement_mm[number])


def test_without_friction_the_way_there_does_not_matter(skin: CondensedSkin) -> None:
    """At once, down, or down and aside and back: the same force at the same pose."""
    from sim.condensed.fast_contact import FastContact

    thing = collider_of(Indenter(size_mm=6.0))
    fast = FastContact(skin, Hardening(), Elastomer(friction=0.0))
    last = path()[3]
    aside = last + np.r_[0.6, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    found = []
    for ways in ([last], [*path()[:4]], [*path()[:4], aside, last]):
        fast.reset(1)
        for pose in ways:
            touch = fast.step(thing, pose[None])
        found.append(touch.force_N[0])
        assert touch.friction_ratio[0] < 1e-5
    assert np.abs(found[1] - found[0]).max() < 1e-3 * found[0][2]
    assert np.abs(found[2] - found[0]).max() < 1e-3 * found[0][2]


def test_friction_stays_in_its_cone_and_forgets_what_was_lifted(skin: CondensedSkin) -> None:
    """A long drag slides all over; lifted and set down anew, nothing of it is left."""
    from sim.condensed.fast_contact import FastContact

    thing = collider_of(Indenter(size_mm=6.0))
    fast = FastContact(skin, Hardening(), Elastomer(friction=0.4, kinetic_friction=0.3))
    first = [fast.step(thing, pose[None]) for pose in path()[:4]][-1]
    for pose in path(shear_mm=1.5)[4:]:
        dragged = fast.step(thing, pose[None])
    assert dragged.sliding[0] > 0.99
    assert dragged.friction_ratio[0] == pytest.approx(0.3, abs=2e-3)
    force = dragged.force_N[0]
    assert np.linalg.norm(force[:2]) > 0.2 * force[2]
    away = path()[3] + np.r_[0.0, 0.0, 9.0, 0.0, 0.0, 0.0, 0.0]
    assert not fast.step(thing, away[None]).force_N.any()
    again = [fast.step(thing, pose[None]) for pose in path()[:4]][-1]
    assert np.abs(again.force_N - first.force_N).max() < 2e-3 * first.force_N[0, 2]


def test_a_state_is_gone_back_to(skin: CondensedSkin) -> None:
    """The next frame from a state is the same to the last bit; another skin's state is refused."""
    from sim.condensed.fast_contact import FastContact

    thing = collider_of(Indenter(size_mm=6.0))
    fast = FastContact(skin, Hardening(), Elastomer())
    for pose in path()[:5]:
        fast.step(thing, pose[None])
    kept = fast.state()
    after = fast.step(thing, path()[5][None])
    fast.step(thing, path()[1][None])
    fast.restore(kept)
    again = fast.step(thing, path()[5][None])
    assert np.array_equal(again.force_N, after.force_N)
    assert np.array_equal(again.displacement_mm, after.displacement_mm)
    with pytest.raises(SolveError, match="no multiple"):
        fast.restore({name: array[:-1] for name, array in kept.items()})


def test_too_much_skin_at_once_is_refused(skin: CondensedSkin, monkeypatch: Any) -> None:
    """With the number and the remedy."""
    from sim.condensed import fast_contact

    monkeypatch.setattr(fast_contact, "MOST", 20)
    fast = fast_contact.FastContact(skin, Hardening(), Elastomer())
    with pytest.raises(SolveError, match=r"nodes of the skin at once; the limit .* is 20"):
        fast.step(collider_of(Indenter(size_mm=6.0)), path()[3][None])


def test_a_ball_pressed_straight_sticks(skin: CondensedSkin) -> None:
    """As in an elastic half-space that cannot be compressed, where nothing slides (Spence 1968);
    nodes at the edge are pushed 20 degrees askew, beyond the angle of friction. Sheared, the part
    that slides grows with the load across, and all of it slides at the cone."""
    from sim.condensed.fast_contact import FastContact

    ball = collider_of(Indenter(size_mm=6.0))
    fast = FastContact(skin, Hardening(), Elastomer(friction=0.3))
    for depth_mm in (0.0, 0.1, 0.2, 0.3, 0.4):
        touch = fast.step(ball, np.array([[0.0, 0.0, 3.0 - depth_mm, 1.0, 0.0, 0.0, 0.0]]))
    assert touch.touching[0] > 6
    assert touch.sliding[0] < 0.1
    assert abs(touch.force_N[0, :2]).max() < 1e-3 * touch.force_N[0, 2]
    shares, slides = [], []
    for aside_mm in (0.02, 0.05, 0.1, 0.2, 0.6):
        touch = fast.step(ball, np.array([[aside_mm, 0.0, 2.6, 1.0, 0.0, 0.0, 0.0]]))
        shares.append(-touch.force_N[0, 0] / touch.force_N[0, 2] / 0.3)
        slides.append(touch.sliding[0])
    assert shares == sorted(shares)
    assert slides[0] < 0.3
    assert slides[-1] == pytest.approx(1.0)
    assert slides == sorted(slides)


def test_a_law_that_was_put_in_is_found_again() -> None:
    """Presses whose forces are hardened by known numbers give these back."""
    rng = np.random.default_rng(0)
    law = Hardening(normal=(0.5, 2.0, -0.1), tangential=(1.0, 0.0, 0.2), deepest=0.5)
    presses = []
    for number, sharp in enumerate((0.0, 0.8, 0.8)):
        frames = []
        for k in range(1, 9):
            s = rng.uniform(0.0, 0.0625 * k, 30)
            deep = -rng.uniform(0.0, 0.01 * k, 30)[:, None] * UP
            side = rng.uniform(0.0, 0.002 * k, 30)[:, None] * np.array([1.0, 0.0, 0.0])
            frames.append(PlayedFrame(s=s, deep_N=deep, side_N=side, slides=np.arange(30) < 5))
        press = PlayedPress(
            name=f"{number}", frames=frames, reaction_N=np.zeros((8, 3)), normal=UP, sharpness=sharp
        )
        deepest = max(frame.s.max() for frame in frames)
        told = Hardening(normal=law.normal, tangential=law.tangential, deepest=deepest)
        presses.append(dataclasses.replace(press, reaction_N=reaction_N(press, told)))
    found = fit(presses)
    s = np.linspace(0.0, 0.45, 10)
    for sharp in (0.0, 0.8):
        assert factor(s, found.normal, sharp) == pytest.approx(
            factor(s, law.normal, sharp), rel=1e-3
        )
        assert factor(s, found.tangential, sharp) == pytest.approx(
            factor(s, law.tangential, sharp), rel=0.02
        )
    assert found.errors is not None
    assert max(found.errors.values()) < 1e-3


def test_tiles_are_put_together_symmetric() -> None:
    """Of two tiles that know a pair differently the mean; a pair that one knows, as it says."""
    blocks = np.arange(36.0, dtype=np.float32).reshape(4, 3, 3)
    first = SkinColumns(
        nodes=np.array([0], np.int32),
        starts=np.array([0, 2]),
        neighbours=np.array([0, 1], np.int32),
        blocks_mm_N=blocks[:2],
    )
    second = SkinColumns(
        nodes=np.array([1], np.int32),
        starts=np.array([0, 2]),
        neighbours=np.array([0, 2], np.int32),
        blocks_mm_N=blocks[2:],
    )
    whole = symmetric(3, [first, second])
    dense = np.zeros((3, 3, 3, 3))
    for row in range(3):
        for pair in range(whole.starts[row], whole.starts[row + 1]):
            dense[row, whole.neighbours[pair]] = whole.blocks_mm_N[pair]
    # Node 1 moves by blocks[1] when 0 is pushed, node 0 by blocks[2] when 1 is.
    assert np.allclose(dense[1, 0], 0.5 * (blocks[1] + blocks[2].T))
    assert np.allclose(dense[0, 1], dense[1, 0].T)
    assert np.allclose(dense[2, 1], blocks[3])
    assert np.allclose(dense[1, 2], blocks[3].T)
    assert np.allclose(dense[0, 0], 0.5 * (blocks[0] + blocks[0].T))


def test_what_is_drawn_follows_the_nodes() -> None:
    """A linear field is itself between the nodes, a dent is as deep; the weights add up to one."""
    skin = flat_skin(EDGE, SPACING_MM)
    rng = np.random.default_rng(1)
    places = np.column_stack([rng.uniform(-3, 3, (40, 2)), np.zeros(40)])
    surface = surface_of(skin.points_mm, skin.normals, places, np.tile(UP, (40, 1)))
    slope = rng.normal(size=(3, 3))
    slope[:, 2] = 0.0
    moved = skin.points_mm @ slope.T + 0.3
    assert surface.displacement_mm(moved[None])[0] == pytest.approx(
        places @ slope.T + 0.3, abs=2e-3
    )

    def dent(at: np.ndarray) -> np.ndarray:
        return -0.5 * np.exp(-np.square(np.linalg.norm(at, axis=1) / 1.5))[:, None] * UP

    inside = np.abs(places).max(axis=1) < 2.0
    drawn = surface.displacement_mm(dent(skin.points_mm)[None])[0][inside]
    assert drawn == pytest.approx(dent(places)[inside], abs=0.012)
    assert surface.weights.sum(axis=1) == pytest.approx(np.ones(40), abs=1e-6)
