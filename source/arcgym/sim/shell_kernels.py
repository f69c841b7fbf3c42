# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Vertex block descent on a thin shell: stretching triangles and bending hinges, in closed form.

Membrane: compressible neo-Hookean, mu / 2 (I - 2 - 2 ln J) + lambda / 2 (ln J)^2 for an area, I = tr C (Bonet and
Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, section 6.4), with plane-stress moduli, and a term
b mu / 6 (I - 2)^3 that stiffens large stretches. Its area cannot shrink to nothing, as that of the St. Venant-Kirchhoff
membrane of Newton's ``SolverVBD`` can; at small strain the two are the same.
Bending: discrete shells (Grinspun et al. 2003, "Discrete Shells", SCA), with the Gauss-Newton part of the Hessian.

What several vertices need is measured once a step for each element: the normals and corner forces of the triangles, and
the angles of the hinges. A hinge's angle is then linear in the moves of its vertices for the rest of the step, which
spares the sweep its normals and inverse tangents.
"""

import warp as wp

from arcgym.sim.geometry_kernels import shortened
from arcgym.sim.wall_kernels import (
    Pressing,
    Tissue,
    VertexBlock,
    WallContacts,
    WallNodes,
    add_contact,
    add_loops,
    contact_force,
    inertia_and_anchor,
    quiet,
)
from arcgym.utils import warp_setup  # noqa: F401

SMALLEST = wp.constant(1.0e-4)
"""Least square of a triangle's area over that at rest: keeps the logarithm finite."""
STIFFENING = wp.constant(2.75)
"""Factor b of the stiffening term. A strip of 0.5 MPa then bears 0.87 MPa at a stretch of 1.63, where human colon
tears (0.87 MPa at 63 %, Christensen et al. 2015); without it, a quarter."""


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

    f1: wp.vec3  # columns of the deformation gradient F
    f2: wp.vec3
    inverse: wp.vec3  # of C = F^T F: 11, 22, 12
    excess: float  # I - 2, zero where negative
    spread: float  # lambda ln J - mu [N/m]


@wp.func
def stretch_of(x0: wp.vec3, x1: wp.vec3, x2: wp.vec3, inv_rest: wp.mat22, moduli: wp.vec3) -> Stretch:
    """Deformation gradient of a triangle, and what its stress needs.

    S = mu (1 + b (I - 2)^2) Id + (lambda ln J - mu) C^-1
    """
    d1 = x1 - x0
    d2 = x2 - x0
    out = Stretch()
    out.f1 = d1 * inv_rest[0, 0] + d2 * inv_rest[1, 0]
    out.f2 = d1 * inv_rest[0, 1] + d2 * inv_rest[1, 1]
    c11 = wp.dot(out.f1, out.f1)
    c22 = wp.dot(out.f2, out.f2)
    c12 = wp.dot(out.f1, out.f2)
    square = wp.max(c11 * c22 - c12 * c12, SMALLEST)
    out.inverse = wp.vec3(c22, c11, -c12) / square
    out.excess = wp.max(c11 + c22 - 2.0, 0.0)
    out.spread = moduli[1] * 0.5 * wp.log(square) - moduli[0]
    return out


@wp.func
def times_inverse(now: Stretch, m: wp.vec2) -> wp.vec2:
    """C^-1 m."""
    return wp.vec2(
        now.inverse[0] * m[0] + now.inverse[2] * m[1],
        now.inverse[2] * m[0] + now.inverse[1] * m[1],
    )


@wp.func
def corner_gradient(inv_rest: wp.mat22, corner: int) -> wp.vec2:
    """Gradient of the corner's linear shape function at rest [1/m]."""
    if corner == 0:
        return -(inv_rest[0] + inv_rest[1])
    return inv_rest[corner - 1]


