"""Bad input to the command: exit 2, one message with value, limit and remedy, nothing lost.

Also that a good STL is as good as the primitive it was made from.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import trimesh

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("shared_results")]

PRESS = "--target 0,0,16 --depth-mm 0.5 --frames 1 --grid-mm 0.8".split()


def normal_N(folder: Path) -> float:
    """Normal force of a run."""
    return json.loads((folder / "summary.json").read_text())["contact"]["normal_N"]


@pytest.fixture(scope="module")
def stored(
    project: Path, coarse: Path, tmp_path_factory: pytest.TempPathFactory
) -> dict[str, float]:
    """Normal force [N] of the primitives, and a store with a finished result."""
    from workbench.cli.command_line import main

    forces = {}
    # The STL cube has sharp edges, so the primitive has too.
    for kind, edges in (("sphere", []), ("cube", ["--edge-radius-mm", "0"])):
        out = tmp_path_factory.mktemp(kind)
        words = ["run", coarse, "--indenter", kind, "--size-mm", "4", *edges]
        words += [*PRESS, "--out", out, "--project", project]
        assert main([str(word) for word in words]) == 0
        forces[kind] = normal_N(out)
    return forces


def write_tool(kind: str, path: Path) -> None:
    """A sphere or a cube, 4 mm wide, as trimesh writes it, away from the origin."""
    if kind == "sphere":
        tool = trimesh.creation.icosphere(subdivisions=4, radius=2.0)
    else:
        tool = trimesh.creation.box(extents=(4.0, 4.0, 4.0))
    tool.apply_translation((30.0, -10.0, 5.0))
    tool.export(path)


@pytest.mark.parametrize("kind", ["sphere", "cube"])
def test_stl_presses_like_the_primitive(
    workbench: Any, coarse: Path, stored: dict[str, float], tmp_path: Path, kind: str
) -> None:
    """The force is that of the exact shape within 5 %."""
    tool = tmp_path / "tool.stl"
    write_tool(kind, tool)
    run = workbench("run", coarse, "--indenter", tool, *PRESS, "--out", tmp_path / "out")
    assert run.code == 0
    assert run.computed() == ["object", "press", "shoot"]
    # The icosphere's facets lie within 0.005 mm of the sphere: 1 % of the depth, 1.5 % in force.
    assert normal_N(tmp_path / "out") == pytest.approx(stored[kind], rel=0.05)


def bad_stl(kind: str, path: Path) -> None:
    """Write a file that cannot be pressed."""
    if kind == "two gigabytes":
        with path.open("wb") as file:
            file.truncate(2_000_000_000)
    elif kind == "a hole":
        tool = trimesh.creation.box(extents=(4.0, 4.0, 4.0))
        tool.faces = tool.faces[1:]
        tool.export(path)
    elif kind == "no faces":
        path.write_bytes(bytes(84))
    else:
        path.write_bytes(b"\x89PNG\r\n" + bytes(200))


BAD_STL = {
    "a hole": "tool.stl is not watertight: 3 open edges",
    "no faces": "tool.stl has no faces",
    "two gigabytes": "tool.stl has 2,000 MB, more than 64 MB",
    "a picture": "tool.stl is not an STL file",
}


def expect_refusal(run: Any, text: str, at: str) -> None:
    """Exit 2; the same one message, field and hint as text and as JSON; no stage computed."""
    assert run.code == 2
    first, *rest = run.stderr.splitlines()
    assert first.startswith("error: ")
    assert text in first
    assert any(line.strip() == f"at: {at}" for line in rest)
    assert any(line.strip().startswith("hint: ") for line in rest)
    assert "Traceback" not in run.stderr
    error = run.lines[-1]
    assert error["error"] == "DesignError"
    assert error["at"] == at
    assert f"error: {error['message']}" == first


@pytest.mark.parametrize("kind", BAD_STL)
def test_bad_stl_is_refused_before_anything_runs(
    workbench: Any, coarse: Path, stored: dict[str, float], tmp_path: Path, kind: str
) -> None:
    """The file is named with what is wrong; nothing is written and nothing lost."""
    tool = tmp_path / "tool.stl"
    bad_stl(kind, tool)
    run = workbench("run", coarse, "--indenter", tool, *PRESS, "--out", tmp_path / "out")
    expect_refusal(run, BAD_STL[kind], "indenter")
    assert run.keys() == {}
    assert not (tmp_path / "out").exists()


BAD_DESIGN = {
    "wall thicker than radius": (
        ("[meshing]", "[layers]\nelastomer_mm = 9.0\n[meshing]"),
        "elastomer wall 9 mm is not thinner than the outer radius 8 mm",
        "layers.elastomer_mm",
    ),
    "wall and support fill the finger": (
        ("[meshing]", "[layers]\nelastomer_mm = 6.5\n[meshing]"),
        "together 7.5 mm leave less than 1 mm of cavity",
        "layers.elastomer_mm",
    ),
    "LED inside the wall": (
        ("radius_mm = 3.0", "radius_mm = 7.0"),
        "LED 1 of 9 at radius 7 mm",
        "optics.ring.radius_mm",
    ),
    "LED inside the elastomer": (
        ("radius_mm = 3.0", "radius_mm = 7.0"),
        "is in the elastomer wall; the cavity ends at",
        "optics.ring.radius_mm",
    ),
    "lamp outside": (
        ("[optics.ring]", "[[optics.lamps]]\nposition_mm = [20.0, 0.0, 4.0]\n[optics.ring]"),
        "lamp 1 at radius 20 mm, height 4 mm is in the space outside",
        "optics.lamps[1].position_mm",
    ),
    "no light at all": (
        ("[optics.ring]", "[optics.ring]\ncount = 0"),
        "points of light 0 is outside 1 to 512",
        "optics.ring.count",
    ),
    "no power": (
        ("[optics.ring]", "[optics.ring]\npower = 0.0"),
        "all LEDs have power 0, so the image would be black",
        "optics.ring.power",
    ),
    "unknown colour": (
        ("[optics.ring]", "[optics.ring]\ncolours = ['green']"),
        "LED colour 'green' is not of the form #rrggbb, 525nm, 525nm/35nm or 5600K",
        "optics.ring.colours",
    ),
    "camera inside the wall": (
        ("width_px", "position_mm = [7.0, 0.0, 3.0]\nwidth_px"),
        "the camera at (7, 0, 3) mm is inside the wall; the cavity ends",
        "optics.camera.position_mm",
    ),
    "camera outside the sensor": (
        ("width_px", "position_mm = [30.0, 0.0, 3.0]\nwidth_px"),
        "the camera at (30, 0, 3) mm is outside the sensor; the cavity ends",
        "optics.camera.position_mm",
    ),
    "field of view 0": (
        ("width_px", "fov_x_deg = 0.0\nwidth_px"),
        "field of view 0 degree is outside 5 to 175 degree",
        "optics.camera.fov_x_deg",
    ),
    "field of view 200": (
        ("width_px", "fov_x_deg = 200.0\nlens = 'equidistant'\nwidth_px"),
        "field of view 200 degree is outside 5 to 180 degree",
        "optics.camera.fov_x_deg",
    ),
    "distortion that folds": (
        ("width_px", "lens = 'opencv'\ndistortion = [-0.5, 0.0, 0.0, 0.0]\nwidth_px"),
        "folds the image 37 px from its centre, within the 100 px to its corner",
        "optics.camera.distortion",
    ),
    "photograph of another size": (
        (
            "[optics.ring]",
            "[optics]\nbackground = 'builtin:geltip_idle_640x480.png'\n[optics.ring]",
        ),
        "geltip_idle_640x480.png has 640 x 480 pixels, the camera 160 x 120",
        "optics.background",
    ),
    "photograph that is not there": (
        ("[optics.ring]", "[optics]\nbackground = 'idle.png'\n[optics.ring]"),
        "there is no picture file 'idle.png'",
        "optics.background",
    ),
    "camera looking away": (
        ("width_px", "wxyz = [0.0, 1.0, 0.0, 0.0]\nwidth_px"),
        "only 0.0% of the pixels see the skin, less than 1%",
        "optics.camera",
    ),
    "newer schema": (
        ("schema = 1", "schema = 2"),
        "schema 2, this program reads up to 1",
        "schema",
    ),
    "older than any": (("schema = 1", "schema = 0"), "has schema 0", "schema"),
    "misspelt field": (("hex_mm", "hexx_mm"), "hexx_mm", "meshing.hexx_mm"),
    "broken TOML": (("[shape]", "[shape"), "not valid TOML", "design"),
}


@pytest.mark.parametrize("case", BAD_DESIGN)
def test_bad_design_is_refused_with_value_and_remedy(
    workbench: Any, coarse: Path, stored: dict[str, float], tmp_path: Path, case: str
) -> None:
    """The field, the value and the limit; the good design's results are found afterwards."""
    (old, new), text, at = BAD_DESIGN[case]
    file = tmp_path / "bad.toml"
    file.write_text(coarse.read_text().replace(old, new, 1))
    words = ("--indenter", "sphere", "--size-mm", "4", *PRESS, "--out", tmp_path / "out")
    expect_refusal(workbench("run", file, *words), text, at)
    assert not list((tmp_path / "out").glob("*"))
    good = workbench("run", coarse, *words)
    assert good.code == 0
    assert good.computed() == []


