"""Every light model against photons: dents in finger, trunk and paw, and the image at rest.

For each scene, dent and model two rows named by the model: SSIM and PSNR in the contact box, beside
the null (the background) and the ceiling (half of the photons against the other half). `hybrid` and
`table` are baked with three seeds, and the worst counts. On the finger one scalar gain per scene is
fitted on the sphere, the other dents are held out; on trunk and paw the physical models get none.
Whether that gain is near 1 is asked of pairs of seeds, as noise of one bake would count as gain.
Asked is what the project set itself: on the finger `hybrid` at most 0.012 below the ceiling and 38
dB, `table` 0.02 below; on trunk and paw `hybrid` 0.98 and 36 dB; both better than the null. On the
narrow lobe of ink `hybrid` shall reach 0.94 and 30 dB, a floor set after measuring: dents come out
up to 24 dB behind the same in a matte skin, probably as they mirror what light baked at rest does
not know, and `table`, gains and the image at rest are stated only. The paper's fields and `direct`
are stated only. Images are absolute: what a dent changes on skin that did not move, its shadow and
the light it takes away, is in the photons' images and counts.
"""

from __future__ import annotations

import dataclasses
import functools
import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sim.optics.field.model import model_of
from workbench.core.base.errors import WorkbenchError
from workbench.core.base.monitor import silent
from workbench.core.design.lighting import Baking, LightModel
from workbench.core.design.optics import Composition, Optics
from workbench.core.result.light import LightField, NormalTable
from workbench.pipeline.stages.bake import BakeInputs, bake
from workbench.pipeline.stages.table import TableInputs, table
from workbench.proof.row import Bounds, Row, bounded, failed, stated
from workbench.proof.validation.optics.light_images import (
    Score,
    fitted_gain,
    reference,
    score,
    true_gain,
)
from workbench.proof.validation.optics.light_scenes import (
    INK,
    SCENES,
    LightScene,
    mesh_of,
    optics_of,
)
from workbench.proof.validation.optics.photon_reference import frames_of

SEEDS = (1, 2, 3)
MODELS = (
    LightModel("hybrid"),
    LightModel("table"),
    LightModel("direct"),
    LightModel("linear"),
    LightModel("plane_target"),
    LightModel("plane_source"),
    LightModel("plane_normal"),
    LightModel("geodesic"),
)
BELOW_CEILING = {LightModel("hybrid"): 0.012, LightModel("table"): 0.02}
FINGER_DB, ANY_SSIM, ANY_DB = 38.0, 0.98, 36.0
INK_SSIM, INK_DB = 0.94, 30.0
GAINS = (0.95, 1.08)
REST_SSIM, REST_DB = 0.97, 41.0
FEWEST_CEILING = 0.995


@dataclass(frozen=True, kw_only=True, slots=True)
class Rendered:
    """What one model with one seed makes of a scene."""

    gain: float
    """Fitted on the sphere; 1 where none is allowed."""
    fitted: float
    """Fitted on the sphere in any case."""
    change: np.ndarray
    """What the sphere changes in its box, (H, W, 3)."""
    rest: Score
    """Absolute image of the undeformed skin, without any gain."""
    dents: dict[str, Score]


def rows() -> list[Row]:
    """All rows of all scenes."""
    found: list[Row] = []
    for scene in SCENES:
        try:
            found += list(_ceiling_rows(scene))
            for model in MODELS:
                found += list(_model_rows(scene, model))
        except WorkbenchError as error:
            found.append(failed("hybrid", scene.name, why=error.message))
        _baked.cache_clear()
    return found


def _ceiling_rows(scene: LightScene) -> Iterator[Row]:
    for name, frame in reference(scene.name).frames.items():
        case = f"{scene.name} {name}: half of {frame.photons:.1g} photons against the other half"
        limit, value = FEWEST_CEILING, frame.ceiling.ssim_1
        yield bounded("ceiling", case, value, unit="1", limit=limit, sense="min")


def _model_rows(scene: LightScene, model: LightModel) -> Iterator[Row]:
    seeds = SEEDS if model_of(model).tabulated else SEEDS[:1]
    shown = [rendered(scene, model, seed) for seed in seeds]
    every = reference(scene.name)
    rest = every.frames["flat"]
    for name, frame in every.frames.items():
        if name == "flat":
            continue
        worst = _worst([one.dents[name] for one in shown])
        null = score(rest.light, frame.light, frame.box)
        yield from _dent_rows(scene, model, name, worst, null, frame.ceiling)
    if model_of(model).tabulated:
        yield from _rest_rows(scene, model, shown)


def _dent_rows(
    scene: LightScene, model: LightModel, dent: str, worst: Score, null: Score, ceiling: Score
) -> Iterator[Row]:
    on_finger = scene.body == "finger"
    gain = "one gain" if on_finger or model_of(model).paper else "no gain"
    case = f"{scene.name} {dent}, {gain}"
    seeds = f", worst of {len(SEEDS)} seeds" if model_of(model).tabulated else ""
    similar, decibel = f"SSIM: {case}{seeds}", f"PSNR: {case}{seeds}"
    beside: Bounds = {"null": null.ssim_1, "ceiling": ceiling.ssim_1}
    beside_dB: Bounds = {"null": null.psnr_dB, "ceiling": ceiling.psnr_dB}
    least, asked_dB = _asked(scene, model, ceiling)
    if least is not None:
        limit = max(least, null.ssim_1)
        row = functools.partial(bounded, limit=limit, sense="min", **beside)
        yield row(model.value, similar, worst.ssim_1, unit="1")
    else:
        yield stated(model.value, similar, worst.ssim_1, unit="1", **beside)
    if asked_dB is not None:
        limit = max(asked_dB, null.psnr_dB)
        row = functools.partial(bounded, limit=limit, sense="min", **beside_dB)
        yield row(model.value, decibel, worst.psnr_dB, unit="dB")
    else:
        yield stated(model.value, decibel, worst.psnr_dB, unit="dB", **beside_dB)


