# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Vertex block descent on a thin shell: stretching triangles and bending hinges, in closed form.

Membrane: St. Venant-Kirchhoff in plane stress. Bending: discrete shells (Grinspun et al. 2003, "Discrete Shells",
SCA), with the Gauss-Newton part of the Hessian. Both are the energies of Newton's ``SolverVBD``.
"""

import warp as wp

from arcgym.sim.contact_kernels import ContactLaw, ContactRecords, LinkShapes
from arcgym.sim.wall_kernels import Tissue, VertexBlock, WallNodes, add_contact, inertia_and_anchor
from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class ShellElements:
    """Triangles and hinges of one world's wall, shared by all worlds."""

    triangles: wp.array(dtype=wp.vec3i)  # shape (F,)
    inv_rest: wp.array(dtype=wp.mat22)  # inverse rest edge matrix in the triangle's plane [1/m], shape (F,)
    area: wp.array(dtype=float)  # rest area [m^2], shape (F,)
    hinges: wp.array(dtype=wp.vec4i)  # two opposite vertices, then the edge from start to end, shape (H,)
    rest_angle: wp.array(dtype=float)  # dihedral angle at rest [rad], shape (H,)
    weight: wp.array(dtype=float)  # stiffness over flexural rigidity, shape (H,)
    triangle_start: wp.array(dtype=int)  # first triangle entry of each vertex, shape (V + 1,)
    triangle_entry: wp.array(dtype=int)  # 3 * triangle + corner, shape (3*F,)
    hinge_start: wp.array(dtype=int)  # first hinge entry of each vertex, shape (V + 1,)
    hinge_entry: wp.array(dtype=int)  # 4 * hinge + corner, shape (4*H,)


@wp.func
def add_stretching(
    block: VertexBlock, shell: ShellElements, x: wp.array2d(dtype=wp.vec3), i: int, w: int, moduli: wp.vec3
) -> VertexBlock:
    """Add the membrane terms of the triangles around vertex ``i`` of world ``w``.

    With G = (F^T F - I) / 2, S = 2 mu G + lambda tr(G) I and the corner's shape gradient m: force -A F S m; the
    Hessian keeps A ((mu + lambda) g g^T + mu |m|^2 F F^T + max(m.S m, 0) I), g = F m.
    """
    out = block
    mu = moduli[0]
    lam = moduli[1]
    for k in range(shell.triangle_start[i], shell.triangle_start[i + 1]):
        entry = shell.triangle_entry[k]
        triangle = entry // 3
        corner = entry - 3 * triangle
        corners = shell.triangles[triangle]
        inv_rest = shell.inv_rest[triangle]
        x0 = x[corners[0], w]
        d1 = x[corners[1], w] - x0
        d2 = x[corners[2], w] - x0
        f1 = d1 * inv_rest[0, 0] + d2 * inv_rest[1, 0]
        f2 = d1 * inv_rest[0, 1] + d2 * inv_rest[1, 1]
        m = -(inv_rest[0] + inv_rest[1])
        if corner > 0:
            m = inv_rest[corner - 1]
        g11 = 0.5 * (wp.dot(f1, f1) - 1.0)
        g22 = 0.5 * (wp.dot(f2, f2) - 1.0)
        g12 = 0.5 * wp.dot(f1, f2)
        trace = lam * (g11 + g22)
        sm = wp.vec2(
            (2.0 * mu * g11 + trace) * m[0] + 2.0 * mu * g12 * m[1],
            2.0 * mu * g12 * m[0] + (2.0 * mu * g22 + trace) * m[1],
        )
        g = f1 * m[0] + f2 * m[1]
        area = shell.area[triangle]
        out.force -= area * (f1 * sm[0] + f2 * sm[1])
        out.hessian += (area * (mu + lam)) * wp.outer(g, g)
        out.hessian += (area * mu * wp.dot(m, m)) * (wp.outer(f1, f1) + wp.outer(f2, f2))
        out.hessian += (area * wp.max(wp.dot(m, sm), 0.0)) * wp.identity(n=3, dtype=float)
    return out


@wp.struct
class Fold:
    """Angle of a hinge [rad] and its gradient with respect to one of the four vertices [rad/m]."""

    angle: float
    gradient: wp.vec3


