"""Mould and sensor drawn apart, where the machine can render."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from workbench.core.design.design import SensorDesign
from workbench.report.export import Export


def files(design: SensorDesign, found: dict[str, Any]) -> Iterator[tuple[str, bytes]]:
    """A PNG file, or none."""
    if "picture" in found:
        yield "exploded.png", found["picture"].png.tobytes()


EXPORT = Export(
    place=5, makes=("exploded.png",), stages=("picture",), files=files, if_possible=True
)