def test_target_far_from_the_skin_is_refused(
    workbench: Any, coarse: Path, stored: dict[str, float], tmp_path: Path
) -> None:
    """(100, 0, 0) is 92 mm from a skin of radius 8 mm; the nearest point is (8, 0, 0)."""
    far = ["--target", "100,0,0", *PRESS[2:]]
    run = workbench("run", coarse, "--size-mm", "4", *far, "--out", tmp_path / "out")
    expect_refusal(run, "is 92.0 mm from the skin; the limit is 5 mm", "press.target_mm")
    assert "(8.0, 0.0, 0.0) mm" in run.stderr
    assert not list((tmp_path / "out").glob("*"))


def test_a_mould_larger_than_the_bed_is_told(
    workbench: Any, coarse: Path, stored: dict[str, float], tmp_path: Path
) -> None:
    """A bed of 30 mm: exit 0; red checks with ratio, limit and remedy, and on the build sheet."""
    file = tmp_path / "small_bed.toml"
    file.write_text(coarse.read_text() + "[mould]\nbed_mm = [30.0, 30.0, 30.0]\n")
    words = ("--indenter", "sphere", "--size-mm", "4", *PRESS, "--out", tmp_path / "out")
    run = workbench("run", file, *words)
    assert run.code == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    beds = {check["part"]: check for check in summary["checks"] if check["name"] == "bed"}
    half = beds["half_a"]
    # The half is as long as the body across and two ears of 17 mm: 16 / 0.998 + 34 mm.
    assert half["value"] == pytest.approx(100 * (16.0 / 0.998 + 34.0) / 30.0, rel=1e-3)
    assert half["severity"] == "bad"
    assert "share of the bed 167 %, at most 100 % is good" in half["message"]
    assert "use a larger printer" in half["message"]
    assert "share of the bed 167 %" in (tmp_path / "out" / "build_sheet.html").read_text()
