"""The scene that is written for Mitsuba: files, places, powers, and what it cannot hold."""

from __future__ import annotations

import dataclasses
import json
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest

from sim.optics.camera.camera import pixel_directions
from sim.optics.light.lights import place_leds
from sim.optics.proof.mitsuba_scene import ply_bytes, scene_files, write_scene
from sim.optics.proof.specimen import dent, finger
from workbench.cli.command_line import main
from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera, LensModel
from workbench.core.design.design import SensorDesign
from workbench.core.design.lighting import Baking, LedRing
from workbench.core.design.optics import Coating, Transport
from workbench.core.result.results import MembraneMesh
from workbench.project.photos import shipped_photos
from workbench.report.exports.mitsuba import notice as scene_notice

RING = LedRing(count=3, radius_mm=6.0, size_mm=4.0, height_mm=0.5, tilt_deg=30.0)
TURNED = Camera(
    width_px=64, height_px=48, position_mm=(1.0, -2.0, 0.6), wxyz=(0.9938, 0.08, -0.06, 0.04)
)
MATTE = Transport(coating=Coating(specular=0.0), refractive_index=1.41, baking=Baking())


@pytest.fixture(scope="module")
def mesh() -> MembraneMesh:
    return finger(edge_mm=2.0)


def scene(folder: Path, mesh: MembraneMesh, **changes: object) -> ElementTree.Element:
    """The written XML; `camera`, `transport`, `ring` and `displacement_mm` may be given."""
    camera, transport = changes.get("camera", TURNED), changes.get("transport", MATTE)
    moved = changes.get("displacement_mm")
    leds = place_leds(changes.get("ring", RING))  # type: ignore[arg-type]
    files = scene_files(mesh, leds, camera, transport, displacement_mm=moved)  # type: ignore[arg-type]
    path = write_scene(folder, files)
    return ElementTree.fromstring(path.read_text())


def matrix(node: ElementTree.Element) -> np.ndarray:
    found = node.find("transform/matrix")
    assert found is not None
    return np.array(found.attrib["value"].split(), dtype=float).reshape(4, 4)


