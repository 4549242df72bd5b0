"""Light against closed forms: lenses, refraction, traced photons, the paper's planes, sensor."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

from workbench.core.base.errors import WorkbenchError
from workbench.core.design.camera import LensModel
from workbench.core.design.lighting import Baking, LedRing, LightModel
from workbench.core.design.optics import Coating, Transport
from workbench.core.result.results import MembraneMesh
from workbench.proof.row import Row, bounded, compared, failed, stated
from workbench.proof.validation.optics.light_scenes import SCENES, LightScene, lamps_of, mesh_of

if TYPE_CHECKING:
    from sim.optics.proof.plane_checks import PlaneCheck

ROUND_TRIP_LIMIT_PX = 1e-3
CLOSED_FORM_LIMIT = 1e-6
SINGLE_PRECISION = 1e-4
"""Fields are stored in float32; squared distances lose a few digits of it."""
DEPTH_LIMIT_MM = 0.02
"""Sag of a 0.5 mm facet on a radius of 15 mm is 0.002 mm; grazing rays stretch it."""
TANGENCY_LIMIT_DEG = 0.01
RADIUS_MM, CYLINDER_MM = 15.0, 27.0
ENERGY_LIMIT = 0.005
PLANE_LIMIT_DEG = {"finger": 0.2}
OTHER_PLANE_LIMIT_DEG = 0.5
"""Of the median; a plane through another normal is 0.3 degrees off on the finger, where the skin's
normal is nearly the way from the axis, and 1 to 40 on the others; a reversed field is 180 off."""
ENERGY_PHOTONS = 100_000
PLANES = tuple(LightModel(f"plane_{of}") for of in ("target", "source", "normal"))
PLANE_BODIES = ("finger", "trunk", "paw", "thumb", "pad")
FLAT_COATINGS = {
    "matte, albedo 0.9": Coating(albedo=0.9, specular=0.0),
    "default coating": Coating(),
    "glossy": Coating(albedo=0.0, specular=0.5, roughness=0.3),
}


def rows(mesh: MembraneMesh) -> list[Row]:
    """All of them; `mesh` is a finger of 15 mm radius and 27 mm cylinder."""
    return [*_lenses(), *_fields(mesh), *_photons(), *_planes(mesh), *_sensor()]


def _lenses() -> list[Row]:
    from sim.optics.proof import checks

    found = []
    for lens in LensModel:
        what = f"{lens.value}, without and with distortion" if _bends(lens) else lens.value
        found += [
            bounded(
                "projection",
                what,
                functools.partial(checks.round_trip_px, lens),
                unit="px",
                limit=ROUND_TRIP_LIMIT_PX,
            ),
            bounded(
                "field_of_view",
                what,
                functools.partial(checks.edge_angle_error_deg, lens),
                unit="deg",
                limit=1e-6,
            ),
        ]
    return [
        *found,
        bounded("snell", "0-89 degrees", checks.snell_error, unit="1", limit=CLOSED_FORM_LIMIT),
        bounded("fresnel", "0-89 degrees", checks.fresnel_error, unit="1", limit=CLOSED_FORM_LIMIT),
        bounded("optical_axis", "centred finger", checks.axis_error_px, unit="px", limit=0.5),
    ]


def _bends(lens: LensModel) -> bool:
    return lens in (LensModel.OPENCV, LensModel.OPENCV_FISHEYE)


def _fields(mesh: MembraneMesh) -> list[Row]:
    from sim.optics.proof import checks

    ring = LedRing()

    def depth_mm() -> float:
        return checks.depth_error_mm(mesh, radius_mm=RADIUS_MM, cylinder_mm=CYLINDER_MM)

    return [
        bounded(
            "plane_tangency",
            "plane_target field against the tangent plane",
            lambda: checks.tangency_error_deg(mesh, ring),
            unit="deg",
            limit=TANGENCY_LIMIT_DEG,
        ),
        bounded(
            "irradiance",
            "direct field against I cos^m / r^2",
            lambda: checks.irradiance_error(mesh, ring),
            unit="1",
            limit=SINGLE_PRECISION,
        ),
        bounded("depth_z", "cylinder and sphere", depth_mm, unit="mm", limit=DEPTH_LIMIT_MM),
    ]


def _planes(mesh: MembraneMesh) -> list[Row]:
    """The closed form of the paper's planes against curves cut out of the mesh."""
    return [row for b in PLANE_BODIES for model in PLANES for row in _plane_rows(model, b, mesh)]


def _plane_check(model: LightModel, body: str, mesh: MembraneMesh) -> PlaneCheck:
    from sim.optics.proof.plane_checks import plane_closed_form

    if body == "finger":
        return plane_closed_form(model, mesh, LedRing())
    return plane_closed_form(model, mesh_of(body), _cavity_ring(mesh_of(body)))


def _cavity_ring(mesh: MembraneMesh) -> LedRing:
    """Nine LEDs that fit into a cavity of any form."""
    import numpy as np

    inside = np.linalg.norm(mesh.cavity.points_mm[:, :2], axis=1)[mesh.cavity.points_mm[:, 2] < 2.0]
    return LedRing(radius_mm=0.7 * float(inside.min()))


def _plane_rows(model: LightModel, body: str, mesh: MembraneMesh) -> list[Row]:
    name, what = "plane_closed_form", f"{model.value}, {body}, against the cut mesh curve"
    try:
        check = _plane_check(model, body, mesh)
    except WorkbenchError as error:
        return [failed(name, what, unit="deg", why=error.message)]
    high = stated(name, f"{what}, 95th percentile", check.percentile_95_deg, unit="deg")
    what += ", median of directions; null: the straight line"
    limit = PLANE_LIMIT_DEG.get(body, OTHER_PLANE_LIMIT_DEG)
    median, null = check.median_deg, check.straight_deg
    return [bounded(name, what, median, unit="deg", limit=limit, null=null), high]


