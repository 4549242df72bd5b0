"""What will be refused is told from the body alone, and agrees with what the stages refuse."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.contact.motion.approach import plan_approach
from sim.contact.objects.collider import make_collider
from sim.contact.readout.verdict import check_depth
from sim.contact.region.backing import support_points_mm
from sim.optics.light.places import check_camera, check_lights
from workbench.cli.command_line import main
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Meshing, SensorDesign
from workbench.core.design.lighting import Lamp, LedMount
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MembraneMesh, Solid
from workbench.pipeline.building import build_solid
from workbench.planning.fitting import fitted
from workbench.planning.foresight import foresight_call
from workbench.planning.misfits import misfits
from workbench.project.aim import default_target_mm
from workbench.project.named_designs import load_design, presets


def body(design: SensorDesign) -> Solid:
    from designs.family import family, resolve_shape

    shape = resolve_shape(design.family, design.shape)
    return build_solid(family(design.family), shape, design.layers)


@pytest.fixture(scope="module")
def finger(made: Callable[[SensorDesign, str], Any]) -> Solid:
    """R 15, wall 2, support 1: the cavity has 12 mm."""
    return made(SensorDesign(), "build")


@pytest.fixture(scope="module")
def coarse(made: Callable[[SensorDesign, str], Any]) -> MembraneMesh:
    """The finger in cells of 0.8 mm."""
    return made(SensorDesign(meshing=Meshing(hex_mm=0.8)), "mesh")


def named(found: list[DesignError]) -> list[str]:
    return [error.at for error in found]


def test_a_finger_as_it_is_fits(finger: Solid) -> None:
    """Nothing to say, with the press of the family."""
    design = SensorDesign()
    press = Press(target_mm=default_target_mm(design, finger))
    assert misfits(finger, design.optics, Indenter(), press) == []


@pytest.mark.parametrize(
    ("field", "value", "at", "words"),
    [
        ("ring.radius_mm", 12.5, "optics.ring.radius_mm", "in the support"),
        ("ring.radius_mm", 14.0, "optics.ring.radius_mm", "in the elastomer wall"),
        ("ring.radius_mm", 20.0, "optics.ring.radius_mm", "in the space outside"),
        ("camera.position_mm", (13.5, 0.0, 5.0), "optics.camera.position_mm", "inside the wall"),
        ("camera.position_mm", (0.0, 0.0, -3.0), "optics.camera.position_mm", "below the base"),
        ("camera.position_mm", (0.0, 0.0, 39.5), "optics.camera.position_mm", "inside the wall"),
        ("lamps", (Lamp(position_mm=(0.0, 14.0, 9.0)),), "optics.lamps[1].position_mm", "wall"),
    ],
)
def test_a_light_or_camera_in_a_wall_is_told_and_moved(
    finger: Solid, field: str, value: Any, at: str, words: str
) -> None:
    """Named with its place; *fitted* moves it so that nothing is left to say."""
    design = SensorDesign().replace(f"optics.{field}", value)
    (error,) = misfits(finger, design.optics)
    assert error.at == at
    assert words in error.message
    moved, said = fitted(design, finger)
    assert said
    assert misfits(finger, moved.optics) == []


def test_a_ring_that_a_new_radius_no_longer_holds() -> None:
    """Ring of 9 mm in a finger of radius 10: its cavity has 7, and 5.5 is left for the LEDs."""
    design = SensorDesign(shape={"outer_radius_mm": 10.0})
    solid = body(design)
    assert "optics.ring.radius_mm" in named(misfits(solid, design.optics))
    moved, said = fitted(design, solid)
    assert moved.optics.ring.radius_mm == pytest.approx(5.5)
    assert "instead of 9 mm" in said
    assert misfits(solid, moved.optics) == []


def test_what_finds_no_place_is_named(finger: Solid) -> None:
    """A ring of LEDs of 20 mm finds no radius at any height; nothing is changed."""
    design = SensorDesign().replace("housing.led_width_mm", 20.0)
    design = design.replace("housing.led_height_mm", 20.0)
    same, said = fitted(design.replace("optics.ring.radius_mm", 20.0), finger)
    assert same.optics.ring.radius_mm == 20.0
    assert said == "LED ring: no radius and height were found at which it fits"


def test_leds_in_the_shell_stay_in_it(finger: Solid) -> None:
    """The middle of the support, 12 to 13 mm."""
    design = SensorDesign().replace("optics.ring.mount", LedMount.SHELL)
    moved, _ = fitted(design, finger)
    assert moved.optics.ring.radius_mm == pytest.approx(12.5, abs=0.05)
    assert moved.optics.ring.mount is LedMount.SHELL


def test_a_target_off_the_skin_is_told_with_the_nearest_place(finger: Solid) -> None:
    """20 mm beside the wall at mid height: the place at (0, 15, 13)."""
    press = Press(target_mm=(0.0, 35.0, 13.0))
    (error,) = misfits(finger, None, Indenter(), press)
    assert error.at == "press.target_mm"
    assert "is 20.0 mm from the skin; the limit is 5 mm" in error.message
    assert "(0.0, 15.0, 13.0) mm" in error.hint


@pytest.mark.parametrize("kind", [IndenterKind.SPHERE, IndenterKind.CUBE, IndenterKind.CROSS])
@pytest.mark.parametrize("target_mm", [(0.0, 10.0, 35.0), (0.0, 15.0, 13.0)])
def test_a_depth_beyond_the_wall_is_told_as_the_solver_does(
    finger: Solid,
    coarse: MembraneMesh,
    kind: IndenterKind,
    target_mm: tuple[float, float, float],
) -> None:
    """On the tip and in the middle of the straight wall, which has corners only at its ends."""
    indenter = Indenter(kind=kind)
    collider = make_collider(indenter, grid_mm=0.5)
    for depth_mm in (0.5, 1.5, 2.6, 12.0):
        press = Press(target_mm=target_mm, depth_mm=depth_mm)
        try:
            approach = plan_approach(coarse.outer, collider, press)
            check_depth(support_points_mm(coarse), approach)
            refused = False
        except DesignError:
            refused = True
        assert bool(misfits(finger, None, indenter, press)) == refused, depth_mm


@pytest.mark.slow
@pytest.mark.parametrize("name", list(presets()))
def test_presets_fit_and_rough_skins_say_what_meshes_say(
    name: str, made: Callable[[SensorDesign, str], Any]
) -> None:
    """As shipped nothing is said; random rings and cameras are judged as by the meshed skins."""
    design = load_design(name)
    solid, mesh = made(design, "build"), made(design, "mesh")
    press = Press(target_mm=default_target_mm(design, solid))
    assert misfits(solid, design.optics, Indenter(), press) == []
    random = np.random.default_rng(5)
    for _ in range(20):
        radius_mm, x, z = random.uniform(1.0, 20.0), random.uniform(-15, 15), random.uniform(0, 30)
        tried = design.replace("optics.ring.radius_mm", radius_mm)
        tried = tried.replace("optics.camera.position_mm", (x, 0.0, z))
        judged = [error.at.split(".")[1] for error in misfits(solid, tried.optics)]
        for part, check in (
            ("ring", lambda o=tried.optics: check_lights(mesh, o.ring, o.lamps)),
            ("camera", lambda o=tried.optics: check_camera(mesh, o.camera)),
        ):
            try:
                check()
                refused = False
            except DesignError:
                refused = True
            # Within a chord of the wall either may be right.
            assert (part in judged) == refused or _near_a_wall(mesh, tried, part)


def _near_a_wall(mesh: Any, design: SensorDesign, part: str) -> bool:
    from scipy.spatial import KDTree

    from sim.optics.light.lights import place_leds

    optics = design.optics
    places = place_leds(optics.ring).position_mm if part == "ring" else [optics.camera.position_mm]
    skins = np.vstack([mesh.cavity.points_mm, mesh.inner.points_mm, mesh.outer.points_mm])
    return bool(KDTree(skins).query(places)[0].min() < 1.0)


def test_the_question_is_small_and_its_answer_can_be_sent(finger: Solid, tmp_path: Path) -> None:
    """As the lanes do it: through pickle, with the fields of the errors."""
    import pickle

    from workbench.pipeline.store import Store

    design = SensorDesign().replace("optics.ring.radius_mm", 14.0)
    call = foresight_call(design, PressCase())
    store = Store(tmp_path)
    store.save(call.solid.stage, call.solid.key, finger, seconds=0.0, version=1)
    answer = pickle.loads(pickle.dumps(pickle.loads(pickle.dumps(call)).answer(store, {}, None)))
    assert named(list(answer)) == ["optics.ring.radius_mm"]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--depth-mm", "2.6"], "the indenter reaches the support"),
        (["--target", "0,40,13"], "mm from the skin"),
        (["--set", "optics.ring.radius_mm=14"], "in the elastomer wall"),
        (["--set", "shape.outer_radius_mm=10", "--target", "0,0,42"], "LED 1 of 9"),
    ],
)
def test_a_command_says_it_before_it_meshes(
    words: list[str], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Exit 2 with only the body built; a body takes a second, a bake would take ten."""
    began = time.monotonic()
    out, project = tmp_path / "out", tmp_path / "project"
    code = main(["run", "geltip", "--out", str(out), "--project", str(project), *words])
    assert code == 2
    assert told in capsys.readouterr().err
    assert time.monotonic() - began < 30.0
    assert {folder.name for folder in (project / "store").iterdir()} == {"build"}


def test_fit_makes_a_command_run_on(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The ring of 14 mm, in the clear shell, becomes 12.5: no refusal, and the change is told."""
    words = ["--set", "optics.ring.radius_mm=14", "--fit", "--depth-mm", "2.6"]
    out, project = tmp_path / "out", tmp_path / "project"
    main(["run", "geltip", "--out", str(out), "--project", str(project), *words])
    told = capsys.readouterr().err
    assert "LED ring: radius 12.497 mm instead of 14 mm" in told
    # The depth is what ends it: of the LEDs nothing is said any more.
    assert "reaches the support" in told
    assert "LED 1" not in told
