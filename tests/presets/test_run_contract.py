"""What `workbench run` promises to other tools, on a finger coarse enough to take seconds."""

from __future__ import annotations

import errno
import json
import os
import re
import zipfile
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import trimesh

from geometry.surface.surface import mesh_volume
from ui.desk.session import Session
from workbench.cli.command_line import main
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import ContactSettings, Press
from workbench.project.project import Project

pytestmark = pytest.mark.slow

OPTIONS = (
    "--indenter sphere --size-mm 4 --target 0,0,16 --depth-mm 0.5 --frames 2 --shear-mm 0.2,0 "
    "--grid-mm 0.8"
).split()
FRAMES = 4
"""Two of the approach, two of the shear."""
STAGES = ["build", "mesh", "lattice", "bake", "press", "shoot"]
STAGES += ["mould", "housing", "recipe", "package", "picture"]


@pytest.fixture(scope="module")
def out(project: Path, coarse: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the first, cold run."""
    folder = tmp_path_factory.mktemp("run") / "out"
    words = ["run", coarse, *OPTIONS, "--out", folder, "--project", project, "--json"]
    assert main([str(word) for word in words]) == 0
    return folder


@pytest.fixture(scope="module")
def summary(out: Path) -> dict[str, Any]:
    return json.loads((out / "summary.json").read_text())


@pytest.fixture(scope="module")
def arrays(out: Path) -> dict[str, np.ndarray]:
    with np.load(out / "contact.npz") as file:
        return dict(file)


def test_maps_are_in_file_summary_and_score_card(out: Path, summary: dict[str, Any]) -> None:
    """Every map of the summary is an array over the seen skin, and its score is a metric."""
    with np.load(out / "maps.npz") as file:
        maps = dict(file)
    names = [row["name"] for row in summary["maps"]]
    assert {"visible", "mm_per_pixel", "resolvability", "sensitivity_force", "glare"} <= {*names}
    assert all(maps[name].shape == (len(maps["surface_points_mm"]),) for name in names)
    assert summary["metrics"]["skin_seen_percent"] == pytest.approx(
        summary["maps"][0]["score"]["value"]
    )


def test_summary_has_every_key_with_its_type(summary: dict[str, Any]) -> None:
    """schema 1, design coarse, family finger, numbers as numbers, all stages in order."""
    assert summary["schema"] == 1
    assert summary["design"] == "coarse"
    assert summary["family"] == "finger"
    assert summary["device"] in ("cpu", "cuda")
    assert [row["stage"] for row in summary["stages"]] in (STAGES, STAGES[:-1])
    for row in summary["stages"]:
        assert re.fullmatch("[0-9a-f]{32}", row["key"])
        assert row["cached"] is False
        assert isinstance(row["seconds"], float)
        assert row["seconds"] > 0.0
    assert isinstance(summary["metrics"], dict)
    assert all(isinstance(value, float) for value in summary["metrics"].values())


def test_summary_of_the_contact_is_that_of_the_press(summary: dict[str, Any]) -> None:
    """Counts are positive integers, the grid is the one asked for, the press has settled."""
    contact = summary["contact"]
    assert [type(x) for x in contact["reaction_N"]] == [float] * 3
    for name in ("normal_N", "residual", "penetration_mm", "grid_mm", "seconds"):
        assert isinstance(contact[name], float)
    for name in ("particles", "substeps"):
        assert isinstance(contact[name], int)
        assert contact[name] > 0
    assert contact["grid_mm"] == 0.8
    assert 0.0 < contact["residual"] <= ContactSettings().tolerance
    # A penalty of 100 E / grid keeps a press of half a millimetre within a few hundredths of it.
    assert 0.0 < contact["penetration_mm"] < 0.05 * 0.5


def test_forces_act_on_the_indenter_in_the_sensor_frame(
    summary: dict[str, Any], arrays: dict[str, np.ndarray]
) -> None:
    """On the tip the outward normal is +Z and U is +X: the skin pushes up and against the shear."""
    contact = summary["contact"]
    assert contact["normal_N"] > 0.0
    # The mesh's normal at the apex is +Z to about 1e-4; the tangential force enters by that.
    assert contact["normal_N"] == pytest.approx(contact["reaction_N"][2], rel=1e-3)
    assert contact["reaction_N"][0] < 0.0
    np.testing.assert_allclose(contact["reaction_N"], arrays["reaction_N"][-1], rtol=1e-12)
    # Nothing pushes sideways before the shear: symmetric to the settling tolerance.
    straight = arrays["reaction_N"][1]
    assert np.abs(straight[:2]).max() < 1e-3 * straight[2]


def test_images_are_readable_and_of_the_camera_size(out: Path, summary: dict[str, Any]) -> None:
    """background.png, then one frame each, 120 x 160 x 3, and the press changes the image."""
    import cv2

    names = ["background.png", *(f"frame_{k:03d}.png" for k in range(FRAMES))]
    assert summary["images"] == names
    images = [cv2.imread(str(out / name)) for name in names]
    for image in images:
        assert image is not None
        assert image.shape == (120, 160, 3)
    changes = [np.abs(image.astype(int) - images[0]).sum() for image in images[1:]]
    assert 0 < changes[0] < changes[1]


def test_arrays_have_the_documented_shapes(arrays: dict[str, np.ndarray]) -> None:
    """(V,3), (F,3), (K,V,3), (K,3), (K,7) with K = 4; faces name vertices."""
    vertices = len(arrays["surface_points_mm"])
    assert arrays["surface_points_mm"].shape == (vertices, 3)
    assert arrays["surface_faces"].shape[1:] == (3,)
    assert arrays["surface_faces"].max() == vertices - 1
    assert arrays["displacement_mm"].shape == (FRAMES, vertices, 3)
    assert arrays["reaction_N"].shape == (FRAMES, 3)
    assert arrays["indenter_pose"].shape == (FRAMES, 7)
    assert all(np.isfinite(array).all() for array in arrays.values())


def test_poses_follow_the_path(arrays: dict[str, np.ndarray]) -> None:
    """Depth 0.25, 0.5, then 0.1 and 0.2 mm along +X at full depth; unit quaternions."""
    pose = arrays["indenter_pose"]
    np.testing.assert_allclose(np.linalg.norm(pose[:, 3:], axis=1), 1.0, rtol=1e-12)
    # The faceted tip of 0.8 mm triangles lies up to edge^2 / 8R = 0.01 mm below z = 16; the sphere
    # of radius 2 mm touches there first.
    touch_z_mm = pose[0, 2] + 0.25
    assert touch_z_mm == pytest.approx(16.0 + 2.0, abs=0.01)
    # Frame 0 of K = 2 is half of the full depth; the normal is +Z to 1e-4 of a 0.5 mm path.
    depth_mm = touch_z_mm - pose[:, 2]
    np.testing.assert_allclose(depth_mm, [0.25, 0.5, 0.5, 0.5], atol=1e-4)
    np.testing.assert_allclose(pose[:, 0] - pose[0, 0], [0.0, 0.0, 0.1, 0.2], atol=1e-4)
    np.testing.assert_allclose(pose[:, 1] - pose[0, 1], 0.0, atol=1e-4)


def test_skin_follows_the_indenter(arrays: dict[str, np.ndarray]) -> None:
    """At full depth the apex has moved in by the depth less the penetration."""
    apex = int(np.argmax(arrays["surface_points_mm"][:, 2]))
    moved_mm = -arrays["displacement_mm"][1, apex, 2]
    # The B-spline of the 0.8 mm grid smooths the dent of a 2 mm sphere by about a tenth.
    assert moved_mm == pytest.approx(0.5, rel=0.12)


def test_moulds_reload_watertight_with_the_stated_volume(
    out: Path, summary: dict[str, Any]
) -> None:
    """Every STL is one closed body of the listed volume; its STEP has that volume exactly."""
    from build123d import import_step

    assert len(summary["moulds"]) >= 3
    listed = {row["file"] for row in summary["moulds"]}
    assert listed == {f"moulds/{path.name}" for path in (out / "moulds").glob("*.stl")}
    for row in summary["moulds"]:
        part = trimesh.load_mesh(out / row["file"])
        assert row["watertight"] is True
        assert part.is_watertight
        assert part.body_count == 1
        # The listed volume is that of the curved body. Chords of the facets lie within 0.02 mm of
        # it, on curved faces of opposite sense: 2e-4 of the volume measured, 1e-3 allowed.
        assert part.volume == pytest.approx(row["volume_mm3"], rel=1e-3)
        body = import_step((out / row["file"]).with_suffix(".step"))
        # STEP holds 15 digits; only the kernel's integration remains.
        assert body.volume == pytest.approx(row["volume_mm3"], rel=1e-6)


def test_report_needs_nothing_from_outside(out: Path) -> None:
    """No src, href, url() or import leads to another file or machine."""
    text = (out / "report.html").read_text()
    assert "coarse" in text
    assert "elastomer C10 [MPa]" in text
    links = re.findall(r"(?:src|href)\s*=\s*[\"']?([^\"'\s>]*)|url\(([^)]*)\)", text)
    assert all((a or b).startswith(("data:", "#")) for a, b in links)
    assert "@import" not in text
    assert text.count("data:image/png;base64,") >= 2


def test_second_run_finds_everything(
    workbench: Any, coarse: Path, out: Path, summary: dict[str, Any], tmp_path: Path
) -> None:
    """All stages cached, keys and files identical."""
    again = workbench("run", coarse, *OPTIONS, "--out", tmp_path)
    assert again.code == 0
    assert again.computed() == []
    assert again.keys() == {row["stage"]: row["key"] for row in summary["stages"]}
    assert (tmp_path / "contact.npz").exists()
    for name in summary["images"]:
        assert (tmp_path / name).read_bytes() == (out / name).read_bytes()
    second = json.loads((tmp_path / "summary.json").read_text())
    assert all(row["cached"] for row in second["stages"])
    assert second["contact"] == summary["contact"]


def test_only_the_image_depends_on_the_camera(
    workbench: Any, coarse: Path, summary: dict[str, Any], tmp_path: Path
) -> None:
    """Another field of view re-runs `shoot` and nothing else."""
    wider = tmp_path / "wider.toml"
    wider.write_text(coarse.read_text() + "fov_x_deg = 120.0\n")
    run = workbench("run", wider, *OPTIONS, "--out", tmp_path / "out")
    assert run.code == 0
    assert run.computed() == ["shoot"]
    before = {row["stage"]: row["key"] for row in summary["stages"]}
    assert {stage for stage, key in run.keys().items() if key != before[stage]} == {"shoot"}


def test_browser_and_command_line_have_the_same_keys(
    project: Path, coarse: Path, summary: dict[str, Any]
) -> None:
    """The session's calls for this design and press are the stored results of the run."""
    session = Session(Project(project))
    session.open(str(coarse))
    session.replace_indenter(Indenter(size_mm=4.0))
    path = Press(target_mm=(0.0, 0.0, 16.0), depth_mm=0.5, frames=2, shear_mm=(0.2, 0.0))
    for name in ("target_mm", "depth_mm", "frames", "shear_mm"):
        session.change(f"case.press.{name}", getattr(path, name))
    session.change("case.settings.grid_mm", 0.8)
    calls = session.calls()
    for row in summary["stages"]:
        assert calls[row["stage"]].key == row["key"]
        assert session.fresh()[row["stage"]]


@pytest.mark.usefixtures("out")
def test_export_writes_the_same_mould_without_a_press(
    workbench: Any, coarse: Path, out: Path, tmp_path: Path
) -> None:
    """Every file named on stdout exists; the mould equals that of the run, from the store."""
    done = workbench("export", coarse, "--out", tmp_path)
    assert done.code == 0
    assert done.computed() == []
    files = [Path(line["file"]) for line in done.lines if "file" in line]
    names = {str(path.relative_to(tmp_path)) for path in files}
    assert names == {str(p.relative_to(tmp_path)) for p in tmp_path.rglob("*") if p.is_file()}
    wanted = {"design.toml", "membrane.stl", "support.stl", "base.stl", "mesh.npz"}
    assert wanted <= names
    for path in (out / "moulds").iterdir():
        assert (tmp_path / "moulds" / path.name).read_bytes() == path.read_bytes()
    for name in ("membrane", "support", "base"):
        assert trimesh.load_mesh(tmp_path / f"{name}.stl").is_watertight


def test_export_says_what_cannot_be_made(workbench: Any, coarse: Path, tmp_path: Path) -> None:
    """The last JSON line has checks and parts, each STEP file read back; a good finger exits 0."""
    done = workbench("export", coarse, "--out", tmp_path / "good")
    assert done.code == 0
    last = done.lines[-1]
    keys = "name part value unit limit sense severity place_mm message".split()
    assert all(sorted(check) == sorted(keys) for check in last["checks"])
    assert {"demoulding", "part_removal", "core_removal", "led_clearance", "minimum_wall"} <= {
        check["name"] for check in last["checks"]
    }
    assert {check["severity"] for check in last["checks"]} <= {"good", "warning"}
    files = {str(p.relative_to(tmp_path / "good")) for p in (tmp_path / "good").rglob("*.stl")}
    assert {row["file"] for row in last["parts"]} == files - {
        *("membrane.stl", "support.stl", "base.stl")
    }
    for row in last["parts"]:
        assert sorted(row) == ["file", "step_volume_mm3", "volume_mm3", "watertight"]
        assert row["watertight"] is True
        mesh = trimesh.load_mesh(tmp_path / "good" / row["file"])
        assert mesh.volume == pytest.approx(row["volume_mm3"], rel=1e-5)
        assert row["step_volume_mm3"] == pytest.approx(row["volume_mm3"], rel=1e-2)
    rows = json.loads((tmp_path / "good" / "recipe.json").read_text())
    assert [sorted(row) for row in rows] == [["direction", "distance_mm", "part", "step"]] * 3


def test_export_of_leds_outside_their_cavity_is_red(
    workbench: Any, coarse: Path, tmp_path: Path
) -> None:
    """LEDs at 5.6 mm in a cavity of 5 mm: every file is written, red comes first, exit 1."""
    file = tmp_path / "outside.toml"
    file.write_text(coarse.read_text().replace("radius_mm = 3.0", "radius_mm = 5.6"))
    done = workbench("export", file, "--out", tmp_path / "out")
    assert done.code == 1
    first = done.lines[-1]["checks"][0]
    assert (first["name"], first["severity"]) == ("led_clearance", "bad")
    assert first["value"] < 0.0
    assert "red   led_clearance: led_ring_holder" in done.stderr
    assert (tmp_path / "out" / "parts" / "led_ring_holder.stl").exists()


@pytest.mark.usefixtures("out")
def test_run_is_strict_when_asked(workbench: Any, coarse: Path, tmp_path: Path) -> None:
    """A mould larger than the printer: said on stderr, exit 0, and 1 with --strict."""
    file = tmp_path / "large.toml"
    file.write_text(coarse.read_text() + "[mould]\nbed_mm = [30.0, 30.0, 30.0]\n")
    for words, code in (([], 0), (["--strict"], 1)):
        done = workbench("run", file, *OPTIONS, "--out", tmp_path / "out", *words)
        assert done.code == code
        assert "red   bed: half_a" in done.stderr
    rows = json.loads((tmp_path / "out" / "summary.json").read_text())["checks"]
    assert rows[0]["severity"] == "bad"


def volumes_3mf(path: Path) -> dict[str, float]:
    """Volume of every object of a 3MF file by its name [mm3]."""
    text = zipfile.ZipFile(path).read("3D/3dmodel.model")
    found = {}
    for item in ElementTree.fromstring(text).iterfind(".//{*}object"):
        points = [[float(v.attrib[axis]) for axis in "xyz"] for v in item.iterfind(".//{*}vertex")]
        faces = [
            [int(t.attrib[f"v{k}"]) for k in (1, 2, 3)] for t in item.iterfind(".//{*}triangle")
        ]
        found[item.attrib["name"]] = mesh_volume(np.array(points), np.array(faces))
    return found


def test_one_name_is_one_body(workbench: Any, coarse: Path, tmp_path: Path) -> None:
    """Files of one stem hold the same body, as triangles, exact faces and 3MF; names within
    assemblies are those of the files."""
    from build123d import import_step

    assert workbench("export", coarse, "--out", tmp_path).code == 0
    volumes: dict[str, list[float]] = {}
    for path in tmp_path.rglob("*.stl"):
        volumes.setdefault(path.stem, []).append(trimesh.load_mesh(path).volume)
    for path in tmp_path.rglob("*.3mf"):
        for name, volume_mm3 in volumes_3mf(path).items():
            volumes.setdefault(name, []).append(volume_mm3)
    for path in tmp_path.rglob("*.step"):
        read = import_step(str(path))
        children = list(read.children) or [read]
        for child in children:
            volumes.setdefault(child.label, []).append(child.volume)
    assert {"base", "housing_base", "support", "half_a", "core"} <= set(volumes)
    assert len(volumes["housing_base"]) == 5
    for name, found in volumes.items():
        # Chords of 0.05 mm cost the support of so small a finger 0.6 %.
        assert found == pytest.approx([found[0]] * len(found), rel=1e-2), name


def test_full_disk_exits_3_and_keeps_finished_results(
    workbench: Any,
    coarse: Path,
    summary: dict[str, Any],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """One message with what to do; no part of a file stays; the next run finds every stage."""

    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    old = tmp_path / "summary.json"
    old.write_text("old")
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        failed = workbench("run", coarse, *OPTIONS, "--out", tmp_path)
    assert failed.code == 3
    assert failed.lines[-1]["error"] == "StoreError"
    assert "No space left on device" in failed.stderr.splitlines()[0]
    assert "free some space" in failed.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["summary.json"]
    assert old.read_text() == "old"
    again = workbench("run", coarse, *OPTIONS, "--out", tmp_path)
    assert again.code == 0
    assert again.computed() == []


def test_full_disk_during_a_stage_keeps_the_stages_before(
    workbench: Any,
    coarse: Path,
    project: Path,
    summary: dict[str, Any],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """`shoot` cannot be stored: exit 3, no half-written folder, the press stays cached."""

    def full(path: Path, write: Any) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    wider = tmp_path / "wider.toml"
    wider.write_text(coarse.read_text() + "fov_x_deg = 90.0\n")
    with monkeypatch.context() as patch:
        patch.setattr("workbench.pipeline.store.write_file", full)
        failed = workbench("run", wider, *OPTIONS, "--out", tmp_path / "out")
    assert failed.code == 3
    assert "is full" in failed.stderr.splitlines()[0]
    assert "--project" in failed.stderr
    assert not list((project / "store").glob("*/.part-*"))
    again = workbench("run", wider, *OPTIONS, "--out", tmp_path / "out")
    assert again.code == 0
    assert again.computed() == ["shoot"]
