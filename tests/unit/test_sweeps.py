"""Sweeps without a solver: values, resuming, failures and files."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from workbench.core.base.errors import DesignError, SolveError
from workbench.core.result.sensing import Metrics, Shot, TactileFrames
from workbench.planning.plan import plan
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.project.state import State, fresh_state
from workbench.system.names import numbered
from workbench.variants.sweep_fields import field_value, find_field, sweep_fields, with_value
from workbench.variants.sweep_files import (
    delete_sweep,
    list_sweeps,
    load_sweep,
    restore_sweep,
    save_sweep,
)
from workbench.variants.sweeps import (
    Span,
    Status,
    Sweep,
    curve,
    done,
    failed,
    make_sweep,
    refusal,
    seconds_left,
    state_at,
    sweep_values,
    todo,
)

WALL = "design.layers.elastomer_mm"


@pytest.fixture
def project(tmp_path: Path) -> Project:
    return Project(tmp_path / "project")


def finger() -> State:
    return fresh_state(load_design("finger"))


def walls(project: Project, start: float = 1.0, stop: float = 3.0) -> Sweep:
    name = numbered("elastomer_mm", list_sweeps(project), first=1)
    return make_sweep(name, finger(), WALL, Span(start=start, stop=stop, steps=3))


def shot(grey: float) -> Shot:
    """An image of 4 x 3 px with one figure."""
    frames = TactileFrames(
        rgb=np.zeros((2, 3, 4, 3), np.uint8),
        depth_z_mm=np.zeros((2, 3, 4), np.float32),
        normal=np.zeros((2, 3, 4, 3), np.float16),
        moved=np.zeros((2, 3, 4), bool),
        marker_uv_px=np.zeros((2, 0, 2), np.float32),
        exposure=1.0,
    )
    values = {"contact_change_mean_grey": grey, "peak_normal_force_N": math.nan}
    return Shot(frames=frames, metrics=Metrics(values=values))


def compute(project: Project, sweep: Sweep, number: int) -> None:
    """Put a result of a point where its stage would."""
    state = state_at(sweep, number)
    key = plan(state.design, state.case)["shoot"].key
    project.store.save("shoot", key, shot(sweep.points[number].value), seconds=1.0, version=1)


def test_values_include_both_ends_and_whole_ones_are_unique() -> None:
    """0.1 to 0.5 in 5 steps has 0.3 exactly; LEDs 1 to 3 in 5 steps are 1, 2, 3."""
    about = find_field(finger(), WALL)
    assert sweep_values(about, Span(start=0.1, stop=0.5, steps=5)) == [0.1, 0.2, 0.3, 0.4, 0.5]
    leds = find_field(finger(), "design.optics.ring.count")
    assert sweep_values(leds, Span(start=1, stop=3, steps=5)) == [1.0, 2.0, 3.0]


@pytest.mark.parametrize(
    ("start", "stop", "steps"), [(1, 1, 3), (1, math.nan, 3), (1, 2, 1), (1, 2, 16), (50, 60, 3)]
)
def test_sweeps_without_sense_are_refused(start: float, stop: float, steps: int) -> None:
    """Equal ends, NaN, too few or many steps, and values that the design refuses throughout."""
    with pytest.raises(DesignError):
        make_sweep("x", finger(), WALL, Span(start=start, stop=stop, steps=steps))


def test_an_unknown_field_is_refused_with_a_suggestion() -> None:
    """A misspelt one gets the nearest."""
    with pytest.raises(DesignError) as caught:
        find_field(finger(), "layers.elastomer")
    assert "design.layers.elastomer_mm" in caught.value.hint


@pytest.mark.parametrize("preset", ["finger", "trunk", "paw", "pad"])
def test_every_field_can_be_read_and_set_to_its_own_value(preset: str) -> None:
    """Setting what is there changes no key, so a sweep through the base finds its results."""
    state = fresh_state(load_design(preset))
    before = {name: call.key for name, call in plan(state.design, state.case).items()}
    for field in sweep_fields(state):
        same = with_value(state, field, field_value(state, field.path))
        assert {n: c.key for n, c in plan(same.design, same.case).items()} == before, field.path


def test_the_target_follows_the_family_unless_the_designer_placed_it() -> None:
    """A longer finger is pressed where its family aims; a target of the designer's stays."""
    import dataclasses

    state = finger()
    field = next(f for f in sweep_fields(state) if f.path.startswith("design.shape."))
    value = field_value(state, field.path) + 3.0
    aimed = with_value(state, field, value)
    assert aimed.case.press.target_mm == fresh_state(aimed.design).case.press.target_mm
    own = dataclasses.replace(state.case.press, target_mm=(1.0, 2.0, 30.0))
    placed = State(design=state.design, case=dataclasses.replace(state.case, press=own))
    assert with_value(placed, field, value).case.press.target_mm == (1.0, 2.0, 30.0)


