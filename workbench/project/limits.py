"""The designer's own limits of figures: `limits.toml` in the project folder.

```toml
[contact_contrast_1]
good = 0.2
poor = 0.05
```
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DesignError
from workbench.system.whole_files import write_atomically
from workbench.view.headline import Bounds

FILE = "limits.toml"


def read_limits(folder: Path) -> dict[str, Bounds]:
    """Limits by figure; none where there is no file.

    Raises:
        DesignError: If the file is no such table.
    """
    path = folder / FILE
    try:
        table: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}
    except (OSError, ValueError) as error:
        raise _broken(path, str(error)) from error
    return {name: _bounds(path, name, entry) for name, entry in table.items()}


def write_limits(folder: Path, limits: Mapping[str, Bounds]) -> None:
    """Keep them in place of those there.

    Raises:
        DesignError: If two ends are the same, or no numbers.
        StoreError: If the folder cannot be written.
    """
    path = folder / FILE
    for name, bounds in limits.items():
        _bounds(path, name, {"good": bounds.good, "poor": bounds.poor})
    text = "\n".join(
        f'["{name}"]\ngood = {bounds.good!r}\npoor = {bounds.poor!r}\n'
        for name, bounds in sorted(limits.items())
    )
    write_atomically(path, text.encode())


def _bounds(path: Path, name: str, entry: Any) -> Bounds:
    ends: list[Any] = [entry.get("good"), entry.get("poor")] if isinstance(entry, dict) else []
    numbers = [float(end) for end in ends if _is_number(end)]
    if len(numbers) != 2:
        raise _broken(path, f"{name} needs two numbers, good and poor")
    good, poor = numbers
    if not (math.isfinite(good) and math.isfinite(poor)) or good == poor:
        raise DesignError(
            f"limits of {name}: good {good:g} and poor {poor:g} must be two different numbers",
            hint="good above poor: more is better; good below poor: less is better",
            at=name,
        )
    return Bounds(good=good, poor=poor)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _broken(path: Path, why: str) -> DesignError:
    hint = f"correct or delete {path}"
    return DesignError(f"{FILE} cannot be read: {why}", hint=hint, at=str(path))
