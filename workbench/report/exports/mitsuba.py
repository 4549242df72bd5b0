"""The sensor at rest as a scene of the renderer Mitsuba 3."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from workbench.core.design.design import SensorDesign
from workbench.core.design.optics import Transport
from workbench.core.result.results import MembraneMesh
from workbench.report.export import Export


def files(design: SensorDesign, found: dict[str, Any]) -> Iterator[tuple[str, bytes]]:
    """The scene and its meshes."""
    from sim.optics.light.lights import place_leds
    from sim.optics.proof.mitsuba_scene import scene_files

    optics = design.optics
    # The scene knows the whole coating, also what traced light of ours leaves out.
    transport = Transport(
        coating=optics.coating, refractive_index=optics.refractive_index, baking=optics.baking
    )
    leds = place_leds(optics.ring, optics.lamps)
    for name, content in scene_files(found["mesh"], leds, optics.camera, transport).items():
        yield f"mitsuba/{name}", content


def notice(design: SensorDesign) -> str:
    """What of the design's optics a scene leaves out, as a sentence, or \"\"."""
    from sim.optics.light.lights import place_leds
    from sim.optics.proof.mitsuba_scene import check_scene

    optics = design.optics
    check_scene(place_leds(optics.ring, optics.lamps), optics.camera)
    held = {
        "markers": optics.markers.visible,
        "the ambient light": optics.ambient.power > 0.0,
        "the photographed background": optics.background is not None,
        "further cameras": bool(optics.cameras),
    }
    left_out = [name for name, there in held.items() if there]
    return f"the scene of Mitsuba leaves out {' and '.join(left_out)}" if left_out else ""


def fits(design: SensorDesign, mesh: MembraneMesh) -> None:
    """Refuse lights and cameras that cannot be where they are."""
    from sim.optics.light.places import check_camera, check_lights

    check_lights(mesh, design.optics.ring, design.optics.lamps)
    check_camera(mesh, design.optics.camera)


EXPORT = Export(
    place=8,
    makes=("mitsuba/*",),
    stages=("mesh",),
    files=files,
    option="mitsuba",
    help="also mitsuba/scene.xml, the sensor at rest for the renderer Mitsuba 3",
    notice=notice,
    fits=fits,
)
