"""What parts cost the designer, in a currency of their own: `prices.toml` in the project folder.

```toml
led = 0.4
camera = 18.0
gram = 0.05
base = 6.0
```
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import asdict, dataclass
from pathlib import Path

from workbench.core.base.errors import DesignError
from workbench.core.base.mapping import from_table
from workbench.core.base.units import volume_ml
from workbench.core.design.design import SensorDesign
from workbench.system.whole_files import write_atomically

FILE = "prices.toml"


@dataclass(frozen=True, kw_only=True, slots=True)
class Prices:
    """What parts cost, in the designer's own currency; for the figure `parts_cost_1`."""

    base: float = 0.0
    led: float = 0.0
    camera: float = 0.0
    gram: float = 0.0
    """Of silicone."""


def parts_cost(design: SensorDesign, elastomer_mm3: float, prices: Prices) -> float:
    """What the parts of one sensor cost: LEDs and lamps, cameras, silicone by its mass, the rest.

    Args:
        design: Has the counts, and the density of the elastomer.
        elastomer_mm3: Volume of the cast elastomer.
        prices: Each in the designer's own currency.
    """
    grams = volume_ml(elastomer_mm3) * design.material.density_g_cm3
    cameras = len(design.optics.all_cameras)
    parts = prices.led * led_count(design) + prices.camera * cameras + prices.gram * grams
    return prices.base + parts


def led_count(design: SensorDesign) -> int:
    """LEDs of the ring and lamps: what is bought and wired."""
    return design.optics.ring.count + len(design.optics.lamps)


def read_prices(folder: Path) -> Prices | None:
    """The project's prices; None where there is no file.

    Raises:
        DesignError: If the file is no such table.
    """
    path = folder / FILE
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        hint = f"correct or delete {path}"
        raise DesignError(f"{FILE} cannot be read: {error}", hint=hint, at=FILE) from error
    return _checked(from_table(Prices, table, at=FILE))


def write_prices(folder: Path, prices: Prices | None) -> None:
    """Keep them in place of those there; None: there are none.

    Raises:
        DesignError: If one is negative or no number.
        StoreError: If the folder cannot be written.
    """
    path = folder / FILE
    if prices is None:
        path.unlink(missing_ok=True)
        return
    lines = [f"{name} = {price!r}\n" for name, price in asdict(_checked(prices)).items()]
    write_atomically(path, "".join(lines).encode())


def _checked(prices: Prices) -> Prices:
    for name, price in asdict(prices).items():
        if not (math.isfinite(price) and price >= 0.0):
            hint = "0 is what costs nothing"
            raise DesignError(f"price {name} = {price:g} must be 0 or more", hint=hint, at=name)
    return prices
