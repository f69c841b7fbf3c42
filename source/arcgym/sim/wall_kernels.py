# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What the walls of both kinds share: vertices with mass and anchor, contact, the start and the end of a step.

W worlds, V wall vertices; arrays of vertices have the shape (V, W), so that neighbouring GPU threads, which work on
neighbouring worlds, read neighbouring memory.
"""

import warp as wp

from arcgym.sim.anchor_kernels import Anchors, anchor_hessian, anchor_pull
from arcgym.sim.contact_kernels import ContactLaw, ContactRecords, LinkShapes, slip_scale, touch
from arcgym.sim.geometry_kernels import corner_point
from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class WallNodes:
    """Vertices of one world's wall, shared by all worlds."""

    mass: wp.array(dtype=float)  # [kg], shape (V,)
    mobile: wp.array(dtype=int)  # 1 where the vertex moves, shape (V,)
    anchors: Anchors


@wp.struct
class Tissue:
    """What may differ from world to world."""

    moduli: wp.array(dtype=wp.vec3)  # shear, second Lame parameter, bending: solid [Pa, Pa, -], shell [N/m, N/m, N m]
    anchor: wp.array(dtype=float)  # factor on the anchor springs, shape (W,)
    rigid: wp.array(dtype=int)  # 1 where the whole wall stays where it is, shape (W,)


@wp.struct
class VertexBlock:
    """Force [N] on one vertex and the positive definite part of its Hessian [N/m]."""

    force: wp.vec3
    hessian: wp.mat33


@wp.func
def inertia_and_anchor(
    nodes: WallNodes, tissue: Tissue, inertial: wp.vec3, x: wp.vec3, i: int, w: int, inv_dt2: float
) -> VertexBlock:
    """Block of the vertex's inertia and of its spring to the rest position."""
    inertia = nodes.mass[i] * inv_dt2
    scale = tissue.anchor[w]
    block = VertexBlock()
    block.force = inertia * (inertial - x) + scale * anchor_pull(nodes.anchors, i, x)
    block.hessian = inertia * wp.identity(n=3, dtype=float) + scale * anchor_hessian(nodes.anchors, i, x)
    return block


@wp.func
def add_contact(
    block: VertexBlock,
    records: ContactRecords,
    links: LinkShapes,
    law: ContactLaw,
    friction: float,
    link_count: int,
    dt: float,
    x: wp.array2d(dtype=wp.vec3),
    x_prev: wp.array2d(dtype=wp.vec3),
    body_q: wp.array(dtype=wp.transform),
    body_q_prev: wp.array(dtype=wp.transform),
    vertex: int,
    w: int,
) -> VertexBlock:
    """Add the contacts listed for ``vertex`` of world ``w``; friction works on the slip of this step."""
    out = block
    eye = wp.identity(n=3, dtype=float)
    entry = records.vertex_head[vertex, w]
    while entry >= 0:
        slot = entry // 3
        row = slot // records.capacity
        link = row % link_count
        f = records.face[slot]
        u = records.bary[slot]
        weight = u[entry - 3 * slot]
        p = corner_point(x, f, u, w)
        c = touch(p, records.normal[slot], body_q[row], links.half_length[link], links.radius[link] + law.wall_radius)
        if c.gap < 0.0:
            push = -law.stiffness * c.gap
            n = c.normal
            out.force += weight * push * n
            out.hessian += (weight * weight * law.stiffness) * wp.outer(n, n)
            if friction > 0.0:
                before = corner_point(x_prev, f, u, w)
                local = wp.transform_point(wp.transform_inverse(body_q[row]), p)
                slip = wp.transform_point(body_q_prev[row], local) - before
                slip = slip - n * wp.dot(n, slip)
                drag = friction * push * slip_scale(wp.length(slip), law.slip_velocity * dt)
                out.force -= weight * drag * slip
                out.hessian += (weight * weight * drag) * (eye - wp.outer(n, n))
        entry = records.vertex_next[entry]
    return out


@wp.kernel
def predict(
    x: wp.array2d(dtype=wp.vec3),
    v: wp.array2d(dtype=wp.vec3),
    nodes: WallNodes,
    tissue: Tissue,
    decay: float,
    dt: float,
    x_prev: wp.array2d(dtype=wp.vec3),
    inertial: wp.array2d(dtype=wp.vec3),
):
    """Move mobile vertices on at their damped velocity; the result is also the inertial target. Launch (V, W)."""
    i, w = wp.tid()
    target = x[i, w]
    x_prev[i, w] = target
    if nodes.mobile[i] == 1 and tissue.rigid[w] == 0:
        target += decay * dt * v[i, w]
    inertial[i, w] = target
    x[i, w] = target


@wp.kernel
def finish(x_prev: wp.array2d(dtype=wp.vec3), dt: float, x: wp.array2d(dtype=wp.vec3), v: wp.array2d(dtype=wp.vec3)):
    """Velocity of the step. Launch (V, W)."""
    i, w = wp.tid()
    v[i, w] = (x[i, w] - x_prev[i, w]) / dt
