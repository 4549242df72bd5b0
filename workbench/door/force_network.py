"""A trained network by itself: the forces on a skin from how the skin has moved, frame by frame.

Needs NumPy, SciPy and PyTorch alone, no mesher, renderer or solver, and so runs on a robot.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.core.base.packages import naming_packages

if TYPE_CHECKING:
    from sim.forces.network.weights import NetworkWeights
    from workbench.core.result.results import Skin

SPACING = 0.05
"""Largest difference of the spacing of points from that of the training: forces at points are in
proportion to the area of a point."""


class Triangles(Protocol):
    """A skin: `DataSet.skin`, `results.mesh.outer`, or anything else with points and triangles."""

    @property
    def points_mm(self) -> np.ndarray:
        """Vertices at rest [mm], shape (V, 3)."""
        ...

    @property
    def faces(self) -> np.ndarray:
        """Triangles, shape (F, 3), counter-clockwise from outside."""
        ...


class ForceNetwork:
    """A trained network on a skin; keep it as long as the sensor.

    The networks that ship know finger, pad, trunk and paw and correct the contact solver: they want
    its force beside its displacement. One that is trained with the preset `paper` wants a
    displacement alone, which markers in a camera's image can give.

    Attributes:
        weights: Of the network; `weights.card` says what it was trained on.
        points_mm: Where displacement is given and forces are returned [mm], shape (V, 3).
        needs_force: Whether it wants the contact solver's force too.
    """

    def __init__(
        self,
        weights: Path | str | None = None,
        skin: Triangles | str | None = None,
        *,
        on: Triangles | None = None,
        young_MPa: float | None = None,
    ) -> None:
        """Read the weights and prepare them for the skin.

        Args:
            weights: File of a network for forces; the one that ships when left out.
            skin: With the points of the training, `DataSet.open(folder).skin`, or the name of a
                preset that the shipped networks know: `geltip`, which is meant where it is left
                out, `pad`, `trunk` or `paw`.
            on: Another mesh of the same skin, on which displacement is given and forces are wanted;
                fields are carried between the two. The points of the training when left out.
            young_MPa: Of the elastomer; as in the training when left out.

        Raises:
            StoreError: If the weights are missing, damaged, or predict something else; if no skin
                of that name ships.
            DesignError: If the skin is missing or has another spacing than that of the training.
            PackageError: If a package is missing.
        """
        from sim.forces.network.spec import Target
        from workbench.pipeline.chosen_weights import chosen
        from workbench.pipeline.shipped import shipped_weights

        if weights is None:
            path = shipped_weights(Target.FORCE)
        else:
            path = Path(chosen(Path(weights)))
        with naming_packages():
            from sim.forces.network.steady import steady_predictor
            from sim.forces.network.weights import load_weights
            from workbench.pipeline.devices import torch_device

            self.weights = load_weights(path)
            own = _skin(_named_skin(skin, known=weights is None))
            _expect_spacing(self.weights, own)
            points_mm, faces = own.points_mm, own.faces
            device = torch_device()
            self._predictor = steady_predictor(self.weights, points_mm, faces, device=device)
            self._carry(own, None if on is None else _skin(on))
        self.needs_force = self.weights.takes_force
        self._factor = 1.0 if young_MPa is None else young_MPa / _trained_MPa(self.weights)

    def force_N(
        self, displacement_mm: np.ndarray, contact_force_N: np.ndarray | None = None
    ) -> np.ndarray:
        """Force of the object on each point of the skin [N]; their sum is what the skin feels.

        Args:
            displacement_mm: Of the points from rest, (V, 3), or (K, V, 3) for K frames.
            contact_force_N: By the contact solver, of the same shape, where the network wants it.

        Returns:
            Of the same shape, float32, in the sensor's axes.

        Raises:
            DesignError: If the shape is another, or the force is missing.
            SolveError: If a number is not finite.
        """
        from sim.forces.network.inputs import given_field

        moved = _frames(displacement_mm, len(self.points_mm), "displacement_mm")
        if contact_force_N is None and self.needs_force:
            raise DesignError(
                "this network corrects the contact solver, and wants its force too",
                hint="give contact_force_N, or train one without: workbench train make "
                "DATA --preset paper",
                at="contact_force_N",
            )
        given_N = np.zeros_like(moved) if contact_force_N is None else contact_force_N
        pressed = _frames(given_N, len(self.points_mm), "contact_force_N")
        if self._there is not None and self._back is not None:
            moved = self._there.interpolate(moved)
            pressed = self._back.spread(pressed, self._count)
        given = given_field(self.weights, moved, pressed, factor=self._factor)
        found = np.stack([self._predictor.predict(frame) for frame in given])
        found *= np.float32(self._factor)
        if self._there is not None:
            found = self._there.spread(found, len(self.points_mm))
        return found.reshape(np.shape(displacement_mm))

    def _carry(self, own: Skin, on: Skin | None) -> None:
        """Where the points of each skin lie on the other."""
        from sim.forces.shares import shares_on

        self.points_mm = own.points_mm if on is None else on.points_mm
        self._count = len(own.points_mm)
        self._there = None if on is None else shares_on(on, own.points_mm)
        self._back = None if on is None else shares_on(own, on.points_mm)


def _skin(found: Triangles | None) -> Skin:
    from geometry.surface.surface import vertex_normals
    from workbench.core.result.results import Skin

    if found is None:
        raise DesignError(
            "these weights do not come with the skin that they were trained on",
            hint="give skin=wb.DataSet.open(FOLDER).skin of the data set that they learned from",
            at="skin",
        )
    points_mm, faces = np.asarray(found.points_mm), np.asarray(found.faces)
    return Skin(points_mm=points_mm, faces=faces, normals=vertex_normals(points_mm, faces))


def _named_skin(skin: Triangles | str | None, *, known: bool) -> Triangles | None:
    """The skin that is meant; `known`: whether one that ships goes with the weights unnamed."""
    from workbench.learning.evaluation.held_out import HeldOut
    from workbench.pipeline.shipped import FIRST, held_out_set

    if skin is None and known:
        skin = FIRST
    return HeldOut.open(held_out_set(skin)).skin if isinstance(skin, str) else skin


def _expect_spacing(weights: NetworkWeights, skin: Skin) -> None:
    from sim.forces.network.voxels import spacing_mm

    found_mm = spacing_mm(skin.points_mm, skin.faces)
    if abs(found_mm / weights.spacing_mm - 1.0) > SPACING:
        raise DesignError(
            f"points of the skin are {found_mm:.3f} mm apart, trained at {weights.spacing_mm:.3f} "
            f"mm, and may differ by {100 * SPACING:.0f} %",
            hint="give the skin of the training as skin=, and this one as on=",
            at="skin",
        )


def _trained_MPa(weights: NetworkWeights) -> float:
    """Young's modulus of the training [MPa]."""
    found = weights.card.get("young_MPa")
    if not isinstance(found, int | float) or found <= 0.0:
        raise DesignError(
            "the weights do not say at which E they were trained",
            hint="leave young_MPa out, and use them at the E of their data set",
            at="young_MPa",
        )
    return float(found)


def _frames(values: np.ndarray, count: int, name: str) -> np.ndarray:
    """Values of points as those of several frames, (K, V, 3)."""
    array = np.asarray(values, np.float32)
    frames = array if array.ndim == 3 else array[None]
    if frames.shape[1:] != (count, 3):
        raise DesignError(
            f"{name} has shape {array.shape}; the skin has {count} points, each with x, y and z",
            hint=f"give ({count}, 3), or (K, {count}, 3) for K frames, in the order of points_mm",
            at=name,
        )
    return frames
