# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Coarse correction of the wall: every ring moves affinely in its plane, x_i += a + p_i u + q_i v (9 unknowns a ring).

The matrix is block tridiagonal: rest stiffness turned with each ring, inertia, anchors and the stiffness of the
contacts at hand. Launch dimensions: W worlds, R rings, V wall vertices.
"""

import warp as wp

from arcgym.sim.chain_kernels import Unknowns
from arcgym.sim.contact_kernels import ContactLaw, ContactRecords, LinkShapes, touch
from arcgym.sim.geometry_kernels import triangle_point
from arcgym.utils import warp_setup  # noqa: F401

UNKNOWNS = wp.constant(9)


@wp.struct
class RingSpace:
    """Affine ring modes of one world's wall, shared by all worlds."""

    vertices: int  # V
    ring: wp.array(dtype=int)  # ring of each vertex, shape (V,)
    weights: wp.array(dtype=wp.vec3)  # (1, p, q) of each vertex, zero where it is held, shape (V,)
    members: wp.array2d(dtype=int)  # vertices of each ring, -1 padded, shape (R, S)
    frame_weights: wp.array(dtype=wp.vec3)  # (1, p, q) of every vertex, held ones too, shape (V,)
    rest_frame: wp.array(dtype=wp.mat33)  # rest ring frame, columns p, q, p x q, shape (R,)
    stiffness: wp.array3d(dtype=float)  # rest diagonal blocks [N/m], shape (R, 9, 9)
    coupling: wp.array3d(dtype=float)  # rest blocks to the next ring [N/m], shape (R, 9, 9)
    mass: wp.array3d(dtype=float)  # [kg], shape (R, 9, 9)
    anchor: wp.array3d(dtype=float)  # [N/m], shape (R, 9, 9)


@wp.kernel
def ring_rotations(x: wp.array(dtype=wp.vec3), space: RingSpace, rotation: wp.array2d(dtype=wp.mat33)):
    """Rotation of each ring since rest. Launch (W, R)."""
    w, r = wp.tid()
    p = wp.vec3(0.0)
    q = wp.vec3(0.0)
    for k in range(space.members.shape[1]):
        i = space.members[r, k]
        if i >= 0:
            xi = x[w * space.vertices + i]
            p += space.frame_weights[i][1] * xi
            q += space.frame_weights[i][2] * xi
    p = wp.normalize(p)
    q = wp.normalize(q - p * wp.dot(p, q))
    rotation[w, r] = wp.matrix_from_cols(p, q, wp.cross(p, q)) * wp.transpose(space.rest_frame[r])


@wp.func
def ring_share(space: RingSpace, f: wp.vec3i, u: wp.vec3, base: int, r: int) -> wp.vec3:
    """Weights (1, p, q) with which ring ``r`` moves the contact point ``u`` of face ``f``."""
    out = wp.vec3(0.0)
    for k in range(3):
        if space.ring[f[k] - base] == r:
            out += u[k] * space.weights[f[k] - base]
    return out


@wp.func
def turned_row(blocks: wp.array3d(dtype=float), turn: wp.mat33, r: int, i: int, m: int) -> Unknowns:
    """Row (i, m) of a rest block whose left-hand axes are turned: sum over i2 of turn[i, i2] block[(i2, m), :]."""
    out = Unknowns()
    for c in range(9):
        out[c] = turn[i, 0] * blocks[r, m, c] + turn[i, 1] * blocks[r, 3 + m, c] + turn[i, 2] * blocks[r, 6 + m, c]
    return out


@wp.kernel
def assemble(
    x: wp.array(dtype=wp.vec3),
    force: wp.array(dtype=wp.vec3),
    space: RingSpace,
    rotation: wp.array2d(dtype=wp.mat33),
    stiffness_scale: wp.array(dtype=float),
    inv_dt2: float,
    shift: float,
    records: ContactRecords,
    links: LinkShapes,
    law: ContactLaw,
    link_count: int,
    body_q: wp.array(dtype=wp.transform),
    diagonal: wp.array4d(dtype=float),
    upper: wp.array4d(dtype=float),
    rhs: wp.array3d(dtype=float),
):
    """One row of the system: unknown ``a`` of ring ``r``. Launch (W, R, 9)."""
    w, r, a = wp.tid()
    rings = space.stiffness.shape[0]
    i = a // 3
    m = a - 3 * i
    turn = rotation[w, r]
    own_row = turned_row(space.stiffness, turn, r, i, m)
    next_turn = rotation[w, wp.min(r + 1, rings - 1)]
    next_row = turned_row(space.coupling, turn, r, i, m)
    scale = stiffness_scale[w]
    for c in range(UNKNOWNS):
        j = c // 3
        n = c - 3 * j
        s = own_row[n] * turn[j, 0] + own_row[3 + n] * turn[j, 1] + own_row[6 + n] * turn[j, 2]
        o = next_row[n] * next_turn[j, 0] + next_row[3 + n] * next_turn[j, 1] + next_row[6 + n] * next_turn[j, 2]
        diagonal[w, r, a, c] = scale * s + inv_dt2 * space.mass[r, a, c] + space.anchor[r, a, c]
        upper[w, r, a, c] = scale * o
    diagonal[w, r, a, a] = diagonal[w, r, a, a] * (1.0 + shift) + 1.0e-6
    total = float(0.0)
    base = w * space.vertices
    for k in range(space.members.shape[1]):
        v = space.members[r, k]
        if v >= 0:
            total += space.weights[v][m] * force[base + v][i]
    rhs[w, r, a] = total
    for which in range(2):
        lowest = r - which
        slot = int(-1)
        if lowest >= 0:
            slot = records.ring_head[w * rings + lowest]
        while slot >= 0:
            row = slot // records.capacity
            link = row % link_count
            f = records.face[slot]
            u = records.bary[slot]
            p = triangle_point(x[f[0]], x[f[1]], x[f[2]], u)
            t = touch(
                p, records.normal[slot], body_q[row], links.half_length[link], links.radius[link] + law.wall_radius
            )
            if t.gap < 0.0:
                own = ring_share(space, f, u, base, r)
                mine = law.stiffness * t.normal[i] * own[m]
                for c in range(UNKNOWNS):
                    j = c // 3
                    n = c - 3 * j
                    diagonal[w, r, a, c] = diagonal[w, r, a, c] + mine * t.normal[j] * own[n]
                if which == 0 and r + 1 < rings:
                    other = ring_share(space, f, u, base, r + 1)
                    for c in range(UNKNOWNS):
                        j = c // 3
                        n = c - 3 * j
                        upper[w, r, a, c] = upper[w, r, a, c] + mine * t.normal[j] * other[n]
            slot = records.ring_next[slot]


@wp.kernel
def prolong(space: RingSpace, solution: wp.array3d(dtype=float), largest_move: float, x: wp.array(dtype=wp.vec3)):
    """Move every vertex with its ring, at most ``largest_move`` [m]. Launch (W, V)."""
    w, i = wp.tid()
    r = space.ring[i]
    weight = space.weights[i]
    d = wp.vec3(0.0)
    for k in range(3):
        d[k] = (
            solution[w, r, 3 * k] * weight[0]
            + solution[w, r, 3 * k + 1] * weight[1]
            + solution[w, r, 3 * k + 2] * weight[2]
        )
    length = wp.length(d)
    if length > largest_move:
        d = d * (largest_move / length)
    x[w * space.vertices + i] = x[w * space.vertices + i] + d
