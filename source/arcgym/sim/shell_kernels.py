# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Vertex block descent on a thin shell: stretching triangles and bending hinges, in closed form.

Membrane: St. Venant-Kirchhoff in plane stress. Bending: discrete shells (Grinspun et al. 2003, "Discrete Shells",
SCA), with the Gauss-Newton part of the Hessian. Both are the energies of Newton's ``SolverVBD``.

What several vertices need is measured once a step for each element: the normals and corner forces of the triangles, and
the angles of the hinges. A hinge's angle is then linear in the moves of its vertices for the rest of the step, which
spares the sweep its normals and inverse tangents.
"""

import warp as wp

from arcgym.sim.contact_kernels import ContactLaw, ContactRecords, LinkShapes
from arcgym.sim.geometry_kernels import shortened
from arcgym.sim.wall_kernels import (
    Pressing,
    Tissue,
    VertexBlock,
    WallNodes,
    add_contact,
    contact_force,
    inertia_and_anchor,
)
from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class ShellElements:
    """Triangles and hinges of one world's wall, shared by all worlds, and what is measured of them in each."""

    triangles: wp.array(dtype=wp.vec3i)  # shape (F,)
    inv_rest: wp.array(dtype=wp.mat22)  # inverse rest edge matrix in the triangle's plane [1/m], shape (F,)
    area: wp.array(dtype=float)  # rest area [m^2], shape (F,)
    hinges: wp.array(dtype=wp.vec4i)  # two opposite vertices, then the edge from start to end, shape (H,)
    sides: wp.array(dtype=wp.vec2i)  # the triangles of the two opposite vertices, shape (H,)
    foot: wp.array(dtype=wp.vec2)  # where along the edge the opposite vertices stand at rest, 0 to 1, shape (H,)
    length: wp.array(dtype=float)  # rest length of the edge [m], shape (H,)
    rest_angle: wp.array(dtype=float)  # dihedral angle at rest [rad], shape (H,)
    weight: wp.array(dtype=float)  # stiffness over flexural rigidity, shape (H,)
    triangle_start: wp.array(dtype=int)  # first triangle entry of each vertex, shape (V + 1,)
    triangle_entry: wp.array(dtype=int)  # 3 * triangle + corner, shape (3*F,)
    hinge_start: wp.array(dtype=int)  # first hinge entry of each vertex, shape (V + 1,)
    hinge_entry: wp.array(dtype=int)  # 4 * hinge + corner, shape (4*H,)
    tilt: wp.array2d(dtype=wp.vec3)  # normal over its squared length, normal = edge x edge [1/m^2], shape (F, W)
    corner_force: wp.array2d(dtype=wp.vec3)  # membrane force on each corner [N], shape (3*F, W)
    bend: wp.array2d(dtype=float)  # angle of each hinge from rest [rad], shape (H, W)
    offset: wp.array2d(dtype=float)  # the same less its linear part, shape (H, W)


@wp.struct
class Stretch:
    """Deformation of a triangle and its stress."""

    f1: wp.vec3  # columns of the deformation gradient
    f2: wp.vec3
    stress: wp.vec3  # second Piola-Kirchhoff times thickness: 11, 22, 12 [N/m]


@wp.func
def stretch_of(x0: wp.vec3, x1: wp.vec3, x2: wp.vec3, inv_rest: wp.mat22, moduli: wp.vec3) -> Stretch:
    """S = 2 mu G + lambda tr(G) I with G = (F^T F - I) / 2."""
    d1 = x1 - x0
    d2 = x2 - x0
    out = Stretch()
    out.f1 = d1 * inv_rest[0, 0] + d2 * inv_rest[1, 0]
    out.f2 = d1 * inv_rest[0, 1] + d2 * inv_rest[1, 1]
    g11 = 0.5 * (wp.dot(out.f1, out.f1) - 1.0)
    g22 = 0.5 * (wp.dot(out.f2, out.f2) - 1.0)
    g12 = 0.5 * wp.dot(out.f1, out.f2)
    trace = moduli[1] * (g11 + g22)
    out.stress = wp.vec3(2.0 * moduli[0] * g11 + trace, 2.0 * moduli[0] * g22 + trace, 2.0 * moduli[0] * g12)
    return out