def test_a_sweep_goes_on_where_it_stopped(project: Project) -> None:
    """After a restart only what is not done is to do; a result cleared from the store is again."""
    sweep = walls(project)
    assert todo(sweep, project.store) == [0, 1, 2]
    compute(project, sweep, 0)
    sweep = done(sweep, 0, project.store, 4.0)
    save_sweep(project, sweep)
    again = load_sweep(project, sweep.name)
    assert again == sweep
    assert todo(again, project.store) == [1, 2]
    assert again.points[0].figures == {"press_depth_mm": 1.0, "contact_change_mean_grey": 1.0}
    for meta in (project.folder / "store").glob("shoot/*/meta.json"):
        meta.unlink()
    assert todo(again, project.store) == [0, 1, 2]


def test_a_failed_point_keeps_its_message_and_the_others_their_figures(project: Project) -> None:
    """It is tried again only when nothing else is left."""
    sweep = walls(project)
    for number in (0, 2):
        compute(project, sweep, number)
        sweep = done(sweep, number, project.store, 1.0)
    sweep = failed(sweep, 1, SolveError("frame 3 did not settle", hint="press less deep"))
    save_sweep(project, sweep)
    sweep = load_sweep(project, sweep.name)
    assert sweep.points[1].status is Status.FAILED
    assert sweep.points[1].message == "frame 3 did not settle; press less deep"
    assert curve(sweep, "contact_change_mean_grey") == ([1.0, 3.0], [1.0, 3.0])
    assert todo(sweep, project.store) == [1]
    assert sweep.finished == 3


def test_a_value_that_the_design_refuses_fails_alone(project: Project) -> None:
    """A wall of 20 mm does not fit into the finger; 1 mm does."""
    sweep = make_sweep("x", finger(), WALL, Span(start=1.0, stop=20.0, steps=2))
    assert refusal(sweep, 0) is None
    assert refusal(sweep, 1) is not None


def test_time_left_is_that_of_all_points_to_go(project: Project) -> None:
    """Points found in the store do not count as pace; the running one is counted off."""
    sweep = walls(project)
    assert seconds_left(sweep, 3) is None
    for number, seconds in ((0, 10.0), (1, 0.01)):
        compute(project, sweep, number)
        sweep = done(sweep, number, project.store, seconds)
    assert seconds_left(sweep, 2, running_s=4.0) == pytest.approx(16.0)
    assert seconds_left(sweep, 0) is None


def test_broken_sweep_files_are_refused_with_a_reason(project: Project) -> None:
    """Nonsense, a foreign key, an unknown field."""
    sweep = walls(project)
    path = save_sweep(project, sweep)
    text = path.read_text()
    assert list_sweeps(project) == ["elastomer_mm 1"]
    for nonsense in (
        "not [toml",
        text.replace(f'path = "{WALL}"', 'path = "design.nothing"'),
        text.replace('status = "waiting"', 'status = "perhaps"'),
        text.replace("value = 1.0", 'value = "one"'),
    ):
        path.write_text(nonsense)
        with pytest.raises(DesignError):
            load_sweep(project, "elastomer_mm 1")


def test_a_deleted_sweep_comes_back_beside_one_that_took_its_name(project: Project) -> None:
    """The second is called `elastomer_mm 2`; a sweep that cannot be read is deleted too."""
    path = save_sweep(project, walls(project))
    kept = delete_sweep(project, path.stem)
    assert list_sweeps(project) == []
    path.write_text("not [toml")
    assert restore_sweep(project, kept) == "elastomer_mm 2"
    assert load_sweep(project, "elastomer_mm 2").path == walls(project).path
    delete_sweep(project, path.stem)
    assert list_sweeps(project) == ["elastomer_mm 2"]
    with pytest.raises(DesignError):
        delete_sweep(project, path.stem)
