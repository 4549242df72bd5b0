"""Our released heads beside the files, as they are pressed: with their edges rounded.

Body +X is the file's +y, +Y its +z, +Z its +x; nothing is laid on anything. The block behind the
head is left out on both sides. Null: the ellipsoid that fills the head's box.
"""

from __future__ import annotations

import functools

import numpy as np

from workbench.edit.indenter_choice import choose_indenter
from workbench.live.indenter_display import display_mesh
from workbench.proof.row import Row, bounded
from workbench.proof.validation.published.apart import distances_mm, ellipsoid
from workbench.proof.validation.published.released import Cut, Skin, indenter

NAMES = {
    "Cube": "released_cube",
    "Cylinder": "released_cylinder",
    "Cylinder_side": "released_cylinder_side",
    "Diamond": "released_diamond",
    "Double_cylinder_side": "released_double_cylinder_side",
    "Ellipsoid": "released_ellipsoid",
    "Ellipsoid_circle": "released_ellipsoid_circle",
    "Fllower": "released_flower",
    "Hexagon": "released_hexagon",
    "Pacman": "released_pacman",
    "Sphere": "released_sphere",
    "Sphere_R27": "released_sphere_r27",
    "Triangle": "released_triangle",
    "X": "released_x",
}
"""Objects by the file that was released."""
MEAN_MM = 0.05
MIDDLE_MM = 20.0
"""x of the middle of a head in its file."""
FOOT = Cut((1.0, 0.0, 0.0), 25.0)
"""Where a head stands on its block."""


def rows() -> list[Row]:
    """A row of each file."""
    return [
        bounded(
            "indenter_shape",
            file,
            functools.partial(head_mm, name, file),
            unit="mm",
            limit=MEAN_MM,
            null=functools.partial(_null_mm, file),
        )
        for file, name in NAMES.items()
    ]


def head_mm(name: str, file: str) -> float:
    """Mean distance of an object and a released head to each other.

    Raises:
        DesignError: If there is no such object.
    """
    points, faces = display_mesh(choose_indenter(name))
    in_file = points[:, [2, 0, 1]] + np.array([MIDDLE_MM, 0.0, 0.0])
    ours = Skin(points_mm=in_file, faces=faces)
    return float(distances_mm(ours, _head(file)).mean())


def _null_mm(file: str) -> float:
    return float(distances_mm(ellipsoid(_head(file)), _head(file)).mean())


def _head(file: str) -> Skin:
    return indenter(file)._replace(cuts=(FOOT,))
