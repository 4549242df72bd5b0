"""Manifolds that know the faces of the file they come from, and the labels made of these.

Booleans of manifold3d carry the number of the source face on every triangle; triangles of the core
have one number of their own.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from geometry.body.csg_mesh import arrays, closed
from geometry.surface.surface import FLAT_MM, on_plane
from workbench.core.base.errors import DesignError
from workbench.core.design.imported import Pick
from workbench.core.result.results import Label, LabelledSurface

CORE_FACE = 1_000_000
"""Face number of every triangle of the core; patches of the outer file stay below."""


def labelled(body: Any, picks: Sequence[Pick]) -> LabelledSurface:
    """The triangles of a body with their regions: by source face, by height, by what was picked.

    Raises:
        DesignError: If a picked face is not on the sensing side.
    """
    points, faces, source = flat_arrays(body)
    labels = np.where(source >= CORE_FACE, Label.INNER, Label.OUTER).astype(np.uint8)
    labels[on_plane(points, faces)] = Label.BASE
    numbers = np.full(len(faces), -1, dtype=np.int16)
    for pick in picks:
        members = (source == pick.patch) & (labels == Label.OUTER)
        if not members.any():
            raise DesignError(
                f"the picked face {pick.patch} is not on the sensing side of this body",
                hint="remove it from the picks, or pick again",
                at="body.picks",
            )
        kind, _, number = pick.region.partition("_")
        if kind == "base":
            labels[members] = Label.BASE
        else:
            labels[members] |= np.uint8(Label.ACTUATOR)
            numbers[members] = int(number)
    return LabelledSurface(points_mm=points, faces=faces, labels=labels, numbers=numbers)


def patches(skin: Any) -> np.ndarray:
    """Face of the outer file of each triangle of the skin, -1 on the core and the cut, (M,)."""
    points, faces, source = flat_arrays(skin)
    return np.where(on_plane(points, faces) | (source >= CORE_FACE), -1, source).astype(np.int32)


def manifold_of(points: np.ndarray, faces: np.ndarray, source: np.ndarray | None) -> Any:
    """The manifold of triangles (M, 3) with their source faces (M,), else those of the core."""
    numbers = np.full(len(faces), CORE_FACE) if source is None else source
    return closed("the imported body", points, faces, numbers)


def renumbered(solid: Any, number: int = CORE_FACE) -> Any:
    """The same manifold, all of whose triangles have one source face."""
    points, faces, _ = flat_arrays(solid)
    return manifold_of(points, faces, np.full(len(faces), number))


def flat_arrays(solid: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices (N, 3), triangles (M, 3) and source faces (M,) of a manifold."""
    points, faces = arrays(solid)
    # Cuts land on the plane to rounding; the base must lie on it exactly.
    points[np.abs(points[:, 2]) < FLAT_MM, 2] = 0.0
    return points, faces, np.array(solid.to_mesh64().face_id).astype(np.int64)


def expect_one_body(membrane: LabelledSurface, *, from_file: bool) -> None:
    """Refuse a membrane without a sensing or without an inner side.

    Args:
        from_file: Whether the inner body came from a file, which the remedy then names.
    """
    if not membrane.has(Label.OUTER).any():
        raise DesignError(
            "the labels leave no face on the sensing side: at least one face must stay sensing",
            hint="take back the label base of one face",
            at="body.picks",
        )
    if not membrane.has(Label.INNER).any():
        raise DesignError(
            "the membrane has no inner side",
            hint="check the inner file" if from_file else "lower layers.elastomer_mm",
            at="body.inner" if from_file else "layers.elastomer_mm",
        )
