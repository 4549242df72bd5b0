"""A sensor as a scene of the renderer Mitsuba 3: XML and PLY files, written without Mitsuba.

Units stay mm; powers of lights are radiant flux 1 per unit, so a disc of area A has the radiance
P / (pi A). The wall of the cavity is a smooth dielectric with air on the side its normals come
from; Mitsuba divides radiance by n^2 where it leaves the solid, the workbench leaves that constant
to the exposure. Mitsuba's camera has +X to the left and +Y up.

What Mitsuba has no like of: lobes other than Lambert's, emission cones, lens models other than the
pinhole, and Schlick's Fresnel term over GGX. Scenes with the first three are refused; a glossy
coating becomes Mitsuba's `principled` of equal roughness, which is near but not the same, so
comparisons use a matte one.
Source: Mitsuba 3 documentation, scene format and plugins `dielectric`, `diffuse`, `principled`.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from sim.optics.camera.camera import rotation_camera_to_sensor
from sim.optics.light.lights import Leds
from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera, LensModel
from workbench.core.design.optics import Transport
from workbench.core.result.results import MembraneMesh, Skin

SAMPLES = 256
"""Samples of a pixel in the written scene."""
LEAST_SIDE_MM = 1e-6


def write_scene(folder: Path, files: Mapping[str, bytes]) -> Path:
    """Write what `scene_files` gives into a folder, made if need be; returns the XML file."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        (folder / name).write_bytes(content)
    return folder / "scene.xml"


def scene_files(
    mesh: MembraneMesh,
    leds: Leds,
    camera: Camera,
    transport: Transport,
    *,
    samples: int = SAMPLES,
    displacement_mm: np.ndarray | None = None,
) -> dict[str, bytes]:
    """Content of `skin.ply`, `wall.ply` and `scene.xml`, which names the two.

    Args:
        mesh: The skins; the seen one reflects.
        leds: The lights.
        camera: A pinhole.
        transport: Coating and refractive index.
        samples: Samples of a pixel.
        displacement_mm: Of the seen skin [mm], shape (V, 3); None leaves it at rest.

    Raises:
        DesignError: If the scene has something that Mitsuba has no like of.
    """
    check_scene(leds, camera)
    skin = mesh.seen
    points, normals = skin.points_mm, skin.normals
    if displacement_mm is not None:
        from geometry.surface.surface import vertex_normals

        points = points + displacement_mm
        normals = vertex_normals(points, skin.faces)
    wall: Skin = mesh.cavity
    return {
        "skin.ply": ply_bytes(points, normals, skin.faces),
        "wall.ply": ply_bytes(wall.points_mm, wall.normals, wall.faces),
        "scene.xml": _scene_xml(leds, camera, transport, samples).encode(),
    }


def check_scene(leds: Leds, camera: Camera) -> None:
    """Refuse what Mitsuba has no like of.

    Raises:
        DesignError: Naming the lens or the lights.
    """
    if camera.lens is not LensModel.PINHOLE:
        raise DesignError(
            f"Mitsuba has no {camera.lens.value} lens",
            hint="choose lens = 'pinhole' for the export",
            at="optics.camera.lens",
        )
    if np.any(leds.exponent != 1.0) or np.any(leds.cone != 0.0):
        raise DesignError(
            "Mitsuba's discs shine as Lambert's law says, exponent 1 into 180 degrees",
            hint="set emission_exponent = 1 and cone_deg = 180 for the export",
            at="optics.ring.emission_exponent",
        )


def ply_bytes(points_mm: np.ndarray, normals: np.ndarray, faces: np.ndarray) -> bytes:
    """A binary PLY file of a mesh with vertex normals."""
    names = "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    head = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(points_mm)}\n{names}"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = np.empty(len(faces), dtype=[("count", "u1"), ("corners", "<i4", (3,))])
    rows["count"], rows["corners"] = 3, faces
    return head.encode() + np.hstack([points_mm, normals]).astype("<f4").tobytes() + rows.tobytes()