def read_ply(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Vertices with normals (V, 6) and faces (F, 3)."""
    head, body = path.read_bytes().split(b"end_header\n", 1)
    words = head.decode().split()
    vertices, faces = (int(words[words.index(name) + 1]) for name in ("vertex", "face"))
    rows = np.frombuffer(body, dtype="<f4", count=6 * vertices).reshape(-1, 6)
    kind = [("count", "u1"), ("corners", "<i4", (3,))]
    corners = np.frombuffer(body, dtype=kind, offset=rows.nbytes, count=faces)
    assert len(body) == rows.nbytes + corners.nbytes and (corners["count"] == 3).all()
    return rows, corners["corners"]


def test_the_files_hold_both_surfaces(tmp_path: Path, mesh: MembraneMesh) -> None:
    """Skin and wall to single precision, faces to the number."""
    root = scene(tmp_path, mesh)
    for name, skin in (("skin", mesh.seen), ("wall", mesh.cavity)):
        rows, faces = read_ply(tmp_path / f"{name}.ply")
        assert np.allclose(rows, np.hstack([skin.points_mm, skin.normals]), atol=1e-5)
        assert np.array_equal(faces, skin.faces)
    named = [node.attrib["value"] for node in root.iter("string") if "filename" in str(node.attrib)]
    assert named == ["skin.ply", "wall.ply"]


def test_a_dent_moves_the_skin_and_its_normals(tmp_path: Path, mesh: MembraneMesh) -> None:
    """Points are those of the displaced skin; normals near the dent turn."""
    moved = dent(mesh.seen, at_mm=(15.0, 0.0, 22.0), depth_mm=1.2, radius_mm=5.0)
    scene(tmp_path, mesh, displacement_mm=moved)
    rows, _ = read_ply(tmp_path / "skin.ply")
    assert np.allclose(rows[:, :3], mesh.seen.points_mm + moved, atol=1e-5)
    turned = np.einsum("ij,ij->i", rows[:, 3:], mesh.seen.normals)
    assert turned.min() < 0.99 and np.allclose(np.linalg.norm(rows[:, 3:], axis=1), 1.0, atol=1e-5)


def test_discs_have_the_place_axis_size_and_power_of_the_leds(
    tmp_path: Path, mesh: MembraneMesh
) -> None:
    """Radiance x pi x area = power in each colour; the disc's +Z is the emission axis."""
    root, leds = scene(tmp_path, mesh), place_leds(RING)
    discs = [node for node in root.iter("shape") if node.attrib["type"] == "disk"]
    assert len(discs) == 3
    for number, disc in enumerate(discs):
        pose = matrix(disc)
        assert pose[:3, 3] == pytest.approx(leds.position_mm[number], abs=1e-6)
        assert pose[:3, 2] == pytest.approx(leds.axis[number], abs=1e-6)
        assert np.linalg.norm(pose[:3, :2], axis=0) == pytest.approx([2.0, 2.0])
        assert np.linalg.det(pose[:3, :3]) == pytest.approx(4.0)
        (rgb,) = [node for node in disc.iter("rgb") if node.attrib["name"] == "radiance"]
        radiance = np.array(rgb.attrib["value"].split(","), dtype=float)
        assert np.pi * np.pi * 4.0 * radiance == pytest.approx(leds.rgb[number])


def test_the_camera_looks_where_ours_looks(tmp_path: Path, mesh: MembraneMesh) -> None:
    """Mitsuba's +Z is ahead, its +X left, its +Y up: the image's corner has the same ray."""
    (sensor,) = scene(tmp_path, mesh).iter("sensor")
    pose = matrix(sensor)
    values = {node.attrib["name"]: float(node.attrib["value"]) for node in sensor.findall("float")}
    assert pose[:3, 3] == pytest.approx(TURNED.position_mm)
    assert values["fov"] == TURNED.fov_x_deg
    right = np.tan(np.radians(values["fov"] / 2.0))
    top_right = pose[:3, :3] @ [-right, right * TURNED.height_px / TURNED.width_px, 1.0]
    ours = pixel_directions(TURNED, np.array([[TURNED.width_px, 0.0]]))[0]
    assert top_right / np.linalg.norm(top_right) == pytest.approx(ours, abs=1e-6)


def test_without_refraction_there_is_no_wall(tmp_path: Path, mesh: MembraneMesh) -> None:
    """At index 1 a dielectric does nothing, and Mitsuba refuses one; at 1.41 air is inside."""
    root = scene(tmp_path / "bent", mesh)
    (wall,) = [node for node in root.iter("bsdf") if node.attrib["type"] == "dielectric"]
    indices = {node.attrib["name"]: float(node.attrib["value"]) for node in wall}
    assert indices == {"int_ior": 1.0, "ext_ior": 1.41}
    plain = dataclasses.replace(MATTE, refractive_index=1.0)
    root = scene(tmp_path / "straight", mesh, transport=plain)
    assert not [node for node in root.iter("bsdf") if node.attrib["type"] == "dielectric"]


def test_a_glossy_coating_is_principled(tmp_path: Path, mesh: MembraneMesh) -> None:
    """GGX alpha 0.36 is the roughness 0.6; reflectance 0.04 is the specular 0.5."""
    glossy = dataclasses.replace(MATTE, coating=Coating(specular=0.04, roughness=0.36))
    root = scene(tmp_path, mesh, transport=glossy)
    (coating,) = [node for node in root.iter("bsdf") if node.attrib["type"] == "principled"]
    values = {n.attrib["name"]: float(n.attrib["value"]) for n in coating.findall("float")}
    assert values == {"roughness": pytest.approx(0.6), "specular": pytest.approx(0.5)}


@pytest.mark.parametrize(
    ("changes", "at", "says"),
    [
        (
            {"camera": dataclasses.replace(TURNED, lens=LensModel.EQUIDISTANT)},
            "optics.camera.lens",
            "equidistant",
        ),
        ({"ring": dataclasses.replace(RING, emission_exponent=3.0)}, "optics.ring", "exponent 1"),
        ({"ring": dataclasses.replace(RING, cone_deg=60.0)}, "optics.ring", "180 degrees"),
    ],
)
def test_what_mitsuba_has_no_like_of_is_refused(
    tmp_path: Path, mesh: MembraneMesh, changes: dict[str, object], at: str, says: str
) -> None:
    """The message names it, and nothing is written."""
    with pytest.raises(DesignError) as caught:
        scene(tmp_path / "out", mesh, **changes)
    assert (caught.value.at or "").startswith(at) and says in caught.value.message
    assert caught.value.hint and not (tmp_path / "out").exists()


def test_a_mesh_file_has_no_more_than_its_header_says() -> None:
    """One triangle: 3 x 24 bytes of vertices and 13 of the face."""
    data = ply_bytes(np.eye(3), np.eye(3), np.array([[0, 1, 2]]))
    assert len(data.split(b"end_header\n")[1]) == 3 * 24 + 13


def test_mitsuba_reads_the_scene(tmp_path: Path, mesh: MembraneMesh) -> None:
    """Loaded and rendered with a few samples in a process of its own: light in each colour."""
    pytest.importorskip("mitsuba")
    from workbench.proof.validation.optics.mitsuba_images import render

    scene(tmp_path, mesh, transport=dataclasses.replace(MATTE, refractive_index=1.0))
    image = render(tmp_path, samples=2, seed=1)
    assert image.shape == (TURNED.height_px, TURNED.width_px, 3)
    assert (image.mean(axis=(0, 1)) > 0.0).all() and np.isfinite(image).all()


def test_the_notice_names_what_the_scene_leaves_out() -> None:
    """Markers, ambient light, the photograph and further cameras, where the design has them."""
    plain = SensorDesign()
    assert scene_notice(plain) == ""
    photo = shipped_photos()["geltip_idle_640x480.png"]
    marked = plain.replace("optics.markers.visible", True).replace("optics.background", photo)
    assert scene_notice(marked) == (
        "the scene of Mitsuba leaves out markers and the photographed background"
    )
    assert scene_notice(plain.replace("optics.cameras", (TURNED,))).endswith("further cameras")
    assert scene_notice(plain.replace("optics.ambient.power", 0.2)).endswith("the ambient light")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("table", "told"),
    [
        ("camera]\nposition_mm = [0.0, 0.0, 90.0]", "the camera at (0, 0, 90) mm"),
        ("ring]\nradius_mm = 60.0", "LED 1 of 9 at radius 60 mm"),
    ],
)
def test_no_scene_of_an_impossible_design_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], table: str, told: str
) -> None:
    """A camera or LEDs outside the sensor: exit code 2, and no file."""
    design, out = tmp_path / "d.toml", tmp_path / "out"
    head = 'schema = 1\nname = "d"\nfamily = "finger"\n[optics]\nlight_model = "direct"\n'
    design.write_text(f"{head}[optics.{table}\n")
    words = ["export", str(design), "--mitsuba", "--out", str(out)]
    assert main([*words, "--project", str(tmp_path / "p")]) == 2
    assert told in capsys.readouterr().err
    assert not list(out.iterdir())


@pytest.mark.slow
def test_export_writes_the_scene(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`workbench export pad --mitsuba`: XML and both surfaces beside the other files."""
    out = tmp_path / "out"
    words = ["export", "pad", "--mitsuba", "--out", str(out), "--json"]
    assert main([*words, "--project", str(tmp_path / "p")]) == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    files = [row["file"] for row in rows if "file" in row]
    for name in ("scene.xml", "skin.ply", "wall.ply"):
        assert str(out / "mitsuba" / name) in files and (out / "mitsuba" / name).stat().st_size > 0
