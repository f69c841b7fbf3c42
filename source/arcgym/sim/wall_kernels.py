# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Vertex block descent on the tetrahedral wall (Chen et al. 2024, "Vertex Block Descent", ACM TOG 43(4)).

The energy is the stable neo-Hookean of Newton's ``SolverVBD`` (Smith et al. 2018, ACM TOG 37(2)) with Newton's Lamé
parameters; force and Hessian of a vertex are written in closed form. Anchors are springs to the rest position.
"""

import warp as wp

from arcgym.sim.contact_kernels import ContactLaw, ContactRecords, LinkShapes, slip_scale, touch
from arcgym.sim.geometry_kernels import triangle_point
from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class WallElements:
    """One world's wall, shared by all worlds."""

    vertices: int  # V
    tets: wp.array(dtype=wp.vec4i)  # shape (T,)
    inv_rest: wp.array(dtype=wp.mat33)  # inverse rest edge matrix [1/m], shape (T,)
    lame: wp.array(dtype=wp.vec2)  # (mu, lambda) [Pa], shape (T,)
    volume: wp.array(dtype=float)  # rest volume [m^3], shape (T,)
    mass: wp.array(dtype=float)  # [kg], shape (V,)
    mobile: wp.array(dtype=int)  # 1 where the vertex moves, shape (V,)
    anchor: wp.array(dtype=float)  # spring to the rest position [N/m], shape (V,)
    rest: wp.array(dtype=wp.vec3)  # rest positions [m], shape (V,)
    entry_start: wp.array(dtype=int)  # first entry of each vertex, shape (V + 1,)
    entry: wp.array(dtype=int)  # 4 * tet + corner, shape (4*T,)


@wp.func
def shape_gradient(inv_rest: wp.mat33, corner: int) -> wp.vec3:
    """Gradient of the corner's linear shape function at rest [1/m]."""
    if corner == 0:
        return -(inv_rest[0] + inv_rest[1] + inv_rest[2])
    return inv_rest[corner - 1]


@wp.struct
class VertexBlock:
    """Force [N] on one vertex and the positive definite part of its Hessian [N/m]."""

    force: wp.vec3
    hessian: wp.mat33


@wp.func
def add_elastic(
    block: VertexBlock, wall: WallElements, x: wp.array(dtype=wp.vec3), base: int, i: int, scale: float
) -> VertexBlock:
    """Add the stable neo-Hookean terms of the tets around vertex ``i`` and its anchor.

    P = mu F + (la (J - 1) - mu) cof F, with la = lambda + mu; the Hessian keeps mu |m|^2 I + la g g^T, g = cof(F) m.
    """
    out = block
    eye = wp.identity(n=3, dtype=float)
    for k in range(wall.entry_start[i], wall.entry_start[i + 1]):
        entry = wall.entry[k]
        tet = entry // 4
        corners = wall.tets[tet]
        inv_rest = wall.inv_rest[tet]
        x0 = x[base + corners[0]]
        ds = wp.matrix_from_cols(x[base + corners[1]] - x0, x[base + corners[2]] - x0, x[base + corners[3]] - x0)
        f = ds * inv_rest
        f0 = wp.vec3(f[0, 0], f[1, 0], f[2, 0])
        f1 = wp.vec3(f[0, 1], f[1, 1], f[2, 1])
        f2 = wp.vec3(f[0, 2], f[1, 2], f[2, 2])
        c0 = wp.cross(f1, f2)
        c1 = wp.cross(f2, f0)
        c2 = wp.cross(f0, f1)
        m = shape_gradient(inv_rest, entry - 4 * tet)
        g = c0 * m[0] + c1 * m[1] + c2 * m[2]
        mu = scale * wall.lame[tet][0]
        la = scale * wall.lame[tet][1] + mu
        vol = wall.volume[tet]
        pressure = la * (wp.dot(f0, c0) - 1.0) - mu
        out.force -= vol * (mu * (f0 * m[0] + f1 * m[1] + f2 * m[2]) + pressure * g)
        out.hessian += vol * (la * wp.outer(g, g) + mu * wp.dot(m, m) * eye)
    out.force -= wall.anchor[i] * (x[base + i] - wall.rest[i])
    out.hessian += wall.anchor[i] * eye
    return out


