"""The elastomer: a silicone of the table, Shore A hardness or Young's modulus, and its friction.

All three say the same modulus; what is edited last counts. The hardness follows Gent's relation,
which is good to some 30 %.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any

from ui.desk.desk import Desk
from workbench.core.base.errors import DesignError, shown
from workbench.edit.forms import gent_MPa, hardness, moduli_MPa, shore_a

OWN = "own modulus"
SAME = 1e-3
"""Relative difference below which a modulus is that of the table."""
HARDEST = 90.0
"""Shore A beyond which the scale says little of a rubber."""


class MaterialFolder:
    """Widgets of the folder."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui, fields = desk.server.gui, desk.fields
        self.labels = {f"{name} ({hardness(name)})": name for name in moduli_MPa()}
        with gui.add_folder("Material", expand_by_default=False):
            hint = "Sets the modulus, and the silicone of the casting recipe"
            self.choice = gui.add_dropdown("Elastomer", (*self.labels, OWN), hint=hint)
            self.choice.on_update(desk.guarded(self._choose))
            hint = "Gent 1958, good to some 30 %; 0 is softer than the scale reaches"
            self.shore = gui.add_slider("Shore A", 0.0, HARDEST, 1.0, 0.0, hint=hint)
            self.shore.on_update(desk.guarded(self._harden))
            hint = "0.145 MPa is the silicone of the GelTip"
            fields.number("Young MPa", "design.material.young_MPa", step=0.005, hint=hint)
            fields.number("Poisson", "design.material.poisson", step=0.01, hint="Below 0.495")
            hint = "Coulomb, of what sticks"
            fields.number("Friction", "design.material.friction", step=0.05, hint=hint)
            hint = "Coulomb, of what slides, at most the one above; empty: the same"
            path = "design.material.kinetic_friction"
            fields.text("Kinetic friction", path, read=_read, write=_write, hint=hint)
            hint = "Gel behind skins with a gap (DigiTac); 0 is air. Bonded skins ignore it"
            fields.number("Backing gel MPa", "design.material.backing_MPa", step=0.005, hint=hint)
        self.refresh()

    def _choose(self, event: Any) -> None:
        """Take modulus and recipe of a silicone, as one step of undo."""
        if event.client is None or self.choice.value == OWN:
            self.refresh()
            return
        name, session = self.labels[self.choice.value], self.desk.session
        design = session.design.replace("material.young_MPa", moduli_MPa()[name])
        design = design.replace("casting.silicone", name)
        session.replace_state(dataclasses.replace(session.state, design=design))
        self.desk.replaced()

    def _harden(self, event: Any) -> None:
        if event.client is not None:
            young_MPa = float(f"{gent_MPa(float(self.shore.value)):.4g}")
            self.desk.edit("design.material.young_MPa", young_MPa)
            self.desk.fields.refresh()

    def refresh(self) -> None:
        """Show the modulus as it stands in all three ways."""
        design = self.desk.session.design
        young_MPa, cast = design.material.young_MPa, design.casting.silicone
        same = [label for label, name in self.labels.items() if _same(name, young_MPa)]
        # Some silicones share a modulus: of these the one that is cast.
        now = min(same, key=lambda label: self.labels[label] != cast, default=OWN)
        if self.choice.value != now:
            self.choice.value = now
        shore = min(max(shore_a(young_MPa), 0.0), HARDEST)
        if not math.isclose(self.shore.value, shore, abs_tol=0.5):
            self.shore.value = round(shore)


def _read(text: str) -> float | None:
    """A coefficient as typed; None where the field is empty."""
    if not text.strip():
        return None
    try:
        return float(text)
    except ValueError:
        raise DesignError(
            f"kinetic friction is {shown(text)}, which is not a number",
            hint="type a coefficient, for example 0.25, or leave it empty",
            at="material.kinetic_friction",
        ) from None


def _write(coefficient: float | None) -> str:
    return "" if coefficient is None else f"{coefficient:g}"


def _same(name: str, young_MPa: float) -> bool:
    return math.isclose(moduli_MPa()[name], young_MPa, rel_tol=SAME)
