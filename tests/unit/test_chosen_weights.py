"""Which weights a press names: shipped, of the project, none; their key, and what is wrong."""

from __future__ import annotations

import dataclasses
import importlib
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.forces.network.spec import Target
from tests.made_weights import card_of, tiny_weights, write_tiny
from tests.unit.test_learned_forces import contact, membrane
from workbench.core.base.errors import Cancelled, StoreError
from workbench.core.press.learned import NONE, LearnedSettings, WeightsFile
from workbench.core.press.press_case import PressCase
from workbench.core.result.force_field import Source
from workbench.pipeline import shipped
from workbench.pipeline.chosen_weights import FOLDER, about, chosen, offered, weights_files
from workbench.pipeline.devices import load_torch
from workbench.pipeline.known_membrane import membrane_differences
from workbench.pipeline.stages.learned import foreknown
from workbench.pipeline.store import Store
from workbench.planning.plan import plan
from workbench.planning.running import run
from workbench.project.design_bundle import bundle, unbundle
from workbench.project.design_toml import design_to_toml
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.project.state import State, case_table, read_state

FINGER = load_design("finger")


@pytest.fixture(autouse=True)
def none_shipped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder in place of the shipped weights."""
    folder = tmp_path / "shipped"
    monkeypatch.setattr(shipped, "FOLDER", folder)
    return folder


@pytest.fixture
def project(tmp_path: Path) -> Project:
    return Project(tmp_path / "project")


def force_file(folder: Path, **card: Any) -> Path:
    """Weights that know the default press of the default finger, but for what is given."""
    known = {**card_of(FINGER, hex_mm=1.0), **card}
    return write_tiny(folder, tiny_weights((0.0, 0.0, -1e-3), card=known))


def case_with(path: Path | str, **fields: Any) -> PressCase:
    """The default press with these force weights and no displacement network."""
    settings = LearnedSettings(weights=str(path), displacement=NONE)
    return PressCase(learned=settings, **fields)


def test_without_weights_nothing_is_planned_and_the_remedy_is_a_command() -> None:
    """No stage `learned`; whoever asks for shipped weights is told how to make them."""
    assert "learned" not in plan(FINGER, PressCase())
    with pytest.raises(StoreError, match="no trained network for force") as caught:
        shipped.shipped_weights(Target.FORCE)
    assert "workbench train make DATA --preset small --target force --out DIR" in caught.value.hint


def test_shipped_weights_are_found_by_their_target(none_shipped: Path) -> None:
    """Two files in the folder: each is that of its target, and both are in the plan."""
    force = force_file(none_shipped)
    moved = write_tiny(none_shipped, tiny_weights(target=Target.DISPLACEMENT))
    assert shipped.shipped_weights(Target.FORCE) == force
    assert [file and file.name for file in weights_files(LearnedSettings())] == [
        force.name,
        moved.name,
    ]
    alone = weights_files(LearnedSettings(displacement=NONE))
    assert [file and file.name for file in alone] == [force.name, None]
    assert "learned" in plan(FINGER, PressCase())


def test_the_shipped_displacement_goes_with_the_shipped_force(
    none_shipped: Path, tmp_path: Path
) -> None:
    """Own weights of forces are of another membrane: the solver's displacement stays."""
    write_tiny(none_shipped, tiny_weights())
    shipped = write_tiny(none_shipped, tiny_weights(target=Target.DISPLACEMENT))
    own = write_tiny(tmp_path / "weights", tiny_weights((1.0, 0.0, 0.0)))
    settings = LearnedSettings(weights=str(own))
    force, displacement = weights_files(settings)
    assert force is not None and force.name == own.name and displacement is None
    assert offered(tmp_path, settings, "displacement") == {
        f"shipped, {shipped.name.partition('-')[0]}": str(shipped),
        "contact solver's own": "",
    }
    asked = LearnedSettings(weights=str(own), displacement=str(shipped))
    assert [file and file.name for file in weights_files(asked)] == [own.name, shipped.name]
    assert offered(tmp_path, asked, "displacement")["contact solver's own"] == NONE


