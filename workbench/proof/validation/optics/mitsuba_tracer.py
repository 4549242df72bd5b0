"""What runs inside Mitsuba 3 for the record: the coating as a BSDF, and skin seen through the wall.

Mitsuba has Schlick's Fresnel term over GGX only in `principled`, without a base of its own, and its
path tracer shows mirror images in the wall, which the product leaves out. Both are added here, from
Mitsuba's own parts and without any of the product's code:

- `coated_ink`: rho (1 - F0) / pi + D G F / (4 cos_i cos_o), with D and Smith's G1 of Mitsuba's
  `MicrofacetDistribution`, G = 1 / (1 / G1_i + 1 / G1_o - 1), which is the height-correlated form,
  and F = F0 + (1 - F0) (1 - m . o)^5. Source: Heitz, JCGT 2014, Eq. 99; Schlick, 1994.
- `through_wall`: a camera's ray is bent where it meets the wall, keeps Fresnel's T / n^2 of what
  comes, and is then followed by Mitsuba's `path`, which meets everything, mirrors included.

It needs a variant that compiles, `llvm_ad_rgb`, so LLVM 16 or newer: where it is not found by
itself, DRJIT_LIBLLVM_PATH names the library.

    python -m workbench.proof.validation.optics.mitsuba_tracer FOLDER SAMPLES BATCHES [SEED]

renders the scene in FOLDER, in as many batches of as many samples of each pixel, to `batches.npz`:
linear RGB (batch, H, W, 3) without mirror images, and `whole`, one batch of everything.
"""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from typing import Any

import numpy as np

VARIANT = "llvm_ad_rgb"
PASS = 512
"""Samples of a pixel that are followed at once: 1.5 million paths of an image of 64 x 48."""


def open_mitsuba() -> Any:
    """Mitsuba with both plugins registered."""
    mi: Any = importlib.import_module("mitsuba")
    mi.set_variant(VARIANT)
    mi.register_bsdf("coated_ink", _ink_type(mi))
    mi.register_integrator("through_wall", _through_type(mi))
    return mi


def _ink_type(mi: Any) -> type:
    """The class of the coating; its base exists once a variant is chosen."""
    dr: Any = importlib.import_module("drjit")

    class Ink(mi.BSDF):
        """Diffuse base under a GGX lobe; directions are in the frame of the skin's normal."""

        def __init__(self, properties: Any) -> None:
            mi.BSDF.__init__(self, properties)
            self.base = float(properties["albedo"]) * (1.0 - float(properties["specular"]))
            self.facing = float(properties["specular"])
            self.width = float(properties["roughness"])
            self.m_flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            self.m_components = [self.m_flags]

        def _facets(self) -> Any:
            return mi.MicrofacetDistribution(mi.MicrofacetType.GGX, self.width, True)

        def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any) -> Any:
            facet, _ = self._facets().sample(si.wi, sample2)
            glossy = mi.reflect(si.wi, facet)
            even = mi.warp.square_to_cosine_hemisphere(sample2)
            found = mi.BSDFSample3f()
            found.wo = dr.select(sample1 < 0.5, glossy, even)
            found.eta = 1.0
            found.sampled_type = mi.UInt32(int(self.m_flags))
            found.sampled_component = mi.UInt32(0)
            value, found.pdf = self.eval_pdf(ctx, si, found.wo, active)
            good = active & (found.pdf > 0.0)
            return found, dr.select(good, value / found.pdf, 0.0)

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any) -> Any:
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any) -> Any:
            return self.eval_pdf(ctx, si, wo, active)[1]

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any) -> Any:
            cos_in, cos_out = mi.Frame3f.cos_theta(si.wi), mi.Frame3f.cos_theta(wo)
            good = active & (cos_in > 0.0) & (cos_out > 0.0)
            facets, facet = self._facets(), dr.normalize(si.wi + wo)
            smith_in, smith_out = facets.smith_g1(si.wi, facet), facets.smith_g1(wo, facet)
            shadowing = 1.0 / (1.0 / smith_in + 1.0 / smith_out - 1.0)
            fresnel = self.facing + (1.0 - self.facing) * (1.0 - dr.dot(wo, facet)) ** 5
            lobe = facets.eval(facet) * shadowing * fresnel / (4.0 * cos_in * cos_out)
            value = mi.Color3f((self.base / dr.pi + lobe) * cos_out)
            of_facet = facets.pdf(si.wi, facet) / (4.0 * dr.dot(wo, facet))
            density = 0.5 * of_facet + 0.5 * cos_out / dr.pi
            return dr.select(good, value, 0.0), dr.select(good, density, 0.0)

        def traverse(self, callback: Any) -> None:
            """Nothing is differentiated."""

    return Ink


