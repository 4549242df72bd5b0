"""Draw the thumbnails of the galleries: every preset and family, every object of the studio.

`.venv/bin/python docs/thumbnails.py` writes `designs/thumbnails/*.png` and `keys.toml`, which says
what each was drawn of, so that a test can tell when one is out of date. Takes about a minute.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import cv2  # noqa: TID253 (a program of its own, not part of the package)
import numpy as np
import tomli_w

from designs.family import eye
from geometry.drawing.rendering import canvas, draw, look, png
from geometry.drawing.sensor_drawings import membrane_drawing
from workbench.core.base.monitor import silent
from workbench.core.press.indenter import Indenter
from workbench.core.press.press_case import PressCase
from workbench.edit.forms import choices
from workbench.edit.indenter_edit import another, gallery
from workbench.edit.shipped_thumbnails import FOLDER, KEYS, object_key, start_key
from workbench.live.indenter_display import display_mesh
from workbench.pipeline.stages.build import build
from workbench.planning.plan import plan
from workbench.project.named_designs import load_design

SIZE_PX, FINER = 144, 3
OBJECT_COLOUR = "#e87c2c"
FROM_BELOW = np.array([1.0, -1.6, -1.1])
"""Toward the eye: objects are told apart by the face that touches."""


def thumbnails() -> Iterator[tuple[str, str, np.ndarray]]:
    """Name, key and PNG bytes of each, at `FINER` times the size."""
    size = (FINER * SIZE_PX, FINER * SIZE_PX)
    for name in choices():
        design = load_design(name)
        solid = build(plan(design, PressCase())["build"].inputs, monitor=silent)
        drawing = membrane_drawing(solid, size, eye=eye(design.family))
        yield f"start-{name}", start_key(name), drawing
    for name in gallery().values():
        points, faces = display_mesh(another(name, Indenter()))
        plotter = canvas(size)
        draw(plotter, points, faces, OBJECT_COLOUR)
        look(plotter, FROM_BELOW, points)
        yield f"object-{name}", object_key(name), png(plotter, clear=True)


def main() -> None:
    """Write all of them."""
    folder = Path(__file__).parent.parent / FOLDER
    keys = {}
    for name, key, data in thumbnails():
        large = cv2.imdecode(data, cv2.IMREAD_UNCHANGED)
        assert large is not None
        small = cv2.resize(large, (SIZE_PX, SIZE_PX), interpolation=cv2.INTER_AREA)
        cv2.imwrite(str(folder / f"{name}.png"), small, [cv2.IMWRITE_PNG_COMPRESSION, 9])
        keys[name] = key
        print(name)
    (folder / KEYS).write_text(tomli_w.dumps(keys))


if __name__ == "__main__":
    main()
