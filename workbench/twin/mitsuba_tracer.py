"""What runs inside Mitsuba 3 for a twin's photograph: its light, and then what the camera sees.

Light: photons of the LEDs are followed by Mitsuba's intersections and BSDFs, through the wall, off
its both sides and off the coating, until they leave. Where one meets the skin it sends f(wi, wo)
toward the camera; divided among the three vertices about its place and by their areas that is
radiance. Source: Walter et al., Global illumination using local linear density estimation, 1997.
The coating is another one than the product's: flakes of aluminium whose slopes follow Beckmann's
distribution (`roughconductor`) in a matte binder (`diffuse`), one beside the other (`blendbsdf`).

Camera: the skin then shines with that radiance, and LEDs with their own. A ray is split where it
first meets the wall; both parts are followed by Mitsuba's `path`, so that the wall mirrors skin and
LEDs as often as they are worth it.

LEDs in air are discs that shine to one side, by Lambert's law, and hide what is behind them. Left
out: mirror images take the skin's radiance toward the camera for that toward the wall; LEDs stand
in no photon's way; the shading normal's share of a photon that goes on.

It needs a variant that compiles, `llvm_ad_rgb`, so LLVM 16 or newer: where it is not found by
itself, DRJIT_LIBLLVM_PATH names the library.

    python -m workbench.twin.mitsuba_tracer FOLDER

reads what `mitsuba_scene` wrote to FOLDER, says how far it is, line by line, and leaves
`seen.npz`: `radiance` of the skin (V, 3), `image` (H, W, 3). Without FOLDER it only tries whether
Mitsuba can compile.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from workbench.twin.mitsuba_scene import ARRAYS, DISCS, SEEN, SKIN, WALL

VARIANT = "llvm_ad_rgb"
BATCH = 2**20
"""Photons that are followed at once."""
MOST_EVENTS, ROULETTE_AFTER = 64, 8
"""Of a photon."""
LEAST_COSINE = 0.02
"""Of the skin's normal to the camera; below it a place is not seen."""
SPLIT_SAMPLES = 32
"""Of a pixel: its ray is split at the wall, so that they only smooth edges."""
RADIANCE = "vertex_radiance"


