"""Figures that only a search asks for, beside those of the score card: what they mean, and values.

They are the goals that designers put in words: bright, small, few LEDs, the tip seen, the same
image as before, the price of the parts.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from workbench.core.result.maps import DesignerMaps
from workbench.core.result.results import Label, MembraneMesh, Solid
from workbench.core.result.sensing import Shot
from workbench.pipeline.store import Store
from workbench.project.prices import Prices, led_count, parts_cost
from workbench.project.state import State
from workbench.variants.score_card import Figures, figures, finite_figures
from workbench.view.headline import COST_RULE
from workbench.view.metric_rules import RULES, Better, Rule

TIP_MM = 5.0
"""Skin that lies no more than this below its highest point is the tip [mm]."""
SAME = "same_image_psnr_dB"
COST, LEDS = COST_RULE.name, "led_count_1"
NEEDS = {"build": ("build",), "mould": ("mould", "housing", "recipe"), "bake": ("bake",)}
"""Stages that a figure of a stage asks for, where it is not that stage alone."""


def _own(name: str, words: tuple[str, str], better: Better, stage: str, why: str) -> Rule:
    """A figure; `words` are its label and its unit."""
    label, unit = words
    return Rule(name=name, label=label, unit=unit, better=better, stage=stage, why=why)


LIKE = "PSNR over all images of the press; readers that were taught on the base go on"
FALLS = "light that falls on the skin over all that LEDs emit; scattered light counts each time"
TIP = f"skin within {TIP_MM:g} mm below its highest point that a camera sees"
REACHES = "a smaller finger reaches into more"
LOWER, HIGHER = Better.LOWER, Better.HIGHER
OWN = {
    rule.name: rule
    for rule in (
        _own(LEDS, ("LEDs", ""), LOWER, "", "each is placed and wired"),
        _own("body_height_mm", ("height of the body", "mm"), LOWER, "build", REACHES),
        COST_RULE,
        _own("light_on_skin_percent", ("light on the skin", "%"), HIGHER, "bake", FALLS),
        _own("tip_seen_percent", ("tip seen", "%"), HIGHER, "maps", TIP),
        _own(SAME, ("likeness to the base's images", "dB"), HIGHER, "shoot", LIKE),
    )
}
KNOWN: Mapping[str, Rule] = {**RULES, **OWN}
"""All figures that a goal or a limit may name."""
BY_DESIGN = (LEDS, "press_depth_mm")
"""Figures that follow from the design without computing anything."""


def stages_of(names: tuple[str, ...]) -> tuple[str, ...]:
    """Stages that figures come from."""
    stages = dict.fromkeys(KNOWN[name].stage for name in names)
    needed = (NEEDS.get(stage, (stage,)) for stage in stages if stage)
    return tuple(dict.fromkeys(stage for group in needed for stage in group))


@dataclass(frozen=True, kw_only=True, slots=True)
class Found:
    """Where figures are read from."""

    store: Store
    state: State
    keys: Mapping[str, str]
    """Keys of stored results by stage."""
    prices: Prices | None = None
    base_shot: Shot | None = None
    """Of the base, for the likeness to it."""

    def result(self, stage: str) -> Any:
        """A stored result, None where it is not."""
        key = self.keys.get(stage, "none")
        return self.store.load(stage, key) if self.store.has(stage, key) else None


def all_figures(found: Found) -> dict[str, float]:
    """Figures of the score card and of this file, as far as their stages are stored.

    Raises:
        StoreError: If a result is damaged.
    """
    own = {name: measure(found) for name, measure in MEASURES.items()}
    known: Figures = figures(found.store, found.state, found.keys)
    return {**known, **finite_figures({k: v for k, v in own.items() if v is not None})}


def _leds(found: Found) -> float:
    return float(led_count(found.state.design))


def _height_mm(found: Found) -> float | None:
    solid: Solid | None = found.result("build")
    if solid is None:
        return None
    membrane = solid.membrane
    outer = membrane.points_mm[membrane.faces[membrane.has(Label.OUTER)]]
    return float(outer[..., 2].max())


def _cost(found: Found) -> float | None:
    prices, solid = found.prices, found.result("build")
    if prices is None or solid is None:
        return None
    return parts_cost(found.state.design, solid.volume_mm3, prices)


def _light_percent(found: Found) -> float | None:
    light, mesh = found.result("bake"), found.result("mesh")
    if light is None or mesh is None or not light.led_rgb.sum():
        return None
    from geometry.surface.surface import vertex_areas_mm2
    from sim.optics.field.model import model_of
    from sim.optics.maps.lighting import light_in_all

    if model_of(light.model).paper:
        return None
    skin = mesh.seen
    areas_mm2 = vertex_areas_mm2(skin.points_mm, skin.faces)
    falls = areas_mm2 @ light_in_all(light, -skin.normals).sum(axis=1)
    return 100.0 * float(falls) / float(light.led_rgb.sum())


def _tip_percent(found: Found) -> float | None:
    maps: DesignerMaps | None = found.result("maps")
    mesh: MembraneMesh | None = found.result("mesh")
    if maps is None or mesh is None:
        return None
    from geometry.surface.surface import vertex_areas_mm2

    skin = mesh.seen
    height_mm = skin.points_mm[:, 2]
    tip = vertex_areas_mm2(skin.points_mm, skin.faces) * (height_mm > height_mm.max() - TIP_MM)
    seen = np.nan_to_num(np.asarray(maps.named("visible").values)) > 0.0
    return 100.0 * float(tip[seen].sum() / tip.sum())


def _likeness_dB(found: Found) -> float | None:
    shot: Shot | None = found.result("shoot")
    base = found.base_shot
    if shot is None or base is None:
        return None
    return psnr_dB(np.asarray(shot.frames.rgb), np.asarray(base.frames.rgb))


def psnr_dB(image: np.ndarray, other: np.ndarray) -> float | None:
    """10 log10(255^2 / mean square difference), at most 100; None of images of other sizes.

    Source: the definition of the peak signal-to-noise ratio.
    """
    if image.shape != other.shape:
        return None
    square = float(np.mean((image.astype(np.float64) - other) ** 2))
    return min(100.0, 10.0 * math.log10(255.0**2 / max(square, 1e-12)))


MEASURES: Mapping[str, Callable[[Found], float | None]] = {
    LEDS: _leds,
    "body_height_mm": _height_mm,
    COST: _cost,
    "light_on_skin_percent": _light_percent,
    "tip_seen_percent": _tip_percent,
    SAME: _likeness_dB,
}