def _asked(
    scene: LightScene, model: LightModel, ceiling: Score
) -> tuple[float | None, float | None]:
    """Least SSIM and PSNR [dB] of a dent; None where a figure is stated only."""
    hybrid = model is LightModel("hybrid")
    if model not in BELOW_CEILING or (scene.coating == INK and not hybrid):
        return None, None
    if scene.coating == INK:
        return INK_SSIM, INK_DB
    on_finger = scene.body == "finger"
    least = ceiling.ssim_1 - BELOW_CEILING[model] if on_finger else ANY_SSIM
    return least, (FINGER_DB if on_finger else ANY_DB) if hybrid else None


def _rest_rows(scene: LightScene, model: LightModel, shown: list[Rendered]) -> Iterator[Row]:
    """The scalar gain, and the absolute image at rest."""
    ceiling = reference(scene.name).frames["flat"].ceiling
    worst = _worst([one.rest for one in shown])
    name, case = "rest_image", f"{model.value}, {scene.name}, absolute, no gain"
    for what, value, unit, limit, best in (
        ("SSIM", worst.ssim_1, "1", REST_SSIM, ceiling.ssim_1),
        ("PSNR", worst.psnr_dB, "dB", REST_DB, ceiling.psnr_dB),
    ):
        of = f"{what}: {case}"
        if scene.coating == INK:
            yield stated(name, of, value, unit=unit, ceiling=best)
        else:
            yield bounded(name, of, value, unit=unit, limit=limit, sense="min", ceiling=best)
    case = f"{model.value}, {scene.name}, fitted on the sphere, farthest from 1 of {len(shown)}"
    if model is LightModel("hybrid") and scene.body == "finger" and scene.coating != INK:
        low, high = GAINS
        off = _farthest(_true_gains(scene, shown))
        inside = f"{case} pairs of seeds; limits {low:g} to {high:g}"
        # Distance to the nearer limit: positive inside.
        yield bounded("gain", inside, min(off - low, high - off), unit="1", limit=0.0, sense="min")
        yield stated("gain_value", f"{case} pairs of seeds", off, unit="1")
    yield stated("gain_value", f"{case} seeds", _farthest([one.fitted for one in shown]), unit="1")


def _true_gains(scene: LightScene, shown: list[Rendered]) -> list[float]:
    """The gain, noise of the bake apart, by each pair of seeds."""
    frames = reference(scene.name).frames
    box = frames["sphere"].box
    truth = (frames["sphere"].light - frames["flat"].light)[box]
    return [true_gain(a.change, b.change, truth) for a, b in itertools.combinations(shown, 2)]


def _farthest(gains: list[float]) -> float:
    """The gain that is farthest from 1, as a factor."""
    return max(gains, key=lambda gain: abs(np.log(gain)) if gain > 0.0 else np.inf)


def _worst(scores: list[Score]) -> Score:
    return Score(
        ssim_1=min(one.ssim_1 for one in scores), psnr_dB=min(one.psnr_dB for one in scores)
    )


def rendered(scene: LightScene, model: LightModel, seed: int) -> Rendered:
    """Render every frame of a scene and score it.

    Raises:
        WorkbenchError: From the stages, or if the reference is missing.
    """
    from sim.optics.studio.render import Studio

    mesh, every = mesh_of(scene.body), reference(scene.name)
    optics, light, radiances = _lit(scene, model, seed)
    optics = dataclasses.replace(optics, composition=Composition.ABSOLUTE)
    studio = Studio(mesh, light, optics, table=radiances)
    frames = frames_of(scene, mesh)
    images = {n: every.exposure * studio.linear(moved[None])[0] for n, moved in frames.items()}
    rest, truth = images.pop("flat"), every.frames["flat"]
    sphere = every.frames["sphere"]
    change = images["sphere"] - rest
    fitted = fitted_gain(change, sphere.light - truth.light, sphere.box)
    gain = fitted if scene.body == "finger" or model_of(model).paper else 1.0
    dents = {
        name: score(truth.light + gain * (image - rest), every.frames[name].light, box)
        for name, image in images.items()
        for box in (every.frames[name].box,)
    }
    whole = score(rest, truth.light, truth.box)
    return Rendered(gain=gain, fitted=fitted, change=change[sphere.box], rest=whole, dents=dents)


def _lit(
    scene: LightScene, model: LightModel, seed: int
) -> tuple[Optics, LightField, NormalTable | None]:
    mesh, optics = mesh_of(scene.body), optics_of(scene, model, seed=seed)
    if not model_of(model).tabulated:
        return (
            optics,
            bake(
                BakeInputs(mesh=mesh, ring=optics.ring, lamps=optics.lamps, model=model),
                monitor=silent,
            ),
            None,
        )
    transport = optics.transport
    assert transport is not None
    light = dataclasses.replace(_baked(scene, seed), model=str(model))
    found = table(
        TableInputs(
            mesh=mesh, light=light, cameras=optics.all_cameras, transport=transport, model=model
        ),
        monitor=silent,
    )
    return optics, light, found


@functools.cache
def _baked(scene: LightScene, seed: int) -> LightField:
    """Traced light of a scene: the same for `hybrid` and `table`."""
    optics = dataclasses.replace(optics_of(scene, LightModel("hybrid")), baking=Baking(seed=seed))
    return bake(
        BakeInputs(
            mesh=mesh_of(scene.body),
            ring=optics.ring,
            lamps=optics.lamps,
            model=LightModel("hybrid"),
            transport=optics.transport,
        ),
        monitor=silent,
    )
