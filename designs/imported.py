"""Imported: your own body from a STEP or STL file, made a membrane.

The file's body becomes the sensing side. The wall is a second file, or an even wall of
`layers.elastomer_mm`; the support follows inside it. The body is turned first, then cut: what lies
below the cut goes, and the flat face that is left becomes the base, centred on the origin.

| parameter        | meaning                                                             |
|------------------|---------------------------------------------------------------------|
| `turn_x_deg`     | turn about X before cutting                                         |
| `turn_y_deg`     | turn about Y after that                                             |
| `turn_z_deg`     | turn about Z after that                                             |
| `cut_mm`         | how much is cut off above the body's lowest point                   |
| `base_height_mm` | height of the foot                                                  |
| `base_lip_mm`    | how far the foot stands out beyond the skin                         |

In a design file:

    family = "imported"
    [body]
    outer = "wrist.step"        # beside the design file
    inner = "bone.stl"          # optional
    unit = "auto"               # mm, cm, m or inch for an STL that does not say

Regions by rule: the flat cut is base, the outer file outer, the inner side inner. Single faces are
picked in the browser, and kept as `picks`.
Leaves out: fillets at the base, walls of varying thickness without an inner file.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NoReturn

from designs.bodies import Bodies, Fields
from designs.sliders import slider
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Layers


@dataclass(frozen=True, kw_only=True, slots=True)
class ImportedShape:
    """How the file's body is placed, and its foot."""

    turn_x_deg: float = slider(0.0, (-180.0, 180.0, 5.0), "°", "Turn about X", "Before cutting")
    turn_y_deg: float = slider(0.0, (-180.0, 180.0, 5.0), "°", "Turn about Y", "Before cutting")
    turn_z_deg: float = slider(0.0, (-180.0, 180.0, 5.0), "°", "Turn about Z", "Before cutting")
    cut_mm: float = slider(
        0.0, (0.0, 100.0, 0.5), "mm", "Cut off below", "Height above the lowest point"
    )
    base_height_mm: float = slider(
        8.0, (2.0, 40.0, 0.5), "mm", "Foot height", "Rigid foot that carries camera and LEDs"
    )
    base_lip_mm: float = slider(
        3.0, (0.0, 15.0, 0.5), "mm", "Foot lip", "How far the foot stands out beyond the skin"
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class Imported:
    """Stands for bodies that come from files; geometry builds them."""

    name: str = "imported"
    title: str = "Own body (STEP or STL)"
    shape_type: type = ImportedShape

    def check(self, shape: ImportedShape, layers: Layers) -> None:
        """Everything that can be refused is only known once the file has been read."""

    def soften(self, shape: ImportedShape) -> None:
        """There is no fillet to make smaller."""
        return None

    def target(self, shape: ImportedShape, layers: Layers) -> tuple[float, float, float]:
        """The origin: whoever knows the body moves it to the skin."""
        return 0.0, 0.0, 0.0

    def build(self, shape: ImportedShape, layers: Layers) -> Bodies:
        """Refuse: without its file there is no body.

        Raises:
            DesignError: Always.
        """
        return _no_file()

    def fields(self, shape: ImportedShape, layers: Layers) -> Fields:
        """Refuse: without its file there is no body.

        Raises:
            DesignError: Always.
        """
        return _no_file()


def _no_file() -> NoReturn:
    raise DesignError(
        "the design has no body file",
        hint="load a STEP or STL file, or write [body] outer = 'file.step' in the design",
        at="body.outer",
    )


FAMILY: Any = Imported()
