"""What is pressed, where, and how it is computed."""

from __future__ import annotations

from dataclasses import dataclass, field

from workbench.core.press.fem import FemSettings
from workbench.core.press.indenter import Indenter
from workbench.core.press.learned import LearnedSettings
from workbench.core.press.press import ContactSettings, Press


@dataclass(frozen=True, kw_only=True, slots=True)
class PressCase:
    """What is pressed, where, and how it is computed."""

    indenter: Indenter = field(default_factory=Indenter)
    press: Press = field(default_factory=Press)
    settings: ContactSettings = field(default_factory=ContactSettings)
    fem: FemSettings = field(default_factory=FemSettings)
    learned: LearnedSettings = field(default_factory=LearnedSettings)
