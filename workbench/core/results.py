"""What the stages return. Sensor frame; mm, N, MPa; float64 geometry, float32 fields.

V outer-surface vertices, F faces, N mesh nodes, K frames, L LEDs, C grid cells.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

import numpy as np

from workbench.core.check import expect


class Label(enum.IntFlag):
    """Region of a face or node; nodes on a rim carry several."""

    OUTER = 1
    INNER = 2
    BASE = 4


@dataclass(frozen=True, kw_only=True, slots=True)
class Skin:
    """A triangulated surface with vertex normals."""

    points_mm: np.ndarray
    """Vertices [mm], shape (V, 3), float64."""
    faces: np.ndarray
    """Triangles, shape (F, 3), int32, counter-clockwise seen from outside the sensor."""
    normals: np.ndarray
    """Unit vertex normals pointing out of the sensor, shape (V, 3), float64."""

    def __post_init__(self) -> None:
        expect(self.points_mm, "V 3", name="skin points")
        expect(self.faces, "F 3", name="skin faces")
        expect(self.normals, "V 3", name="skin normals")


@dataclass(frozen=True, kw_only=True, slots=True)
class LabelledSurface:
    """A closed triangle mesh whose faces know their region."""

    points_mm: np.ndarray
    """Vertices [mm], shape (N, 3), float64."""
    faces: np.ndarray
    """Triangles, shape (M, 3), int32, counter-clockwise from outside the material."""
    labels: np.ndarray
    """`Label` of each face, shape (M,), uint8."""

    def __post_init__(self) -> None:
        expect(self.points_mm, "N 3", name="surface points")
        expect(self.faces, "M 3", name="surface faces")
        expect(self.labels, "M", name="surface labels")


@dataclass(frozen=True, kw_only=True, slots=True)
class Solid:
    """The body of a sensor as the CAD kernel built it."""

    membrane: LabelledSurface
    """Watertight elastomer body with labels outer, inner and base."""
    support: LabelledSurface
    """The rigid transparent shell inside it; its inner faces bound the cavity."""
    base: LabelledSurface
    """The rigid foot that carries camera and LEDs."""
    outer_brep: np.ndarray
    """OCCT text of the outer body before hollowing, shape (bytes,), uint8."""
    core_brep: np.ndarray
    """OCCT text of the body that hollows it, shape (bytes,), uint8."""
    volume_mm3: float
    """Volume of the elastomer by the CAD kernel [mm3]."""
    notice: str = ""
    """What the builder had to change, for the user; empty when nothing."""


@dataclass(frozen=True, kw_only=True, slots=True)
class VolumeMesh:
    """Hexahedra through the wall."""

    points_mm: np.ndarray
    """Nodes [mm], shape (N, 3), float64."""
    cells: np.ndarray
    """Node numbers, shape (M, 8), int32, VTK order."""
    labels: np.ndarray
    """Bit mask of `Label` per node, shape (N,), uint8."""
    quality: np.ndarray
    """Scaled Jacobian per cell in [-1, 1], shape (M,), float32."""
    layers: int
    """Cells through the wall."""
    volume_mm3: float


@dataclass(frozen=True, kw_only=True, slots=True)
class MembraneMesh:
    """All meshes of one body. Skins share their vertices with the hexahedra."""

    hexes: VolumeMesh
    outer: Skin
    """The sensing surface: what contact and images use."""
    inner: Skin
    """The face bonded to the rigid support."""
    cavity: Skin
    """Inner face of the support, where light leaves the air; normals point out of the sensor."""


@dataclass(frozen=True, kw_only=True, slots=True)
class MaterialPoints:
    """Material points on a reference lattice: 2x2x2 in each grid cell.

    Grid node (i, j, k) lies at grid_mm * (i, j, k); cell (i, j, k) is centred on that node and
    reaches half a cell to each side; point p = 4 bx + 2 by + bz lies at a quarter cell toward -
    (bit 0) or + (bit 1) on each axis.
    """

    grid_mm: float
    cells: np.ndarray
    """Integer node coordinates of cells that hold material, shape (C, 3), int32, sorted."""
    fractions: np.ndarray
    """Filled fraction of each of the 8 sub-cells, shape (C, 8), float32 in [0, 1]."""

    @property
    def volume_mm3(self) -> float:
        """Volume of all points [mm3]."""
        return float(self.fractions.sum(dtype=np.float64)) * self.grid_mm**3 / 8

    @property
    def count(self) -> int:
        """Points with any volume."""
        return int(np.count_nonzero(self.fractions))


@dataclass(frozen=True, kw_only=True, slots=True)
class Contact:
    """What the solver found, frame by frame. Forces act on the indenter, in the sensor frame."""

    displacement_mm: np.ndarray
    """Displacement of the outer skin's vertices [mm], shape (K, V, 3), float32."""
    reaction_N: np.ndarray
    """Force on the indenter [N], shape (K, 3), float64."""
    moment_Nmm: np.ndarray
    """Moment on the indenter about its own origin [N mm], shape (K, 3), float64."""
    indenter_pose: np.ndarray
    """x, y, z [mm], qw, qx, qy, qz of the indenter's body frame, shape (K, 7), float64."""
    residual: np.ndarray
    """Out-of-balance force over the larger of reaction and 1 % of the peak reaction, shape (K,)."""
    penetration_mm: np.ndarray
    """Deepest overlap of skin and indenter [mm], shape (K,), float64."""
    support_N: np.ndarray
    """Force of the rigid support on the membrane [N], shape (K, 3), float64."""
    cut_N: np.ndarray
    """Force of elastomer left out of the region on the part that took part [N], shape (K, 3).

    reaction = support + cut, to within the residual.
    """
    friction_ratio: np.ndarray
    """Largest pointwise tangential over normal contact force, shape (K,), float64."""
    sliding: np.ndarray
    """Outer vertices whose contact slips, shape (K, V), bool."""
    target_mm: np.ndarray
    """Target on the undeformed skin [mm], shape (3,), float64."""
    normal: np.ndarray
    """Outward unit normal there, shape (3,), float64."""
    tangent_u: np.ndarray
    """Unit U: +Z projected on the tangent plane, shape (3,), float64."""
    grid_mm: float
    active_radius_mm: float
    """Radius of the region that took part, about the target [mm]."""
    particles: int
    """Material points in the active region."""
    substeps: int
    """Relaxation steps of all frames together."""
    device: str

    @property
    def normal_N(self) -> np.ndarray:
        """Reaction along the outward target normal [N], shape (K,)."""
        return self.reaction_N @ self.normal


