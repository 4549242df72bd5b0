"""`workbench run --sources`: which are asked for, and their totals and fields side by side."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista

from sim.forces.network.spec import Target
from sim.forces.peaks import DISC_MM
from tests.made_weights import tiny_weights, write_tiny
from tests.unit.test_force_sources import SKIN, field
from workbench.core.base.errors import DesignError, StoreError
from workbench.core.press.press_case import PressCase
from workbench.core.result.force_field import Source
from workbench.core.result.results import MembraneMesh
from workbench.pipeline import shipped
from workbench.report.source_arrays import source_arrays, source_columns
from workbench.report.source_files import asked_sources, last_frame, with_weights, write_fields
from workbench.view.force_sources import Forces

MPM, FEM = field(1.0, 1.8, Source.MPM), field(1.0, 2.0)
LEARNED = dataclasses.replace(field(1.1, 2.1, Source.LEARNED), notice="deep", note="E doubled")
ALL = (MPM, FEM, LEARNED)
MESH = MembraneMesh(hexes=None, outer=SKIN, inner=SKIN, cavity=SKIN)


def sources() -> dict[Source, Forces]:
    """All three, with a pressure; nobody solved for the network's."""
    own = np.full((1, len(SKIN.points_mm)), 0.3, np.float32)
    found = {s: dataclasses.replace(f, pressure_MPa=own) for s, f in zip(Source, ALL, strict=True)}
    none = np.array([np.nan])
    learned = dataclasses.replace(found[Source.LEARNED], residual=none, balance=none)
    return {**found, Source.LEARNED: learned}


def test_sources_are_asked_for_by_name() -> None:
    """In our order, spaces and empty parts left out; a misspelt one is refused."""
    assert asked_sources("") == ()
    assert asked_sources("learned, mpm,") == (Source.MPM, Source.LEARNED)
    with pytest.raises(DesignError, match="no source 'fen' of forces") as caught:
        asked_sources("mpm,fen")
    assert caught.value.hint == "did you mean 'fem'?" and caught.value.at == "--sources"


def test_a_network_that_is_asked_for_must_be_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing ships and no file is given: refused at once; a file of forces is taken."""
    monkeypatch.setattr(shipped, "FOLDER", tmp_path / "shipped")
    case = PressCase()
    assert with_weights(case, None, (Source.MPM,)) == case
    with pytest.raises(StoreError, match="no trained network for force"):
        with_weights(case, None, (Source.LEARNED,))
    path = write_tiny(tmp_path, tiny_weights())
    assert with_weights(case, path, (Source.LEARNED,)).learned.weights == str(path)
    moved = write_tiny(tmp_path, tiny_weights(target=Target.DISPLACEMENT))
    with pytest.raises(StoreError, match="predicts displacement"):
        with_weights(case, moved, (Source.LEARNED,))


def test_columns_are_named_by_their_source() -> None:
    """Normal and tangential force and both peaks of each: 2 and 0.5 N by FEM, on 1 mm2."""
    columns = source_columns({Source.MPM: MPM, Source.FEM: FEM}, np.array([1.0]), SKIN)
    assert list(columns) == [
        *("frame", "depth_mm", "disc_mm", "mpm_normal_N", "mpm_tangential_N"),
        *("mpm_peak_MPa", "mpm_peak_disc_N", "fem_normal_N", "fem_tangential_N"),
        *("fem_peak_MPa", "fem_peak_disc_N"),
    ]
    assert columns["frame"].tolist() == [1]
    assert columns["disc_mm"].tolist() == [DISC_MM]
    assert columns["fem_normal_N"] == pytest.approx([2.0])
    assert columns["mpm_tangential_N"] == pytest.approx([0.45])
    assert 0.8 * np.hypot(2.0, 0.5) < columns["fem_peak_disc_N"][0] < np.hypot(2.0, 0.5)


def test_what_a_source_does_not_know_is_left_out() -> None:
    """Neither a column nor an array of forces that nobody found; what is known stays."""
    none = dataclasses.replace(MPM, contact_force_N=np.zeros((0, 0, 3), np.float32))
    columns = source_columns({Source.MPM: none}, np.array([1.0]), SKIN)
    assert "mpm_normal_N" in columns and "mpm_peak_MPa" not in columns
    arrays = source_arrays({Source.MPM: none}, columns, SKIN)
    assert sorted(arrays) == [
        *("depth_mm", "disc_mm", "faces", "mpm_displacement_mm", "mpm_reaction_N", "points_mm"),
    ]


def test_arrays_of_every_source_come_back_from_the_file(tmp_path: Path) -> None:
    """Each with its source's name before it, none with NaN; forces sum up to minus the reaction."""
    found = sources()
    names = write_fields(tmp_path, MESH, found, [1.0])
    assert {path.name for path in tmp_path.iterdir()} == set(names)
    with np.load(tmp_path / "sources.npz") as file:
        arrays = dict(file)
    assert all(np.isfinite(values).all() for values in arrays.values())
    assert np.array_equal(arrays["points_mm"], SKIN.points_mm)
    assert np.array_equal(arrays["faces"], SKIN.faces)
    assert arrays["depth_mm"].tolist() == [1.0] and arrays["disc_mm"] == DISC_MM
    for source, forces in found.items():
        for name in ("displacement_mm", "contact_force_N", "pressure_MPa", "reaction_N"):
            assert np.array_equal(arrays[f"{source.value}_{name}"], getattr(forces, name)), name
        total_N = arrays[f"{source.value}_contact_force_N"].sum(axis=1, dtype=np.float64)
        reaction_N = arrays[f"{source.value}_reaction_N"]
        assert np.linalg.norm(total_N + reaction_N) < 1e-6 * np.linalg.norm(reaction_N)
        assert arrays[f"{source.value}_peak_MPa"] == pytest.approx([0.3])
        assert arrays[f"{source.value}_peak_disc_N"].shape == (1,)


