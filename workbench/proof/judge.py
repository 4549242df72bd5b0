"""What each row of `workbench validate` is judged by: an exact answer, others, or ourselves.

A comparison of the product with itself says that it is consistent, not that it is right; it is
called so, in the table, in `--json` as `against`, and on the page `trust.md`. Where the cases of a
row differ, a part of the case decides.
"""

from __future__ import annotations

import dataclasses
import enum
from collections.abc import Sequence

from workbench.proof.row import Row


class Judge(enum.StrEnum):
    """By what a row is judged."""

    EXACT = "closed form"
    """An exact answer: a formula, a law of nature, a definition."""
    OUTSIDE = "outside reference"
    """Another program, a publication or a photograph: CalculiX, Mitsuba, the released bodies."""
    LIMIT = "converged limit"
    """What our own values tend to on ever finer meshes."""
    ITSELF = "itself"
    """The product another way: mirrored, divided more finely, by another of its solvers."""
    NONE = "target"
    """A number that the project set itself: a count, a time, a rate."""


_EXACT = """
bonded_block_force contact_radius flat_punch cylinder_line bonded_layer_reference backed_block_force
backed_block_shear force_balance moment_balance coulomb_limit slip_ratio partial_slip
release_force patch_test rigid_rotation stiffness_tripled moment_of_smooth_sphere friction_cone
projection field_of_view snell fresnel optical_axis plane_tangency irradiance depth_z energy furnace
flat_furnace reciprocity plane_irradiance slab total_reflection sensor_noise defocus spectrum
hertz_force hertz_radius hertz_force_order hertz_radius_order release virtual_leds
learned_sparse_equals_dense exact_background cad_volume outer_area skin_on_surface coating_lobe
coating_reciprocity coating_energy coating_head_on led_flux led_share vignetting plane_closed_form
"""
_OUTSIDE = """
published_pad finger_45_normal_force refinement refinement_calculix fem_limit mpm_limit
fem_error_estimate
calculix calculix_same_mesh mitsuba mitsuba_product mitsuba_octant
mitsuba_recorded mitsuba_recorded_places mitsuba_recorded_error mitsuba_recorded_whole
mitsuba_record_again membrane_shape membrane_shape_95 indenter_shape idle_photo idle_photo_structure
idle_photo_balance idle_photo_oval
"""
_LIMIT = """
finger_45 published_mode mpm_against_fem_limit mpm_refinement fem_refinement
"""
_ITSELF = """
slip_share slip_share_mesh gross_slip slip_ratio_global one_number
region_error residual frame_size mirror mirror_symmetry rotation increments submodel submodel_worst
lattice_shift determinism cpu_gpu mpm_against_fem sheared_sphere shear_force direct_table
table_brightness contact_tangent friction_tangent contact_energy raster newton_projection
frame_depth published_depth map_sensitivity surface_detail ceiling hybrid table direct linear
plane_target plane_source
plane_normal geodesic rest_image gain
gain_value fem_matrix_repeated surface_volume hex_volume lattice_volume
"""
_NONE = """
release_substeps penetration dent_change fem_matrix fem_matrix_cpu fem_matrix_residual watertight
hex_scaled_jacobian mould_overlap mould_watertight mould_thinnest_wall memory_growth contact_seen
reading_batch reading_learned reading_table search_gain
"""
JUDGES = {
    **dict.fromkeys(_EXACT.split(), Judge.EXACT),
    **dict.fromkeys(_OUTSIDE.split(), Judge.OUTSIDE),
    **dict.fromkeys(_LIMIT.split(), Judge.LIMIT),
    **dict.fromkeys(_ITSELF.split(), Judge.ITSELF),
    **dict.fromkeys(_NONE.split(), Judge.NONE),
}
"""By name of the row."""
BEGINNINGS = {
    "learned_inference_": Judge.NONE,
    "learned_advice": Judge.NONE,
    "learned_": Judge.ITSELF,
    "labels_": Judge.ITSELF,
    "reading_": Judge.ITSELF,
    "task_": Judge.ITSELF,
    "fast_": Judge.ITSELF,
    "search_": Judge.ITSELF,
    "sensor_": Judge.NONE,
    "hex_": Judge.NONE,
    "mould_": Judge.NONE,
    "parts_": Judge.NONE,
    "sweep_": Judge.NONE,
    "robustness_": Judge.NONE,
}
"""By the beginning of names of which there is one for each family, split or size."""
BY_CASE = {
    ("finger_45_normal_force", "on record"): Judge.LIMIT,
    ("mpm_against_fem", "normal force"): Judge.LIMIT,
    ("rotation", "moment that resists"): Judge.EXACT,
    ("rotation", "every point sliding"): Judge.EXACT,
}
"""By name and a part of the case, before the others."""


def judge(name: str, case: str = "") -> Judge:
    """By what a row is judged.

    Raises:
        KeyError: If nobody said so; a new row is entered above.
    """
    for (row, part), found in BY_CASE.items():
        if row == name and part in case:
            return found
    if name not in JUDGES:
        for beginning, found in BEGINNINGS.items():
            if name.startswith(beginning):
                return found
    return JUDGES[name]


def judged(rows: Sequence[Row]) -> list[Row]:
    """Rows, each with what it is judged by; None of one that nobody entered."""
    return [dataclasses.replace(row, against=_known(row)) for row in rows]


def _known(row: Row) -> str | None:
    try:
        return judge(row.name, row.case).value
    except KeyError:
        return None