def test_a_key_holds_the_name_of_the_weights_but_not_their_place(tmp_path: Path) -> None:
    """The same file elsewhere gives the same key; other weights, or another press, another."""
    one, copy = force_file(tmp_path / "a"), force_file(tmp_path / "b")
    other = force_file(tmp_path / "a", friction=0.4)
    assert one.name == copy.name != other.name
    keys = [plan(FINGER, case_with(path))["learned"].key for path in (one, copy, other)]
    assert keys[0] == keys[1] != keys[2]
    softer = FINGER.replace("material.young_MPa", 0.1)
    assert plan(softer, case_with(one))["learned"].key != keys[0]
    looked = FINGER.replace("optics.camera.fov_x_deg", 80.0)
    assert plan(looked, case_with(one))["learned"].key == keys[0]
    fem = plan(FINGER, PressCase())["fem"].key
    assert plan(FINGER, case_with(one))["fem"].key == fem


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (lambda path: path.unlink(), "cannot read"),
        (lambda path: path.write_bytes(path.read_bytes()[:-9]), "damaged or cut short"),
        (lambda path: path.write_bytes(b"hello"), "holds no force network"),
    ],
)
def test_weights_that_cannot_be_read_are_told_when_they_are_used(
    tmp_path: Path, spoil: Callable[[Path], Any], says: str
) -> None:
    """Planning goes on; the network knows nothing, and running it raises."""
    path = force_file(tmp_path)
    spoil(path)
    call = plan(FINGER, case_with(path))["learned"]
    (reason,) = foreknown(call.inputs)
    assert says in reason
    with pytest.raises(StoreError, match=says) as caught:
        run(Store(tmp_path / "store"), call)
    assert caught.value.hint


def test_a_renamed_file_is_refused_with_its_name(tmp_path: Path) -> None:
    """The hash in the name is that of the content, so it must be what was chosen."""
    path = force_file(tmp_path).rename(tmp_path / "mine-force-0123456789abcdef.weights")
    with pytest.raises(StoreError, match="renamed or exchanged"):
        chosen(path)


def test_only_force_weights_are_chosen_for_forces(tmp_path: Path) -> None:
    """A displacement network in their place is refused before anything is computed."""
    path = write_tiny(tmp_path, tiny_weights(target=Target.DISPLACEMENT))
    with pytest.raises(StoreError, match="predicts displacement, not force"):
        chosen(path)
    assert chosen(path, Target.DISPLACEMENT) == str(path)


def test_about_reads_a_file_anew_when_it_has_changed(tmp_path: Path) -> None:
    """Cards are kept by the file's time and size."""
    path = force_file(tmp_path)
    file = WeightsFile(name=path.name, path=str(path))
    assert about(file).hex_mm == 1.0
    path.write_bytes(b"hello")
    with pytest.raises(StoreError):
        about(file)


def test_a_project_that_moved_finds_its_weights(project: Project, tmp_path: Path) -> None:
    """A design file names them from the project's folder, wherever that is; others in full."""
    inside, outside = force_file(project.folder / FOLDER), force_file(tmp_path / "elsewhere")
    table = case_table(case_with(inside), project)
    assert table["learned"]["weights"] == f"{FOLDER}/{inside.name}"
    assert case_table(case_with(outside), project)["learned"]["weights"] == str(outside)
    text = design_to_toml(FINGER, press_case=table)
    moved = Project(tmp_path / "moved")
    read = read_state(text, moved, source="here").case.learned
    assert read == LearnedSettings(
        weights=str(moved.folder / FOLDER / inside.name), displacement=NONE
    )


@pytest.mark.parametrize("setting", ["/etc/passwd", "../../secret.weights", "C:\\x\\a.weights"])
def test_a_file_from_a_browser_names_weights_of_the_project_only(
    project: Project, setting: str
) -> None:
    """Whatever path it holds, the name alone counts."""
    table = {"learned": {"weights": setting}}
    text = design_to_toml(FINGER, press_case=table)
    read = read_state(text, project, source="there", enclosed=True).case.learned
    assert Path(read.weights).parent == project.folder / FOLDER


def test_a_zip_looks_for_its_weights_where_it_came_to(project: Project, tmp_path: Path) -> None:
    """Not in the folder that it was unpacked in, which is gone."""
    inside = force_file(project.folder / FOLDER)
    name, content = bundle(State(design=FINGER, case=case_with(inside)), project)
    other = Project(tmp_path / "other")
    read = unbundle(name, content, other).case.learned
    assert read.weights == str(other.folder / FOLDER / inside.name)


