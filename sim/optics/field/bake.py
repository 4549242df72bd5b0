"""The light field: what arrives at each vertex of the undeformed skin from each point of light."""

from __future__ import annotations

from collections.abc import Sequence

from sim.optics.field.model import Baked, Lights, model_of
from sim.optics.light.lights import Leds, place_leds
from sim.optics.light.places import check_lights
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.lighting import Lamp, LedRing, LightModel
from workbench.core.design.optics import Transport
from workbench.core.result.light import LightField
from workbench.core.result.results import MembraneMesh


def bake_light(
    mesh: MembraneMesh,
    ring: LedRing,
    lamps: Sequence[Lamp] = (),
    *,
    model: LightModel,
    transport: Transport | None = None,
    monitor: Monitor = silent,
) -> LightField:
    """Light field of the ring and the lamps on the skin that the camera sees.

    Args:
        mesh: The skins; light meets the seen one from inside.
        ring: The LEDs.
        lamps: Further lights.
        model: How light travels.
        transport: What traced photons meet; for models that trace.
        monitor: Progress and cancellation.

    Raises:
        DesignError: If a light is misplaced, emits nothing, or touches the skin; or if the
            model finds no way on a damaged skin.
    """
    check_lights(mesh, ring, lamps)
    leds = place_leds(ring, lamps)
    lights = Lights(
        mesh=mesh,
        leds=leds,
        fields=_fields(ring, lamps),
        transport=transport,
    )
    found = model_of(model).bake(lights, monitor)
    monitor(1.0, "light field ready")
    return light_field(leds, model, found)


def light_field(leds: Leds, model: LightModel, found: Baked) -> LightField:
    """What arrives at the vertices, together with the points of light that it comes from."""
    return LightField(
        model=str(model),
        direction=found.direction,
        irradiance=found.irradiance,
        led_mm=leds.position_mm,
        led_axis=leds.axis,
        led_rgb=leds.rgb,
        led_exponent=leds.exponent,
        led_cone=leds.cone,
        led_size_mm=leds.size_mm,
        scattered=found.scattered,
    )


def _fields(ring: LedRing, lamps: Sequence[Lamp]) -> list[str]:
    """Field of the design that places each point of light, for messages."""
    found = ["optics.ring.radius_mm"] * ring.count
    for number, lamp in enumerate(lamps, start=1):
        found += [f"optics.lamps[{number}].position_mm"] * lamp.points
    return found
