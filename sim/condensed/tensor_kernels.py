"""How the skin that is drawn moves with the nodes, from tensor to tensor."""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import taichi as ti
import taichi.math as tm

from sim.optics.light.kernel_types import FloatRows, IntegerRows, VectorRows


@ti.kernel
def follow(nodes: IntegerRows, weights: FloatRows, moved: VectorRows, found: VectorRows):
    """Displacement of vertices, (B, V), by that of nodes, (B, N); `Surface` is the twin."""
    vertices = nodes.shape[0]
    for at in range(found.shape[0] * vertices):
        press, vertex = at // vertices, at % vertices
        total = tm.vec3(0.0)
        for k in range(nodes.shape[1]):
            total += weights[vertex, k] * moved[press, nodes[vertex, k]]
        found[press, vertex] = total