@dataclass(frozen=True, kw_only=True, slots=True)
class LightField:
    """Light arriving at each outer vertex from each LED, independent of the camera."""

    model: str
    """Name of the `LightModel`."""
    direction: np.ndarray
    """Unit vector from vertex to light along its path, shape (L, V, 3), float32."""
    irradiance: np.ndarray
    """Perpendicular irradiance of the undeformed vertex, shadowed, shape (L, V), float32."""
    led_mm: np.ndarray
    """LED positions [mm], shape (L, 3), float64."""
    led_axis: np.ndarray
    """Unit emission axes, shape (L, 3), float64."""
    led_rgb: np.ndarray
    """Linear RGB power, shape (L, 3), float64."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TactileFrames:
    """Images of a press: frame 0 of `rgb` is the background, then one per contact frame."""

    rgb: np.ndarray
    """sRGB images, shape (1 + K, H, W, 3), uint8."""
    depth_z_mm: np.ndarray
    """Depth along the optical axis [mm], not the range; (1 + K, H, W), float32, NaN misses."""
    normal: np.ndarray
    """Unit normals facing the camera, sensor frame, shape (1 + K, H, W, 3), float16."""
    moved: np.ndarray
    """Pixels that see a displaced part of the skin, shape (1 + K, H, W), bool."""
    marker_uv_px: np.ndarray
    """Marker centres [px], shape (1 + K, M, 2), float32; NaN when hidden."""
    exposure: float
    """Gain from linear radiance to display value, chosen once per design."""


@dataclass(frozen=True, kw_only=True, slots=True)
class MouldPart:
    """One printable part."""

    name: str
    points_mm: np.ndarray
    """Vertices [mm], shape (N, 3), float64, in the mould's assembled position."""
    faces: np.ndarray
    """Triangles, shape (M, 3), int32."""
    brep: np.ndarray
    """OCCT text of the body, shape (bytes,), uint8."""
    volume_mm3: float
    watertight: bool
    explode: tuple[float, float, float]
    """Direction and distance of the exploded view [mm]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class MouldSet:
    """All parts of a mould."""

    parts: tuple[MouldPart, ...]
    split_azimuth_deg: float
    """Azimuth of the pull direction of half A [degree]."""
    overlap_mm3: float
    """Largest pairwise overlap of parts, and of parts with the cast body [mm3]."""
    thinnest_wall_mm: float
    cast_volume_mm3: float
    """Silicone in the cavity [mm3]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Metrics:
    """Scalars of a variant by name; each name ends in its unit."""

    values: dict[str, float]


@dataclass(frozen=True, kw_only=True, slots=True)
class Shot:
    """What the camera saw during a press, and the measures of it."""

    frames: TactileFrames
    metrics: Metrics


@dataclass(frozen=True, kw_only=True, slots=True)
class Picture:
    """A rendered picture."""

    png: np.ndarray
    """Bytes of a PNG file, shape (bytes,), uint8."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Bundle:
    """Files ready to be written or downloaded."""

    files: dict[str, np.ndarray]
    """Bytes of each file by name, shape (bytes,), uint8."""