def _photons() -> list[Row]:
    """Traced light against closed forms; limits are some three standard errors of the photons."""
    from sim.optics.proof import transport_checks as checks

    found = [
        bounded(
            "energy",
            f"{scene.name} LEDs: |absorbed + left + cut off - emitted|",
            functools.partial(_energy_error, scene),
            unit="1",
            limit=ENERGY_LIMIT,
        )
        for scene in SCENES
    ]
    found.append(
        bounded(
            "furnace",
            "closed matte sphere, worst of 8 octants",
            lambda: checks.furnace_error(photons=600_000),
            unit="1",
            limit=0.01,
        )
    )
    for what, coating in FLAT_COATINGS.items():
        flat = functools.cache(functools.partial(checks.flat_furnace, coating, photons=100_000))
        found.append(
            compared(
                "flat_furnace",
                f"{what}: share of even light returned; exact: quadrature of Walter's formula",
                lambda flat=flat: flat()[0],
                lambda flat=flat: flat()[1],
                unit="1",
                limit=4e-3,
                relative=False,
            )
        )
    return [*found, *_two_patches(), *_walls(), *_tables()]


def _energy_error(scene: LightScene) -> float:
    """Share of the emitted power that is not accounted for [1]; leaks and depth count as lost."""
    from sim.optics.light.lights import place_leds
    from sim.optics.transport.gather import gather_light

    mesh = mesh_of(scene.body)
    transport = Transport(
        coating=Coating(), refractive_index=1.41, baking=Baking(photons=ENERGY_PHOTONS, nodes=500)
    )
    leds = place_leds(LedRing(count=0), lamps_of(mesh, scene.mount))
    _, _, scattered = gather_light(mesh, leds, transport)
    known = sum(scattered.balance[key] for key in ("absorbed", "base", "roulette"))
    return abs(known - 1.0)


def _two_patches() -> list[Row]:
    from sim.optics.proof import transport_checks as checks

    exchange = functools.cache(functools.partial(checks.reciprocity, photons=200_000))
    return [
        compared(
            "reciprocity",
            f"coaxial discs, {what}; exact: Howell C-41",
            lambda number=number: exchange()[number],
            lambda: exchange()[2],
            unit="mm2",
            limit=0.01,
        )
        for number, what in enumerate(("A1 F12", "A2 F21"))
    ] + [
        bounded(
            "plane_irradiance",
            f"an LED under a plane, cos^{exponent:g}: rms within 45 degrees",
            functools.partial(checks.plane_irradiance_error, exponent=exponent, photons=400_000),
            unit="1",
            limit=0.04,
        )
        for exponent in (1.0, 3.0)
    ]


def _walls() -> list[Row]:
    from sim.optics.proof import transport_checks as checks

    slab = functools.cache(functools.partial(checks.refraction_errors, photons=60_000))
    total = functools.partial(checks.total_reflection_error, photons=60_000)
    what = "photons into a slab at 0, 30, 60 and 80 degrees"
    return [
        bounded("slab", f"{what}: Fresnel", lambda: slab()[0], unit="1", limit=0.008),
        bounded("slab", f"{what}: Snell", lambda: slab()[1], unit="deg", limit=0.01),
        bounded(
            "total_reflection", "from the solid at 20, 40, 60 degrees", total, unit="1", limit=0.006
        ),
    ]


def _tables() -> list[Row]:
    from sim.optics.proof import baked_light_checks as checks

    virtual = functools.cache(functools.partial(checks.virtual_light_errors, photons=400_000))
    direct = functools.cache(functools.partial(checks.direct_table_errors, photons=600_000))
    what = "at index 1 against straight lines"
    table = "unscattered light at index 1 against direct shading"
    return [
        bounded("virtual_leds", f"{what}: irradiance", lambda: virtual()[0], unit="1", limit=0.04),
        bounded("virtual_leds", f"{what}: angle", lambda: virtual()[1], unit="deg", limit=1.5),
        bounded("direct_table", f"{table}: rms", lambda: direct()[0], unit="1", limit=0.12),
        bounded("direct_table", f"{table}: mean", lambda: direct()[1], unit="1", limit=0.004),
        *(
            bounded(
                "table_brightness",
                f"finger, {'shell' if in_shell else 'cavity'} LEDs: table at rest against photons",
                functools.partial(checks.table_error, in_shell=in_shell, photons=150_000),
                unit="1",
                limit=0.015,
            )
            for in_shell in (False, True)
        ),
    ]


def _sensor() -> list[Row]:
    from sim.optics.proof import sensor_checks as checks

    noise, blur = functools.cache(checks.noise_error), functools.cache(checks.defocus_error)
    return [
        bounded(
            "sensor_noise",
            "photon transfer curve at 0 and 12 dB; null: without read noise",
            lambda: noise()[0],
            unit="1",
            limit=0.01,
            null=noise()[1],
        ),
        bounded(
            "defocus",
            "variance of a blurred point against the disc's c^2 / 16",
            lambda: blur()[0],
            unit="1",
            limit=0.02,
        ),
        bounded("defocus", "light of a blurred point", lambda: blur()[1], unit="1", limit=1e-5),
        bounded(
            "spectrum",
            "black bodies of 2000 to 10000 K: x and y against the Planckian locus",
            lambda: checks.chromaticity_error(checks.PLANCKIAN),
            unit="1",
            limit=0.004,
        ),
        bounded(
            "spectrum",
            "single wavelengths of 460 to 625 nm: x and y against the spectral locus",
            lambda: checks.chromaticity_error(checks.SPECTRAL),
            unit="1",
            limit=0.015,
        ),
    ]