def _through_type(mi: Any) -> type:
    """The class of the integrator."""
    dr: Any = importlib.import_module("drjit")

    class Through(mi.SamplingIntegrator):
        """Bends a camera's ray at the wall and lets `path` follow it."""

        def __init__(self, properties: Any) -> None:
            mi.SamplingIntegrator.__init__(self, properties)
            wall = {"type": "ply", "filename": str(properties["wall"])}
            self.wall = mi.load_dict({"type": "scene", "wall": wall})
            self.index = float(properties["index"])
            kind = {"type": "path", "max_depth": 64, "rr_depth": 8, "hide_emitters": True}
            self.path = mi.load_dict(kind)

        def sample(
            self, scene: Any, sampler: Any, ray: Any, medium: Any = None, active: Any = True
        ) -> Any:
            met = self.wall.ray_intersect(mi.Ray3f(ray), active)
            to_air = met.sh_frame.to_local(-ray.d)
            reflected, cos_bent, _, ratio = mi.fresnel(dr.abs(to_air.z), self.index)
            # Toward +Z of a frame whose -Z side is air: mi.refract wants the cosine's sign.
            upright = mi.Vector3f(to_air.x, to_air.y, dr.abs(to_air.z))
            bent = mi.refract(upright, cos_bent, ratio)
            side = dr.select(to_air.z > 0.0, 1.0, -1.0)
            way = met.to_world(mi.Vector3f(bent.x, bent.y, bent.z * side))
            inside = met.spawn_ray(way)
            lit = active & met.is_valid()
            light, seen, _ = self.path.sample(
                scene, sampler, mi.RayDifferential3f(inside), medium, lit
            )
            share = (1.0 - reflected) / self.index**2
            return dr.select(lit, light * share, 0.0), seen & lit, []

    return Through


def render(folder: Path, samples: int, batches: int, first: int) -> dict[str, np.ndarray]:
    """Batches of the scene in a folder, and one of everything that a path tracer shows.

    Args:
        folder: As `mitsuba_record.write_folder` leaves it.
        samples: Of each pixel in a batch.
        batches: How many.
        first: Seed of the first one; the others follow.
    """
    mi = open_mitsuba()
    scene = mi.load_file(str(folder / "scene.xml"))
    index = float((folder / "index.txt").read_text(encoding="utf-8"))
    through = scene.integrator()
    if index != 1.0:
        wall = str(folder / "wall.ply")
        through = mi.load_dict({"type": "through_wall", "wall": wall, "index": index})
    found = [_batch(mi, scene, through, samples, seed) for seed in range(first, first + batches)]
    return {
        "batches": np.stack(found),
        "whole": _batch(mi, scene, scene.integrator(), samples, first + batches),
        "samples": np.array(samples),
        "version": np.array(mi.__version__),
    }


def _batch(mi: Any, scene: Any, integrator: Any, samples: int, seed: int) -> np.ndarray:
    """Linear RGB (H, W, 3), float64, of `samples` of each pixel, a pass at a time."""
    passes = -(-samples // PASS)
    every = [
        mi.render(scene, integrator=integrator, spp=min(PASS, samples), seed=seed * 10_000 + number)
        for number in range(passes)
    ]
    return np.mean([np.array(image)[:, :, :3].astype(np.float64) for image in every], axis=0)


def main(words: list[str]) -> None:
    """Render FOLDER with SAMPLES in each of BATCHES."""
    folder, (samples, batches, *seed) = Path(words[0]), map(int, words[1:])
    found = render(folder, samples, batches, *(seed or [1]))
    np.savez(folder / "batches.npz", allow_pickle=False, **found)


if __name__ == "__main__":
    main(sys.argv[1:])