@wp.func
def fold(x0: wp.vec3, x1: wp.vec3, x2: wp.vec3, x3: wp.vec3, corner: int) -> Fold:
    """Dihedral angle between the triangles (x0, x2, x3) and (x1, x3, x2), zero where they are coplanar."""
    edge = x3 - x2
    length = wp.length(edge)
    n0 = wp.cross(x2 - x0, x3 - x0)
    n1 = wp.cross(x3 - x1, x2 - x1)
    out = Fold()
    out.angle = wp.atan2(wp.dot(wp.cross(n0, n1), edge) / length, wp.dot(n0, n1))
    g0 = n0 * (-length / wp.length_sq(n0))
    g1 = n1 * (-length / wp.length_sq(n1))
    inv = 1.0 / (length * length)
    t0 = wp.dot(x0 - x2, edge) * inv
    t1 = wp.dot(x1 - x2, edge) * inv
    if corner == 0:
        out.gradient = g0
    elif corner == 1:
        out.gradient = g1
    elif corner == 2:
        out.gradient = (t0 - 1.0) * g0 + (t1 - 1.0) * g1
    else:
        out.gradient = -t0 * g0 - t1 * g1
    return out


@wp.func
def add_bending(
    block: VertexBlock, shell: ShellElements, x: wp.array2d(dtype=wp.vec3), i: int, w: int, moduli: wp.vec3
) -> VertexBlock:
    """Add the terms k (angle - rest)^2 / 2 of the hinges around vertex ``i`` of world ``w``."""
    out = block
    for k in range(shell.hinge_start[i], shell.hinge_start[i + 1]):
        entry = shell.hinge_entry[k]
        hinge = entry // 4
        corners = shell.hinges[hinge]
        now = fold(x[corners[0], w], x[corners[1], w], x[corners[2], w], x[corners[3], w], entry - 4 * hinge)
        stiffness = moduli[2] * shell.weight[hinge]
        out.force -= (stiffness * (now.angle - shell.rest_angle[hinge])) * now.gradient
        out.hessian += stiffness * wp.outer(now.gradient, now.gradient)
    return out


@wp.func
def add_elastic(
    block: VertexBlock, shell: ShellElements, x: wp.array2d(dtype=wp.vec3), i: int, w: int, moduli: wp.vec3
) -> VertexBlock:
    """Add stretching and bending around vertex ``i`` of world ``w``."""
    return add_bending(add_stretching(block, shell, x, i, w, moduli), shell, x, i, w, moduli)


@wp.kernel
def sweep_colour(
    colour: wp.array(dtype=int),
    nodes: WallNodes,
    shell: ShellElements,
    tissue: Tissue,
    dt: float,
    inertial: wp.array2d(dtype=wp.vec3),
    x_prev: wp.array2d(dtype=wp.vec3),
    records: ContactRecords,
    links: LinkShapes,
    law: ContactLaw,
    friction: wp.array(dtype=float),
    link_count: int,
    body_q: wp.array(dtype=wp.transform),
    body_q_prev: wp.array(dtype=wp.transform),
    x: wp.array2d(dtype=wp.vec3),
):
    """One Newton step of every vertex of one colour, in place. Launch (len(colour), W)."""
    k, w = wp.tid()
    if tissue.rigid[w] == 1:
        return
    i = colour[k]
    block = inertia_and_anchor(nodes, tissue, inertial[i, w], x[i, w], i, w, 1.0 / (dt * dt))
    block = add_elastic(block, shell, x, i, w, tissue.moduli[w])
    block = add_contact(block, records, links, law, friction[w], link_count, dt, x, x_prev, body_q, body_q_prev, i, w)
    x[i, w] = x[i, w] + wp.inverse(block.hessian) * block.force


@wp.kernel
def residual(
    nodes: WallNodes,
    shell: ShellElements,
    tissue: Tissue,
    dt: float,
    inertial: wp.array2d(dtype=wp.vec3),
    records: ContactRecords,
    links: LinkShapes,
    law: ContactLaw,
    link_count: int,
    body_q: wp.array(dtype=wp.transform),
    x: wp.array2d(dtype=wp.vec3),
    force: wp.array2d(dtype=wp.vec3),
):
    """Total force on every mobile vertex, friction left out. Launch (V, W)."""
    i, w = wp.tid()
    block = VertexBlock()
    if nodes.mobile[i] == 1 and tissue.rigid[w] == 0:
        block = inertia_and_anchor(nodes, tissue, inertial[i, w], x[i, w], i, w, 1.0 / (dt * dt))
        block = add_elastic(block, shell, x, i, w, tissue.moduli[w])
        block = add_contact(block, records, links, law, 0.0, link_count, dt, x, x, body_q, body_q, i, w)
    force[i, w] = block.force