@wp.func
def corner_gradient(inv_rest: wp.mat22, corner: int) -> wp.vec2:
    """Gradient of the corner's linear shape function at rest [1/m]."""
    if corner == 0:
        return -(inv_rest[0] + inv_rest[1])
    return inv_rest[corner - 1]


@wp.kernel
def measure_triangles(shell: ShellElements, tissue: Tissue, x: wp.array2d(dtype=wp.vec3)):
    """Normal and corner forces of every triangle. Launch (F, W)."""
    t, w = wp.tid()
    corners = shell.triangles[t]
    x0 = x[corners[0], w]
    x1 = x[corners[1], w]
    x2 = x[corners[2], w]
    normal = wp.cross(x1 - x0, x2 - x0)
    shell.tilt[t, w] = normal / wp.max(wp.length_sq(normal), 1.0e-20)
    inv_rest = shell.inv_rest[t]
    now = stretch_of(x0, x1, x2, inv_rest, tissue.moduli[w])
    p1 = -shell.area[t] * (now.f1 * now.stress[0] + now.f2 * now.stress[2])
    p2 = -shell.area[t] * (now.f1 * now.stress[2] + now.f2 * now.stress[1])
    one = p1 * inv_rest[0, 0] + p2 * inv_rest[0, 1]
    two = p1 * inv_rest[1, 0] + p2 * inv_rest[1, 1]
    shell.corner_force[3 * t, w] = -one - two
    shell.corner_force[3 * t + 1, w] = one
    shell.corner_force[3 * t + 2, w] = two


@wp.struct
class Fold:
    """Gradient of a hinge's angle at its two opposite vertices [rad/m]."""

    g0: wp.vec3
    g1: wp.vec3


@wp.func
def fold_of(shell: ShellElements, h: int, w: int) -> Fold:
    """The hinge with the normals last measured; the length of its edge is taken from rest."""
    sides = shell.sides[h]
    out = Fold()
    out.g0 = -shell.length[h] * shell.tilt[sides[0], w]
    out.g1 = -shell.length[h] * shell.tilt[sides[1], w]
    return out


@wp.func
def linear_bend(shell: ShellElements, now: Fold, h: int, x: wp.array2d(dtype=wp.vec3), w: int) -> float:
    """Part of a hinge's angle that is linear in its vertices [rad]."""
    corners = shell.hinges[h]
    foot = shell.foot[h]
    start = x[corners[2], w]
    edge = x[corners[3], w] - start
    out = wp.dot(now.g0, x[corners[0], w] - start - foot[0] * edge)
    return out + wp.dot(now.g1, x[corners[1], w] - start - foot[1] * edge)


@wp.kernel
def measure_hinges(shell: ShellElements, x: wp.array2d(dtype=wp.vec3)):
    """Angle of every hinge from rest. Launch (H, W)."""
    h, w = wp.tid()
    corners = shell.hinges[h]
    sides = shell.sides[h]
    edge = x[corners[3], w] - x[corners[2], w]
    n0 = shell.tilt[sides[0], w]
    n1 = shell.tilt[sides[1], w]
    angle = wp.atan2(wp.dot(wp.cross(n0, n1), wp.normalize(edge)), wp.dot(n0, n1))
    shell.bend[h, w] = angle - shell.rest_angle[h]
    shell.offset[h, w] = angle - shell.rest_angle[h] - linear_bend(shell, fold_of(shell, h, w), h, x, w)


@wp.func
def corner_turn(now: Fold, foot: wp.vec2, corner: int) -> wp.vec3:
    """Gradient of a hinge's angle with respect to one of its four vertices [rad/m]."""
    if corner == 0:
        return now.g0
    if corner == 1:
        return now.g1
    if corner == 2:
        return (foot[0] - 1.0) * now.g0 + (foot[1] - 1.0) * now.g1
    return -foot[0] * now.g0 - foot[1] * now.g1


