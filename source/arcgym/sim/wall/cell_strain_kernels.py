# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""One strain for the two triangles of a cell of the wall's grid.

A grid of triangles has six strains for the three coordinates of a vertex, so that it hardly bends without stretching:
it locks, the more the coarser it is. Here a cell has one strain, the mean of its triangles' metrics, weighted by their
areas (the uniform strain of Flanagan and Belytschko 1981, "A uniform strain hexahedron and quadrilateral with
orthogonal hourglass control"), and a small share of each triangle's own, which keeps the cell from changing its shape
where the mean does not see it.

What a triangle's own tension exceeds that of its cell by is measured with the triangles, and stands for the rest of the
step: the sweep's Hessian is that of the triangles, which are nowhere softer.
"""

import warp as wp

from arcgym.sim.wall.shell_kernels import SMALLEST, ShellElements
from arcgym.utils import warp_setup  # noqa: F401

KEPT = wp.constant(0.1)
"""Share of the triangles' own strains."""


@wp.struct
class Cells:
    """Pairs of triangles; F triangles, P patients, W worlds. Without cells the arrays are empty."""

    enabled: int
    partner: wp.array[int]  # other triangle of the cell, or the triangle itself, shape (F,)
    weight: wp.array2d[float]  # partner's share of the cell's area, shape (F, P)
    edges: wp.array2d[
        wp.mat33
    ]  # squares of the triangle's edges in the partner's strain by the partner's, shape (F, P)
    excess: wp.array2d[
        wp.vec3
    ]  # tension beyond the cell's, along the edges opposite to the corners [N/m], shape (F, W)


@wp.func
def squared_edges(shell: ShellElements, x: wp.array2d[wp.vec3], t: int, w: int) -> wp.vec3:
    """Return the squared lengths of the edges opposite to the corners of triangle ``t`` [m^2]."""
    corners = shell.triangles[t]
    x0 = x[corners[0], w]
    x1 = x[corners[1], w]
    x2 = x[corners[2], w]
    return wp.vec3(wp.length_sq(x2 - x1), wp.length_sq(x0 - x2), wp.length_sq(x1 - x0))


@wp.func
def tension_of_squares(squares: wp.vec3, rest: wp.vec4, moduli: wp.vec3, stiffening: float) -> wp.vec3:
    """Return the tension along the edges [N/m] as ``edge_tensions``, from their squared lengths [m^2]."""
    d12 = 0.5 * (squares[1] + squares[2] - squares[0])
    dots = wp.vec3(d12, squares[2] - d12, squares[1] - d12)
    unit = 4.0 * rest[3] * rest[3]
    square = wp.max(squares[1] * squares[2] - d12 * d12, SMALLEST * unit)
    excess = wp.max(rest[0] * squares[0] + rest[1] * squares[1] + rest[2] * squares[2] - 2.0, 0.0)
    s = rest[3] * moduli[0] * (1.0 + stiffening * excess * excess)
    k = rest[3] * (moduli[1] * 0.5 * wp.log(square / unit) - moduli[0]) / square
    return wp.vec3(s * rest[0] + k * dots[0], s * rest[1] + k * dots[1], s * rest[2] + k * dots[2])


@wp.func
def cell_excess(
    shell: ShellElements, cells: Cells, x: wp.array2d[wp.vec3], t: int, w: int, moduli: wp.vec3, stiffening: float
) -> wp.vec3:
    """Return by how much the tension of triangle ``t`` of world ``w`` exceeds that of its cell [N/m]."""
    other = cells.partner[t]
    if other == t:
        return wp.vec3(0.0)
    p = shell.patient[w]
    rest = shell.rest[t, p]
    own = squared_edges(shell, x, t, w)
    weight = cells.weight[t, p]
    mean = (1.0 - weight) * own + weight * (cells.edges[t, p] * squared_edges(shell, x, other, w))
    beyond = tension_of_squares(own, rest, moduli, stiffening) - tension_of_squares(mean, rest, moduli, stiffening)
    return (1.0 - KEPT) * beyond
