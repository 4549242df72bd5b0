"""Which presses an evaluation shows, what they look like, and how the data are spread."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim.forces.network.spec import FIELDS, Target
from workbench.core.base.errors import DeviceError
from workbench.core.base.monitor import Monitor, silent
from workbench.learning.dataset.cases import Split
from workbench.learning.evaluation.evaluate import FieldResult, Named
from workbench.learning.evaluation.heat_maps import Pair, heat_map
from workbench.learning.evaluation.scoring import Scored, Way, both, learned_by, predictor_for
from workbench.learning.evaluation.sources import Source, states


@dataclass(frozen=True, kw_only=True, slots=True)
class Sheet:
    """Heat maps of one field of one sample."""

    file: str
    caption: str
    image: np.ndarray | None
    """sRGB, shape (H, W, 3), uint8; None where nothing can render."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Spread:
    """How deep and how hard the samples of a source press."""

    depths_mm: np.ndarray
    """Depth from first touch [mm], shape (S,)."""
    forces_N: np.ndarray
    """Length of the total force by finite elements [N], shape (S,)."""


def chosen_press(found: FieldResult, *, sheared: bool) -> Scored | None:
    """A typical sample: of the deepest, or farthest sheared, the median error over its peak.

    Of unseen objects where there are such; None where there is no such sample at all.
    """
    members = [scored for scored in found.samples if scored.sheared == sheared]
    unseen = [scored for scored in members if scored.case.split is Split.UNSEEN]
    members = unseen or members
    if not members:
        return None
    far = max(map(_reach, members))
    last = [scored for scored in members if _reach(scored) >= far - 1e-9]
    return sorted(last, key=_own_error)[(len(last) - 1) // 2]


def _reach(scored: Scored) -> float:
    return scored.shear_mm if scored.sheared else scored.depth_mm


def _own_error(scored: Scored) -> float:
    one = scored.scores[Way.LEARNED]
    return one.mae / max(one.peak, 1e-30)


def sheets(source: Source, named: Named, found: FieldResult) -> list[Sheet]:
    """Heat maps of a typical press and a typical shear."""
    learned, drawn = learned_by(named.weights, predictor_for(named.weights, source)), []
    for sheared, motion in ((False, "press"), (True, "shear")):
        scored = chosen_press(found, sheared=sheared)
        if scored is None:
            continue
        sample = source.sample(scored.case, scored.frame)
        mpm, fem = both(sample)
        pair = Pair(
            sample=sample,
            found=learned(mpm),
            truth=getattr(fem, FIELDS[found.target]),
            moved_mm=fem.displacement_mm,
            unit=found.target.unit,
        )
        caption = (
            f"{_words(found.target)} of a typical {motion} ({scored.case.split}): "
            f"{scored.case.id}, {scored.depth_mm:.2g} mm deep"
            + (f", {scored.shear_mm:.2g} mm aside" if sheared else "")
            + f"; mean error {100.0 * _own_error(scored):.3f} % of its peak"
        )
        try:
            image = heat_map(source.skin, pair)
        except DeviceError as error:
            image, caption = None, f"{caption}; not drawn: {error.message}"
        drawn.append(Sheet(file=f"{found.target}_{motion}.png", caption=caption, image=image))
    return drawn


def _words(target: Target) -> str:
    return "Nodal force" if target is Target.FORCE else "Displacement"


def spread(source: Source, monitor: Monitor = silent) -> Spread:
    """Depth and total force of every state of a source, those of the training included."""
    every: Sequence = states(source, tuple(Split))
    depths, forces = [], []
    for number, (case, frame) in enumerate(every):
        monitor(number / len(every), case.id)
        _, fem = both(source.sample(case, frame))
        depths.append(case.depth_at(frame))
        forces.append(float(np.linalg.norm(fem.contact_force_N.sum(axis=0, dtype=np.float64))))
    return Spread(depths_mm=np.array(depths), forces_N=np.array(forces))