class Tracer:
    """One scene."""

    def __init__(self, folder: Path) -> None:
        """Open Mitsuba and read the scene."""
        self.mi, self.dr = open_mitsuba()
        self.folder = folder
        with np.load(folder / ARRAYS) as held:
            self.told: Mapping[str, np.ndarray] = {name: held[name] for name in held.files}
        self.index = float(self.told["index"])

    def light(self) -> np.ndarray:
        """Radiance of the skin's vertices toward the camera in the solid's measure, (V, 3)."""
        scene = self._scene({"bsdf": self._coating()})
        lights, photons = len(self.told["position_mm"]), int(self.told["photons"])
        each = -(-min(photons, BATCH) // lights) * lights
        batches = -(-photons // each)
        found = np.zeros((len(self.told["to_camera"]), 3))
        for number in range(batches):
            print(0.8 * number / batches, flush=True)
            found += self._batch(scene, each, int(self.told["seed"]) + number)
        area = self.told["vertex_mm2"][:, None]
        return found * lights / (batches * each) / np.maximum(area, 1e-9)

    def image(self, radiance: np.ndarray) -> np.ndarray:
        """What the camera sees of a skin of that radiance, in the solid's measure, (H, W, 3)."""
        print(0.8, flush=True)
        mi = self.mi
        shining = {"type": "area", "radiance": {"type": "mesh_attribute", "name": RADIANCE}}
        black = {"type": "diffuse", "reflectance": _rgb(np.zeros(3))}
        shapes: dict[str, Any] = {}
        if len(self.told["disc_radiance"]):
            shapes["discs"] = {
                "type": "ply",
                "filename": str(self.folder / DISCS),
                "bsdf": black,
                "emitter": shining,
            }
        scene = self._scene({"bsdf": black, "emitter": shining}, shapes)
        values = {"skin": radiance, "discs": self.told["disc_radiance"]}
        for shape in scene.shapes():
            if shape.id() in values:
                flat = mi.Float(values[shape.id()].astype(np.float32).ravel())
                shape.add_attribute(RADIANCE, 3, flat)
        integrator = _split_type(mi, self.dr)(scene, self.index)
        seed = int(self.told["seed"])
        sensor = mi.load_dict(self._sensor())
        shown = mi.render(scene, sensor=sensor, integrator=integrator, spp=SPLIT_SAMPLES, seed=seed)
        return np.array(shown)[:, :, :3] * self.index**2

    def _scene(self, skin: dict[str, Any], others: Mapping[str, Any] | None = None) -> Any:
        told: dict[str, Any] = {
            "type": "scene",
            "skin": {"type": "ply", "filename": str(self.folder / SKIN), **skin},
            **(others or {}),
        }
        if self.index != 1.0:
            clear = {"type": "dielectric", "int_ior": 1.0, "ext_ior": self.index}
            told["wall"] = {"type": "ply", "filename": str(self.folder / WALL), "bsdf": clear}
        return self.mi.load_dict(told)

    def _coating(self) -> dict[str, Any]:
        matte, share, roughness = (float(value) for value in self.told["coating"])
        binder = {"type": "diffuse", "reflectance": _rgb(np.full(3, matte))}
        if share == 0.0:
            return binder
        flakes = {
            "type": "roughconductor",
            "material": "Al",
            "distribution": "beckmann",
            "alpha": roughness,
        }
        return {"type": "blendbsdf", "weight": share, "binder": binder, "flakes": flakes}

    def _batch(self, scene: Any, count: int, seed: int) -> np.ndarray:
        """Flux toward the camera per solid angle and vertex of one batch, (V, 3)."""
        mi, dr = self.mi, self.dr
        skin = next(shape for shape in scene.shapes() if shape.id() == "skin")
        target = mi.ShapePtr(skin)
        faces = mi.UInt(self.told["faces"].astype(np.uint32).ravel())
        to_camera = mi.Float(self.told["to_camera"].astype(np.float32).ravel())
        tally = dr.zeros(mi.Float, 3 * len(self.told["to_camera"]))
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(seed, count)
        origin, direction, power = self._emitted(sampler, count)
        context = mi.BSDFContext(mi.TransportMode.Importance)

        def step(at: Any, way: Any, flux: Any, events: Any, flying: Any) -> Any:
            ray = mi.Ray3f(at, way)
            met = scene.ray_intersect_preliminary(ray, active=flying)
            si = met.compute_surface_interaction(ray, mi.RayFlags.All, flying)
            flying &= si.is_valid()
            bsdf = si.bsdf()
            on_skin = flying & (si.shape == target)
            corner = [dr.gather(mi.UInt, faces, 3 * si.prim_index + k, on_skin) for k in range(3)]
            second, third = met.prim_uv.x, met.prim_uv.y
            weights = (1.0 - second - third, second, third)
            toward = sum(
                dr.gather(mi.Vector3f, to_camera, corner[k], on_skin) * weights[k] for k in range(3)
            )
            outward = si.to_local(dr.normalize(toward))
            cosine = mi.Frame3f.cos_theta(outward)
            seen = on_skin & (cosine > LEAST_COSINE)
            sent = bsdf.eval(context, si, outward, seen).x / dr.maximum(cosine, LEAST_COSINE)
            for k in range(3):
                for colour in range(3):
                    given = flux * sent * weights[k] * power[colour]
                    dr.scatter_reduce(dr.ReduceOp.Add, tally, given, 3 * corner[k] + colour, seen)
            sample, share = bsdf.sample(
                context, si, sampler.next_1d(flying), sampler.next_2d(flying), flying
            )
            flux = flux * share.x
            onward = si.spawn_ray(si.to_world(sample.wo))
            events += 1
            kept = dr.select(events > ROULETTE_AFTER, dr.minimum(share.x, 0.95), 1.0)
            flying &= (flux > 0.0) & (events < MOST_EVENTS) & (sampler.next_1d(flying) < kept)
            return onward.o, onward.d, flux / dr.maximum(kept, 1e-6), events, flying

        state = (origin, direction, mi.Float(1.0), mi.UInt(0), mi.Bool(True))
        dr.while_loop(
            state=(*state, sampler),
            cond=lambda at, way, flux, events, flying, _: flying,
            body=lambda at, way, flux, events, flying, drawn: (
                *step(at, way, flux, events, flying),
                drawn,
            ),
        )
        return np.array(tally, dtype=np.float64).reshape(-1, 3)

    def _emitted(self, sampler: Any, count: int) -> tuple[Any, Any, Any]:
        """Origins, directions and powers of photons, equal numbers from each light."""
        mi, dr, told = self.mi, self.dr, self.told
        light = dr.arange(mi.UInt, count) % len(told["position_mm"])

        def of_light(name: str) -> Any:
            flat = mi.Float(told[name].astype(np.float32).ravel())
            return dr.gather(mi.Vector3f, flat, light)

        exponent, cone, radius_mm = of_light("emission")
        x_axis = of_light("axis")
        frame = mi.Frame3f(x_axis)
        disc = mi.warp.square_to_uniform_disk_concentric(sampler.next_2d()) * radius_mm
        place = of_light("position_mm") + frame.to_world(mi.Vector3f(disc.x, disc.y, 0.0))
        u = sampler.next_2d()
        dimmest = dr.power(cone, exponent + 1.0)
        cosine = dr.power(1.0 - u.x * (1.0 - dimmest), 1.0 / (exponent + 1.0))
        sine = dr.sqrt(dr.select(cosine < 1.0, 1.0 - cosine * cosine, 0.0))
        turn = 2.0 * dr.pi * u.y
        local = mi.Vector3f(sine * dr.cos(turn), sine * dr.sin(turn), cosine)
        return mi.Point3f(place), frame.to_world(local), of_light("power")

    def _sensor(self) -> dict[str, Any]:
        width, height = (int(value) for value in self.told["size_px"])
        return {
            "type": "perspective",
            "fov_axis": "x",
            "fov": float(self.told["fov_x_deg"]),
            "near_clip": 0.01,
            "far_clip": 1000.0,
            "to_world": self.mi.ScalarTransform4f(self.told["camera"]),
            "film": {
                "type": "hdrfilm",
                "width": width,
                "height": height,
                "component_format": "float32",
                "pixel_format": "rgb",
                "rfilter": {"type": "box"},
            },
            "sampler": {"type": "independent"},
        }


def _split_type(mi: Any, dr: Any) -> type:
    """The class of the integrator; its base exists once a variant is chosen."""

    class Split(mi.SamplingIntegrator):
        """Follows both parts of a camera's ray at the wall."""

        def __init__(self, scene: Any, index: float) -> None:
            mi.SamplingIntegrator.__init__(self, mi.Properties())
            walls = [shape for shape in scene.shapes() if shape.id() == "wall"]
            self.wall = mi.ShapePtr(walls[0]) if walls else None
            self.index = index
            self.path = mi.load_dict({"type": "path", "max_depth": 16, "rr_depth": 16})

        def sample(
            self, scene: Any, sampler: Any, ray: Any, medium: Any = None, active: Any = True
        ) -> Any:
            plain = mi.RayDifferential3f(ray)
            if self.wall is None:
                return self.path.sample(scene, sampler, plain, medium, active)
            met = scene.ray_intersect(mi.Ray3f(ray), active)
            at_wall = active & met.is_valid() & (met.shape == self.wall)
            light, _, _ = self.path.sample(scene, sampler, plain, medium, active & ~at_wall)
            mirrored, cosine, _, ratio = mi.fresnel(met.wi.z, 1.0 / self.index)
            ways = (
                (mi.refract(met.wi, cosine, ratio), (1.0 - mirrored) / self.index**2),
                (mi.reflect(met.wi), mirrored),
            )
            for way, share in ways:
                onward = mi.RayDifferential3f(met.spawn_ray(met.to_world(way)))
                part, _, _ = self.path.sample(scene, sampler, onward, medium, at_wall)
                light = light + dr.select(at_wall, share * part, 0.0)
            return light, mi.Bool(active), []

    return Split


def _rgb(values: np.ndarray) -> dict[str, Any]:
    return {"type": "rgb", "value": [float(value) for value in values]}


def open_mitsuba() -> tuple[Any, Any]:
    """Mitsuba in its variant, and the compiler under it."""
    mi: Any = importlib.import_module("mitsuba")
    mi.set_variant(VARIANT)
    return mi, importlib.import_module("drjit")


def try_mitsuba() -> None:
    """Compile something: an LLVM that is too old ends the process there."""
    mi, dr = open_mitsuba()
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(0, BATCH)
    dr.eval(dr.maximum(sampler.next_1d(), 0.5))


def main(words: list[str]) -> None:
    """Photograph the scene in FOLDER, or try Mitsuba where there is none."""
    if not words:
        try_mitsuba()
        return
    folder = Path(words[0])
    tracer = Tracer(folder)
    radiance = tracer.light()
    seen = tracer.image(radiance + tracer.told["ambient"])
    np.savez(folder / SEEN, allow_pickle=False, radiance=radiance, image=seen)
    print(1.0, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