def _scene_xml(leds: Leds, camera: Camera, transport: Transport, samples: int) -> str:
    index = transport.refractive_index
    shapes = [
        f'<shape type="ply"><string name="filename" value="skin.ply"/>{_coating(transport)}</shape>'
    ]
    if index != 1.0:
        shapes.append(
            '<shape type="ply"><string name="filename" value="wall.ply"/>'
            f'<bsdf type="dielectric"><float name="int_ior" value="1.0"/>'
            f'<float name="ext_ior" value="{index:.9g}"/></bsdf></shape>'
        )
    shapes += [_disc(leds, number) for number in range(len(leds.position_mm))]
    return "\n".join(
        [
            '<scene version="3.0.0">',
            '<integrator type="path"><integer name="max_depth" value="64"/>'
            '<integer name="rr_depth" value="32"/>'
            '<boolean name="hide_emitters" value="true"/></integrator>',
            _sensor(camera, samples),
            *shapes,
            "</scene>\n",
        ]
    )


def _coating(transport: Transport) -> str:
    coating = transport.coating
    if coating.specular == 0.0:
        inner = f'<bsdf type="diffuse">{_rgb("reflectance", np.full(3, coating.albedo))}</bsdf>'
    else:
        inner = (
            f'<bsdf type="principled">{_rgb("base_color", np.full(3, coating.albedo))}'
            f'<float name="roughness" value="{np.sqrt(coating.roughness):.9g}"/>'
            f'<float name="specular" value="{min(coating.specular / 0.08, 1.0):.9g}"/></bsdf>'
        )
    return f'<bsdf type="twosided">{inner}</bsdf>'


def _disc(leds: Leds, number: int) -> str:
    """An emitting disc: Mitsuba's has radius 1, its normal along +Z."""
    axis, radius = leds.axis[number], leds.size_mm[number] / 2.0
    helper = np.array([1.0, 0.0, 0.0]) if abs(axis[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    x = np.cross(helper, axis)
    x /= np.linalg.norm(x)
    turned = np.column_stack([radius * x, radius * np.cross(axis, x), axis])
    radiance = leds.rgb[number] / (np.pi * np.pi * max(radius, LEAST_SIDE_MM) ** 2)
    return (
        f'<shape type="disk">{_pose(turned, leds.position_mm[number])}'
        f'<bsdf type="diffuse">{_rgb("reflectance", np.zeros(3))}</bsdf>'
        f'<emitter type="area">{_rgb("radiance", radiance)}</emitter></shape>'
    )


def _sensor(camera: Camera, samples: int) -> str:
    x, y, z = rotation_camera_to_sensor(camera).T
    pose = _pose(np.column_stack([-x, -y, z]), np.asarray(camera.position_mm))
    return (
        '<sensor type="perspective"><string name="fov_axis" value="x"/>'
        f'<float name="fov" value="{camera.fov_x_deg:.9g}"/>'
        f'<float name="near_clip" value="0.01"/><float name="far_clip" value="1000"/>{pose}'
        f'<film type="hdrfilm"><integer name="width" value="{camera.width_px}"/>'
        f'<integer name="height" value="{camera.height_px}"/>'
        '<string name="component_format" value="float32"/><rfilter type="box"/></film>'
        f'<sampler type="independent"><integer name="sample_count" value="{samples}"/></sampler>'
        "</sensor>"
    )


def _pose(columns: np.ndarray, place: np.ndarray) -> str:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = columns, place
    text = " ".join(f"{value:.9g}" for value in matrix.ravel())
    return f'<transform name="to_world"><matrix value={quoteattr(text)}/></transform>'


def _rgb(name: str, values: np.ndarray) -> str:
    text = ", ".join(f"{value:.9g}" for value in values)
    return f"<rgb name={quoteattr(name)} value={quoteattr(text)}/>"