@wp.func
def corner_pull(shell: ShellElements, now: Stretch, t: int, m: wp.vec2, mu: float) -> wp.vec3:
    """Force -A F S m on the corner of triangle ``t`` whose shape gradient is ``m`` [N]."""
    s = (mu * (1.0 + STIFFENING * now.excess * now.excess)) * m + now.spread * times_inverse(now, m)
    return -shell.area[t] * (now.f1 * s[0] + now.f2 * s[1])


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
    one = corner_pull(shell, now, t, inv_rest[0], tissue.moduli[w][0])
    two = corner_pull(shell, now, t, inv_rest[1], tissue.moduli[w][0])
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

    With the corner's shape gradient m, g = F m, h = F C^-1 m, the normal n and s = mu (1 + b (I - 2)^2) |m|^2, the
    Hessian is A times s (Id - n n^T) + (lambda + mu - lambda ln J) h h^T + (s + (lambda ln J - mu) m.C^-1 m) n n^T
    + 4 b mu (I - 2) g g^T; negative factors, of a compressed triangle that would buckle, count as zero.
    """
    out = block
    mu = moduli[0]
    eye = wp.identity(n=3, dtype=float)
    for k in range(shell.triangle_start[i], shell.triangle_start[i + 1]):
        entry = shell.triangle_entry[k]
        t = entry // 3
        corners = shell.triangles[t]
        inv_rest = shell.inv_rest[t]
        now = stretch_of(x[corners[0], w], x[corners[1], w], x[corners[2], w], inv_rest, moduli)
        m = corner_gradient(inv_rest, entry - 3 * t)
        back = times_inverse(now, m)
        h = now.f1 * back[0] + now.f2 * back[1]
        n = wp.normalize(wp.cross(now.f1, now.f2))
        g = now.f1 * m[0] + now.f2 * m[1]
        stretched = STIFFENING * mu * now.excess
        shear = (mu + stretched * now.excess) * wp.dot(m, m)
        along = wp.max(moduli[1] - now.spread, 0.0)
        across = wp.max(shear + now.spread * wp.dot(m, back), 0.0)
        area = shell.area[t]
        out.force += corner_pull(shell, now, t, m, mu)
        out.hessian += area * (shear * eye + along * wp.outer(h, h) + (across - shear) * wp.outer(n, n))
        out.hessian += (4.0 * area * stretched) * wp.outer(g, g)
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
    inertial: wp.array2d(dtype=wp.vec3),
    contacts: WallContacts,
    largest_move: float,
    force: wp.array2d(dtype=wp.vec3),
    x: wp.array2d(dtype=wp.vec3),
):
    """One Newton step, at most ``largest_move`` [m], of every vertex of one colour. Launch (len(colour), W)."""
    k, w = wp.tid()
    i = colour[k]
    if tissue.rigid[w] == 1 or quiet(force[i, w], x[i, w] - inertial[i, w]):
        return
    moduli = tissue.moduli[w]
    block = inertia_and_anchor(nodes, tissue, inertial[i, w], x[i, w], i, w, 1.0 / (contacts.dt * contacts.dt))
    block = add_stretching(block, shell, x, i, w, moduli)
    block = add_bending(block, shell, x, i, w, moduli[2])
    block = add_contact(block, contacts, x, i, w)
    block = add_loops(block, contacts.loops, x[i, w], i, w)
    x[i, w] = x[i, w] + shortened(wp.inverse(block.hessian) * block.force, largest_move)


@wp.kernel
def residual(
    nodes: WallNodes,
    shell: ShellElements,
    tissue: Tissue,
    inertial: wp.array2d(dtype=wp.vec3),
    contacts: WallContacts,
    pressing: Pressing,
    x: wp.array2d(dtype=wp.vec3),
    force: wp.array2d(dtype=wp.vec3),
):
    """Total force on every mobile vertex where the elements were measured. Launch (V, W)."""
    i, w = wp.tid()
    block = VertexBlock()
    if nodes.mobile[i] == 1 and tissue.rigid[w] == 0:
        block = inertia_and_anchor(nodes, tissue, inertial[i, w], x[i, w], i, w, 1.0 / (contacts.dt * contacts.dt))
        for k in range(shell.triangle_start[i], shell.triangle_start[i + 1]):
            block.force += shell.corner_force[shell.triangle_entry[k], w]
        for k in range(shell.hinge_start[i], shell.hinge_start[i + 1]):
            entry = shell.hinge_entry[k]
            h = entry // 4
            turn = corner_turn(fold_of(shell, h, w), shell.foot[h], entry - 4 * h)
            block.force -= (tissue.moduli[w][2] * shell.weight[h] * shell.bend[h, w]) * turn
        block.force += contact_force(contacts.records, pressing, i, w)
        block = add_loops(block, contacts.loops, x[i, w], i, w)
    force[i, w] = block.force
