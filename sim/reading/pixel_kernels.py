"""Sums of what blocks of pixels say over the triangles that they see.

The plain twin is `pixels.gathered_plainly`.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import taichi as ti


@ti.kernel
def gather(
    starts: ti.types.ndarray(dtype=ti.i32, ndim=1),
    blocks: ti.types.ndarray(dtype=ti.i32, ndim=1),
    faces: ti.types.ndarray(dtype=ti.i32, ndim=2),
    light: ti.types.ndarray(dtype=ti.f64, ndim=3),
    corner_weights: ti.types.ndarray(dtype=ti.f64, ndim=2),
    says: ti.types.ndarray(dtype=ti.f64, ndim=3),
    products: ti.types.ndarray(dtype=ti.f64, ndim=3),
    pulls: ti.types.ndarray(dtype=ti.f64, ndim=2),
):
    """Fill products (f, 6, 6) and pulls (f, 6).

    Args:
        starts: Of each triangle's blocks in `blocks`, shape (f + 1,).
        blocks: Numbers of blocks, triangle by triangle.
        faces: Corners, shape (f, 3).
        light: Slopes of a vertex's radiance by its tilts, shape (n, 3 colours, 2).
        corner_weights: Of the triangle's corners in a block, shape (P, 3).
        says: Grey levels by radiance, residual and weight of each block and colour, (3, P, 3).
    """
    for f in range(faces.shape[0]):
        total = ti.Matrix.zero(ti.f64, 6, 6)
        pull = ti.Vector.zero(ti.f64, 6)
        for at in range(starts[f], starts[f + 1]):
            block = blocks[at]
            for c in ti.static(range(3)):
                row = ti.Vector.zero(ti.f64, 6)
                for corner, way in ti.static(ti.ndrange(3, 2)):
                    share = corner_weights[block, corner] * says[0, block, c]
                    row[2 * corner + way] = share * light[faces[f, corner], c, way]
                weight = says[2, block, c]
                for i in ti.static(range(6)):
                    pull[i] += weight * row[i] * says[1, block, c]
                    for j in ti.static(range(i + 1)):
                        total[i, j] += weight * row[i] * row[j]
        for i in ti.static(range(6)):
            pulls[f, i] = pull[i]
            for j in ti.static(range(i + 1)):
                products[f, i, j] = total[i, j]
                products[f, j, i] = total[i, j]