def test_other_programs_read_every_frame_of_every_source(tmp_path: Path) -> None:
    """PyVista finds the skin and the fields in the VTK files; the network has no slip."""
    found = sources()
    write_fields(tmp_path, MESH, found, [1.0])
    for source, forces in found.items():
        surface: Any = pyvista.read(tmp_path / f"sources_{source.value}_000.vtp")
        assert np.array_equal(surface.points, SKIN.points_mm)
        assert np.array_equal(surface.regular_faces, SKIN.faces)
        for name in ("displacement_mm", "contact_force_N", "pressure_MPa"):
            assert np.array_equal(surface.point_data[name], getattr(forces, name)[0]), name
        assert np.array_equal(surface.field_data["reaction_N"], forces.reaction_N)
        assert surface.field_data["depth_mm"].tolist() == [1.0]
        assert ("residual" in surface.field_data) == (source is not Source.LEARNED)
        assert "slip_mm" not in surface.point_data and "sliding" not in surface.point_data
        series: Any = pyvista.get_reader(tmp_path / f"sources_{source.value}.pvd")
        assert series.time_values == [0.0]


def test_files_of_sources_that_are_no_longer_asked_for_go(tmp_path: Path) -> None:
    """A second run with one source and the designer's own file beside it."""
    write_fields(tmp_path, MESH, sources(), [1.0])
    (tmp_path / "sources_of_truth.txt").write_text("mine")
    names = write_fields(tmp_path, MESH, {Source.FEM: sources()[Source.FEM]}, [1.0])
    left = {path.name for path in tmp_path.iterdir()}
    assert left == {*names, "sources_of_truth.txt"}
    assert names == ["sources.csv", "sources.npz", "sources_fem_000.vtp", "sources_fem.pvd"]


def test_the_last_frame_is_held_against_finite_elements() -> None:
    """-10 % and +5 %; without finite elements nothing is held against anything."""
    rows = last_frame({Source.MPM: MPM, Source.FEM: FEM, Source.LEARNED: LEARNED}, SKIN)
    assert [row["source"] for row in rows] == ["mpm", "fem", "learned"]
    assert rows[0]["normal_share"] == pytest.approx(-0.1)
    assert rows[2]["normal_share"] == pytest.approx(0.05)
    assert rows[2]["displacement_rms_mm"] == pytest.approx(0.1, rel=1e-5)
    assert (rows[2]["notice"], rows[2]["note"]) == ("deep", "E doubled")
    rows = last_frame({Source.MPM: MPM, Source.LEARNED: LEARNED}, SKIN)
    assert "normal_share" not in rows[0]
    assert rows[0]["disc_mm"] == DISC_MM and rows[0]["peak_disc_N"] > 1.0
