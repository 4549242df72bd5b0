"""What the designer chooses about making the sensor: mould, housing, casting."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.check import within
from workbench.core.base.errors import DesignError

BED_MM = (145.0, 145.0, 185.0)
"""Source: Formlabs Form 3, the printer of the paper's trunk sensor [mm]."""
FEATURE_MM = 0.4


@dataclass(frozen=True, kw_only=True, slots=True)
class Printer:
    """What of a printer decides whether a part can be made."""

    bed_mm: tuple[float, float, float] = BED_MM
    """Room [mm]."""
    feature_mm: float = FEATURE_MM
    """Smallest feature that can be printed: nozzle diameter, or twice the pixel [mm]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class MouldOptions:
    """How the casting mould is made."""

    wall_mm: float = 6.0
    """Thickness of the mould around the part [mm]."""
    shrink_percent: float = 0.2
    """Linear shrinkage of the silicone while curing [%]; the cavity is larger by it."""
    clearance_mm: float = 0.15
    """Gap between mating printed faces [mm]."""
    gate_diameter_mm: float = 8.0
    """Diameter of the pouring funnel's mouth [mm]."""
    vent_count: int = 3
    outer_parts: int = 0
    """Parts of the outer mould: 2, 3 or 4; 0 lets the search for the least undercut decide."""
    draft_deg: float = 0.0
    """Taper of the core toward its tip [degree]; the elastomer gets thicker by it."""
    bed_mm: tuple[float, float, float] = BED_MM
    """Room of the printer [mm]."""
    feature_mm: float = FEATURE_MM
    """Smallest feature that can be printed [mm]."""

    @property
    def printer(self) -> Printer:
        """The printer of mould and housing."""
        return Printer(bed_mm=self.bed_mm, feature_mm=self.feature_mm)

    def __post_init__(self) -> None:
        at = "mould"
        within(self.wall_mm, 3.0, 50.0, what="mould wall", unit="mm", at=f"{at}.wall_mm")
        within(
            self.shrink_percent, 0.0, 10.0, what="shrinkage", unit="%", at=f"{at}.shrink_percent"
        )
        within(self.clearance_mm, 0.0, 1.0, what="clearance", unit="mm", at=f"{at}.clearance_mm")
        widest = 30.0
        at = f"{at}.gate_diameter_mm"
        within(self.gate_diameter_mm, 1.0, widest, what="gate diameter", unit="mm", at=at)
        within(self.vent_count, 1, 12, what="vent count", unit="", at="mould.vent_count")
        if self.outer_parts not in (0, 2, 3, 4):
            raise DesignError(
                f"{self.outer_parts} outer mould parts: only 2, 3 or 4 can be made",
                hint="choose 2, 3 or 4, or 0 and the search decides",
                at="mould.outer_parts",
            )
        within(self.draft_deg, 0.0, 10.0, what="draft", unit="degree", at="mould.draft_deg")
        for size_mm in self.bed_mm:
            within(size_mm, 20.0, 2000.0, what="printer bed", unit="mm", at="mould.bed_mm")
        at = "mould.feature_mm"
        within(self.feature_mm, 0.01, 5.0, what="smallest feature", unit="mm", at=at)


@dataclass(frozen=True, kw_only=True, slots=True)
class Housing:
    """The bought parts that the rigid housing must hold."""

    camera_width_mm: float = 8.5
    """Camera module across X. Source: OV5640 modules with M7 lens are 8.5 mm square."""
    camera_height_mm: float = 8.5
    """Camera module across Y [mm]."""
    camera_depth_mm: float = 6.0
    """Camera module along Z, from the back of its board to the front of its lens [mm]."""
    led_width_mm: float = 1.6
    """LED body [mm]. Source: WS2812 in the 1615 package, 1.6 x 1.5 mm (the paper's trunk)."""
    led_height_mm: float = 1.5
    wall_mm: float = 2.0
    """Walls of printed housing parts [mm]."""
    clearance_mm: float = 0.15
    """Gap between parts that slide into each other [mm]."""

    def __post_init__(self) -> None:
        for name in ("camera_width_mm", "camera_height_mm", "camera_depth_mm"):
            what = name.removesuffix("_mm").replace("_", " ")
            within(getattr(self, name), 1.0, 60.0, what=what, unit="mm", at=f"housing.{name}")
        for name in ("led_width_mm", "led_height_mm"):
            what = name.removesuffix("_mm").replace("_", " ").replace("led", "LED")
            within(getattr(self, name), 0.3, 20.0, what=what, unit="mm", at=f"housing.{name}")
        within(self.wall_mm, 0.5, 20.0, what="housing wall", unit="mm", at="housing.wall_mm")
        at = "housing.clearance_mm"
        within(self.clearance_mm, 0.0, 1.0, what="clearance", unit="mm", at=at)


@dataclass(frozen=True, kw_only=True, slots=True)
class Casting:
    """Which silicone is poured, and how much more than the cavity holds."""

    silicone: str = "XP-565 1:15"
    """Name in the table of silicones. Source: SimTac, real trunk sensor."""
    waste_percent: float = 20.0
    """Silicone left in the cup, the gate and the vents [%]."""

    def __post_init__(self) -> None:
        at = "casting.waste_percent"
        within(self.waste_percent, 0.0, 300.0, what="waste", unit="%", at=at)