def test_choices_are_those_of_the_project_and_what_stands(
    project: Project, none_shipped: Path
) -> None:
    """Nothing shipped; one in the project; one that is gone but chosen stays visible."""
    assert offered(project.folder, LearnedSettings(), "weights") == {"none shipped": ""}
    kept = force_file(project.folder / FOLDER)
    gone = LearnedSettings(weights=str(project.folder / FOLDER / "old.weights"))
    assert offered(project.folder, gone, "weights") == {
        kept.name: str(kept),
        "old.weights (missing)": gone.weights,
    }
    shipped_file = force_file(none_shipped, friction=0.4)
    assert offered(project.folder, LearnedSettings(), "weights") == {
        f"shipped, {shipped_file.name.partition('-')[0]}": "",
        kept.name: str(kept),
    }
    moved = offered(project.folder, LearnedSettings(displacement=NONE), "displacement")
    assert moved == {"contact solver's own": NONE}
    assert offered(project.folder, LearnedSettings(), "displacement") == {
        "contact solver's own": ""
    }


@pytest.mark.parametrize(
    ("field", "value", "says"),
    [
        ("layers.elastomer_mm", 1.5, ("elastomer is 1.5 mm, trained with 2 mm",)),
        ("shape", {"cylinder_mm": 30.0}, ("cylinder is 30 mm, trained with 27 mm",)),
        ("material.young_MPa", 0.5, ()),
        ("optics.ring.count", 5, ()),
        ("meshing.hex_mm", 0.8, ()),
    ],
)
def test_designs_differ_in_what_makes_the_membrane(
    field: str, value: Any, says: tuple[str, ...]
) -> None:
    """Shape and layers count; material, light and meshes leave the membrane."""
    card = card_of(FINGER, hex_mm=1.0)
    design = (
        dataclasses.replace(FINGER, shape=value)
        if field == "shape"
        else FINGER.replace(field, value)
    )
    assert membrane_differences(card, design) == says


def test_another_family_is_all_that_is_said() -> None:
    """No parameter of a trunk means anything on a finger; without a design nothing is known."""
    card = card_of(load_design("trunk"), hex_mm=1.0)
    assert membrane_differences(card, FINGER) == ("the sensor is a finger, trained on a trunk",)
    assert membrane_differences({}, FINGER) is None


def test_what_is_known_beforehand_is_what_the_result_says(tmp_path: Path) -> None:
    """Nothing for the press of the training; each difference for another."""
    path = force_file(tmp_path)
    assert foreknown(plan(FINGER, case_with(path))["learned"].inputs) == ()
    deep = case_with(path)
    deep = dataclasses.replace(deep, press=dataclasses.replace(deep.press, depth_mm=1.5))
    thin = FINGER.replace("layers.elastomer_mm", 1.5)
    assert foreknown(plan(thin, deep)["learned"].inputs) == (
        "elastomer is 1.5 mm, trained with 2 mm",
        "the press is 1.5 mm deep, trained to 1 mm",
    )


def test_the_stage_stores_forces_on_the_design_s_skin(tmp_path: Path) -> None:
    """Meshes and press are in the store: 81 vertices of the network, 289 of the design."""
    path = force_file(tmp_path)
    store = Store(tmp_path / "store")
    call = plan(FINGER.replace("material.young_MPa", 0.29), case_with(path))["learned"]
    mesh, build, pressed = call.inputs.mesh, call.inputs.solid, call.inputs.contact
    part = _parts(store, call)["source"]
    fine, coarse = membrane(16), membrane(8)
    for ref, value in ((mesh, fine), (build, fine), (pressed, contact(fine)), (part, coarse)):
        store.save(ref.stage, ref.key, value, seconds=0.0, version=1)
    outcome = run(store, call)
    found = store.load("learned", outcome.key)
    assert found.source is Source.LEARNED and found.contact_force_N.shape[1] == 289
    # 81 mN downward by the network, twice that at twice the stiffness.
    assert np.allclose(found.normal_N, 2 * 0.081, rtol=1e-5)
    assert "scaled by 2" in found.note and found.notice == ""
    assert found.solver.startswith(path.name)


def _parts(store: Store, call: Any) -> Any:
    from workbench.planning.stage_table import STAGES

    parts = STAGES["learned"].parts
    assert parts is not None
    return parts(call.inputs, store)


def test_loading_can_be_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    """The monitor is asked while PyTorch loads, and what it raises is passed on at once."""
    stopped = threading.Event()

    def stop(fraction: float, note: str = "") -> None:
        raise Cancelled("stopped")

    monkeypatch.setattr(importlib, "import_module", lambda name: stopped.wait(10.0))
    try:
        with pytest.raises(Cancelled):
            load_torch(stop)
    finally:
        stopped.set()