@wp.func
def add_stretching(
    block: VertexBlock, shell: ShellElements, x: wp.array2d(dtype=wp.vec3), i: int, w: int, moduli: wp.vec3
) -> VertexBlock:
    """Add the membrane terms of the triangles around vertex ``i`` of world ``w``.

    With the corner's shape gradient m and g = F m: force -A F S m; the Hessian keeps
    A ((mu + lambda) g g^T + mu |m|^2 F F^T + max(m.S m, 0) I).
    """
    out = block
    mu = moduli[0]
    for k in range(shell.triangle_start[i], shell.triangle_start[i + 1]):
        entry = shell.triangle_entry[k]
        t = entry // 3
        corners = shell.triangles[t]
        inv_rest = shell.inv_rest[t]
        now = stretch_of(x[corners[0], w], x[corners[1], w], x[corners[2], w], inv_rest, moduli)
        m = corner_gradient(inv_rest, entry - 3 * t)
        sm = wp.vec2(now.stress[0] * m[0] + now.stress[2] * m[1], now.stress[2] * m[0] + now.stress[1] * m[1])
        g = now.f1 * m[0] + now.f2 * m[1]
        area = shell.area[t]
        out.force -= area * (now.f1 * sm[0] + now.f2 * sm[1])
        out.hessian += (area * (mu + moduli[1])) * wp.outer(g, g)
        out.hessian += (area * mu * wp.dot(m, m)) * (wp.outer(now.f1, now.f1) + wp.outer(now.f2, now.f2))
        out.hessian += (area * wp.max(wp.dot(m, sm), 0.0)) * wp.identity(n=3, dtype=float)
    return out


@wp.func
def add_bending(
    block: VertexBlock, shell: ShellElements, x: wp.array2d(dtype=wp.vec3), i: int, w: int, rigidity: float
) -> VertexBlock:
    """Add the terms k (angle - rest)^2 / 2 of the hinges around vertex ``i`` of world ``w``."""
    out = block
    for k in range(shell.hinge_start[i], shell.hinge_start[i + 1]):
        entry = shell.hinge_entry[k]
        h = entry // 4
        now = fold_of(shell, h, w)
        turn = corner_turn(now, shell.foot[h], entry - 4 * h)
        stiffness = rigidity * shell.weight[h]
        out.force -= (stiffness * (shell.offset[h, w] + linear_bend(shell, now, h, x, w))) * turn
        out.hessian += stiffness * wp.outer(turn, turn)
    return out


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
    largest_move: float,
    x: wp.array2d(dtype=wp.vec3),
):
    """One Newton step, at most ``largest_move`` [m], of every vertex of one colour. Launch (len(colour), W)."""
    k, w = wp.tid()
    if tissue.rigid[w] == 1:
        return
    i = colour[k]
    moduli = tissue.moduli[w]
    block = inertia_and_anchor(nodes, tissue, inertial[i, w], x[i, w], i, w, 1.0 / (dt * dt))
    block = add_stretching(block, shell, x, i, w, moduli)
    block = add_bending(block, shell, x, i, w, moduli[2])
    block = add_contact(block, records, links, law, friction[w], link_count, dt, x, x_prev, body_q, body_q_prev, i, w)
    x[i, w] = x[i, w] + shortened(wp.inverse(block.hessian) * block.force, largest_move)


@wp.kernel
def residual(
    nodes: WallNodes,
    shell: ShellElements,
    tissue: Tissue,
    dt: float,
    inertial: wp.array2d(dtype=wp.vec3),
    records: ContactRecords,
    pressing: Pressing,
    x: wp.array2d(dtype=wp.vec3),
    force: wp.array2d(dtype=wp.vec3),
):
    """Total force on every mobile vertex where the elements were measured. Launch (V, W)."""
    i, w = wp.tid()
    block = VertexBlock()
    if nodes.mobile[i] == 1 and tissue.rigid[w] == 0:
        block = inertia_and_anchor(nodes, tissue, inertial[i, w], x[i, w], i, w, 1.0 / (dt * dt))
        for k in range(shell.triangle_start[i], shell.triangle_start[i + 1]):
            block.force += shell.corner_force[shell.triangle_entry[k], w]
        for k in range(shell.hinge_start[i], shell.hinge_start[i + 1]):
            entry = shell.hinge_entry[k]
            h = entry // 4
            turn = corner_turn(fold_of(shell, h, w), shell.foot[h], entry - 4 * h)
            block.force -= (tissue.moduli[w][2] * shell.weight[h] * shell.bend[h, w]) * turn
        block.force += contact_force(records, pressing, i, w)
    force[i, w] = block.force
