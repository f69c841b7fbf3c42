# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Force of what lies around the colon on every wall vertex, linear over a step. V vertices, R rings, W worlds."""

import warp as wp

from arcgym.sim.wall.block_tridiagonal_kernels import MODES, Unknowns
from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class OuterForce:
    """Force ``push - stiffness x`` on a vertex at x, measured at the start of a step.

    The stiffness is positive semidefinite. A ring that is not ``near`` anything has zeros.
    """

    ring: wp.array[int]  # ring of each vertex, shape (V,)
    push: wp.array2d[wp.vec3]  # [N], shape (V, W)
    stiffness: wp.array2d[wp.mat33]  # [N/m], shape (V, W)
    near: wp.array2d[int]  # 1 where something acts on a ring, shape (R, W)


@wp.func
def outer_force(outer: OuterForce, x: wp.vec3, i: int, w: int) -> wp.vec3:
    """Return the force on vertex ``i`` of world ``w`` at ``x`` [N]."""
    return outer.push[i, w] - outer.stiffness[i, w] * x


@wp.func
def put_outer_force(outer: OuterForce, i: int, w: int, x: wp.vec3, force: wp.vec3, stiffness: wp.mat33):
    """Add a force on vertex ``i`` of world ``w`` that is at ``x`` now, and its stiffness."""
    outer.push[i, w] = outer.push[i, w] + force + stiffness * x
    outer.stiffness[i, w] = outer.stiffness[i, w] + stiffness


@wp.func
def clear_outer_force(members: wp.array2d[int], outer: OuterForce, r: int, w: int):
    """Forget the last step's forces on ring ``r`` of world ``w``; ``members`` has shape (R, S), -1 padded."""
    if outer.near[r, w] == 0:
        return
    outer.near[r, w] = 0
    for k in range(members.shape[1]):
        i = members[r, k]
        if i >= 0:
            outer.push[i, w] = wp.vec3(0.0)
            outer.stiffness[i, w] = wp.mat33(0.0)


@wp.kernel
def add_outer_rows(
    members: wp.array2d[int],
    plane: wp.array2d[wp.vec2],
    moves: wp.array2d[int],
    patient: wp.array[int],
    rigid: wp.array[int],
    outer: OuterForce,
    diagonal: wp.array4d[float],
):
    """Add the stiffness to that of the rings' affine motions, see ``coarse_kernels``. Launch (R, W, M).

    Args:
        members: Vertices of each ring, -1 padded, shape (R, S).
        plane: Places of the vertices across their ring, shape (V, P).
        moves: 1 where a ring moves, shape (R, P).
        patient: Patient of each world, shape (W,).
        rigid: 1 where the whole wall stays where it is, shape (W,).
        outer: Forces.
        diagonal: Blocks of the rings [N/m], shape (R, W, M, M); added to.
    """
    r, w, a = wp.tid()
    p = patient[w]
    if outer.near[r, w] == 0 or moves[r, p] == 0 or rigid[w] == 1:
        return
    row = Unknowns()
    for j in range(members.shape[1]):
        i = members[r, j]
        if i >= 0:
            fields = wp.vec3(1.0, plane[i, p][0], plane[i, p][1])
            pull = fields[a / 3] * outer.stiffness[i, w][a % 3]
            for k in range(3):
                for c in range(3):
                    row[3 * k + c] = row[3 * k + c] + fields[k] * pull[c]
    for b in range(MODES):
        diagonal[r, w, a, b] = diagonal[r, w, a, b] + row[b]