@wp.func
def add_contact(
    block: VertexBlock,
    records: ContactRecords,
    links: LinkShapes,
    law: ContactLaw,
    friction: float,
    link_count: int,
    dt: float,
    x: wp.array(dtype=wp.vec3),
    x_prev: wp.array(dtype=wp.vec3),
    body_q: wp.array(dtype=wp.transform),
    body_q_prev: wp.array(dtype=wp.transform),
    vertex: int,
) -> VertexBlock:
    """Add the contacts listed for the global ``vertex``; friction works on the slip of this step."""
    out = block
    eye = wp.identity(n=3, dtype=float)
    entry = records.vertex_head[vertex]
    while entry >= 0:
        slot = entry // 3
        row = slot // records.capacity
        link = row % link_count
        f = records.face[slot]
        u = records.bary[slot]
        weight = u[entry - 3 * slot]
        p = triangle_point(x[f[0]], x[f[1]], x[f[2]], u)
        c = touch(p, records.normal[slot], body_q[row], links.half_length[link], links.radius[link] + law.wall_radius)
        if c.gap < 0.0:
            push = -law.stiffness * c.gap
            n = c.normal
            out.force += weight * push * n
            out.hessian += (weight * weight * law.stiffness) * wp.outer(n, n)
            if friction > 0.0:
                before = triangle_point(x_prev[f[0]], x_prev[f[1]], x_prev[f[2]], u)
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
    x: wp.array(dtype=wp.vec3),
    v: wp.array(dtype=wp.vec3),
    wall: WallElements,
    decay: float,
    dt: float,
    x_prev: wp.array(dtype=wp.vec3),
    inertial: wp.array(dtype=wp.vec3),
):
    """Move mobile vertices on at their damped velocity; the result is also the inertial target. Launch (W, V)."""
    w, i = wp.tid()
    k = w * wall.vertices + i
    x_prev[k] = x[k]
    target = x[k]
    if wall.mobile[i] == 1:
        target = x[k] + decay * dt * v[k]
    inertial[k] = target
    x[k] = target


@wp.kernel
def sweep_colour(
    colour: wp.array(dtype=int),
    wall: WallElements,
    stiffness_scale: wp.array(dtype=float),
    dt: float,
    inertial: wp.array(dtype=wp.vec3),
    x_prev: wp.array(dtype=wp.vec3),
    records: ContactRecords,
    links: LinkShapes,
    law: ContactLaw,
    friction: wp.array(dtype=float),
    link_count: int,
    body_q: wp.array(dtype=wp.transform),
    body_q_prev: wp.array(dtype=wp.transform),
    x: wp.array(dtype=wp.vec3),
):
    """One Newton step of every vertex of one colour, in place. Launch (W, len(colour))."""
    w, k = wp.tid()
    i = colour[k]
    base = w * wall.vertices
    inertia = wall.mass[i] / (dt * dt)
    block = VertexBlock()
    block.force = inertia * (inertial[base + i] - x[base + i])
    block.hessian = inertia * wp.identity(n=3, dtype=float)
    block = add_elastic(block, wall, x, base, i, stiffness_scale[w])
    block = add_contact(
        block, records, links, law, friction[w], link_count, dt, x, x_prev, body_q, body_q_prev, base + i
    )
    x[base + i] = x[base + i] + wp.inverse(block.hessian) * block.force


@wp.kernel
def residual(
    wall: WallElements,
    stiffness_scale: wp.array(dtype=float),
    dt: float,
    inertial: wp.array(dtype=wp.vec3),
    x_prev: wp.array(dtype=wp.vec3),
    records: ContactRecords,
    links: LinkShapes,
    law: ContactLaw,
    link_count: int,
    body_q: wp.array(dtype=wp.transform),
    x: wp.array(dtype=wp.vec3),
    force: wp.array(dtype=wp.vec3),
):
    """Total force on every mobile vertex, friction left out. Launch (W, V)."""
    w, i = wp.tid()
    base = w * wall.vertices
    block = VertexBlock()
    if wall.mobile[i] == 1:
        block.force = wall.mass[i] / (dt * dt) * (inertial[base + i] - x[base + i])
        block = add_elastic(block, wall, x, base, i, stiffness_scale[w])
        block = add_contact(block, records, links, law, 0.0, link_count, dt, x, x_prev, body_q, body_q, base + i)
    force[base + i] = block.force


@wp.kernel
def finish(x_prev: wp.array(dtype=wp.vec3), dt: float, x: wp.array(dtype=wp.vec3), v: wp.array(dtype=wp.vec3)):
    """Velocity of the step. Launch (W*V,)."""
    k = wp.tid()
    v[k] = (x[k] - x_prev[k]) / dt
