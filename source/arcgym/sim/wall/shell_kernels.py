# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Vertex block descent on a thin shell: stretching triangles and bending hinges, in closed form.

Membrane: compressible neo-Hookean, mu / 2 (I - 2 - 2 ln J) + lambda / 2 (ln J)^2 for an area, I = tr C (Bonet and
Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, section 6.4), with plane-stress moduli, and a term
b mu / 6 (I - 2)^3 that stiffens large stretches. Its area cannot shrink to nothing, as that of the St. Venant-Kirchhoff
membrane of Newton's ``SolverVBD`` can; at small strain the two are the same.
Bending: the triangles' shape operators from their hinges (:func:`arcgym.assets.shell_geometry.bending_coupling`), with
the Gauss-Newton part of the Hessian.

Quantities that several vertices share are measured once a step for each element: the normals and corner forces of the
triangles, and the angles of the hinges. A hinge's angle is then linear in the moves of its vertices for the rest of the
step, which spares the sweep its normals and inverse tangents.
"""

import warp as wp

from arcgym.sim.wall.band_kernels import Rings, band_fields
from arcgym.sim.wall.band_matrix_kernels import BandMatrix, add_edge, add_next_edge, add_own_edge
from arcgym.sim.wall.wall_kernels import Tissue, VertexBlock
from arcgym.utils import warp_setup  # noqa: F401

SMALLEST = wp.constant(1.0e-4)
"""Least square of a triangle's area over that at rest: keeps the logarithm finite."""
STIFFENING = wp.constant(2.75)
"""Factor b of the stiffening term. A strip of 0.5 MPa then bears 0.87 MPa at a stretch of 1.63, where human colon
tears (0.87 MPa at 63 %, Christensen et al. 2015); without it, a quarter."""


@wp.struct
class VertexTriangle:
    """A triangle as one of its vertices sees it: one of the fan of triangles around that vertex.

    Its *rim* is the hinge at the edge opposite to the vertex, its *spoke* the hinge at the edge to ``first``. A hinge
    that is not there, at a border, has no stiffness.
    """

    first: int  # the other two vertices, in the triangle's order
    second: int
    index: int  # triangle
    rim: int  # hinge
    rim_vertex: int  # vertex beyond it
    rim_triangle: int  # triangle beyond it
    spoke: int
    spoke_vertex: int
    spoke_triangle: int


@wp.struct
class VertexTriangleRest:
    """Rest shape of a triangle and of its hinges as one of its vertices sees them, see :class:`VertexTriangle`."""

    rest: wp.vec4  # ``ShellElements.rest`` of the triangle, beginning with this vertex
    rim: wp.vec4  # length [m], foot of this vertex and of that beyond from first to second, stiffness
    spoke: wp.vec4  # length [m], feet of ``second`` and of the vertex beyond from here to ``first``, stiffness


@wp.struct
class ShellElements:
    """Triangles and hinges of a wall, their rest shape in each of P patients, and what is measured in each world."""

    patient: wp.array[int]  # patient of each world, shape (W,)
    triangles: wp.array[wp.vec3i]  # shape (F,)
    rest: wp.array2d[wp.vec4]  # cotangent of each corner over 2 A [1/m^2], area A [m^2], at rest, shape (F, P)
    edges: wp.array[wp.vec3i]  # hinge opposite to each corner or -1, shape (F,)
    hinges: wp.array[wp.vec4i]  # two opposite vertices, then the edge from start to end, shape (H,)
    rest_angle: wp.array2d[float]  # dihedral angle at rest [rad], shape (H, P)
    coupled: wp.array2d[int]  # each hinge, then the other two of either of its triangles, shape (H, 5)
    coupling: wp.array3d[wp.vec2]  # moment by their angles over rigidity: times 1 - nu, times nu, shape (H, 5, P)
    inverse_length: wp.array2d[float]  # [1/m], shape (H, P)
    fan_start: wp.array[int]  # first triangle of each vertex's fan, shape (V + 1,)
    fan: wp.array[VertexTriangle]  # shape (3*F,)
    fan_rest: wp.array2d[VertexTriangleRest]  # shape (3*F, P)
    fan_corner: wp.array[int]  # 3 * triangle + corner of each, shape (3*F,)
    scaled_normal: wp.array2d[wp.vec3]  # edge x edge over its squared length [1/m^2], shape (F, W)
    corner_force: wp.array2d[wp.vec3]  # force on each corner [N], shape (3*F, W)
    angle_change: wp.array2d[float]  # angle of each hinge from rest [rad], shape (H, W)
    moment: wp.array2d[float]  # of each hinge, over flexural rigidity, shape (H, W)


@wp.struct
class Stretch:
    """Deformation of a triangle and its stress."""

    dots: wp.vec3  # product of the two edges at each corner [m^2]
    inverse: float  # one over the squared length of the edges' cross product [1/m^4]
    excess: float  # I - 2, zero where negative
    shear: float  # mu (1 + b (I - 2)^2) [N/m]
    spread: float  # lambda ln J - mu [N/m]


@wp.func
def membrane_stretch(d1: wp.vec3, d2: wp.vec3, rest: wp.vec4, moduli: wp.vec3) -> Stretch:
    """Return the stress S = shear Id + spread C^-1 of a triangle with edges ``d1`` and ``d2`` from its first corner.

    I is the sum of the squared edges, each times the cotangent of the corner opposite over 2 A.
    """
    d11 = wp.dot(d1, d1)
    d22 = wp.dot(d2, d2)
    d12 = wp.dot(d1, d2)
    unit = 4.0 * rest[3] * rest[3]
    square = wp.max(d11 * d22 - d12 * d12, SMALLEST * unit)
    out = Stretch()
    out.dots = wp.vec3(d12, d11 - d12, d22 - d12)
    out.inverse = 1.0 / square
    trace = rest[2] * d11 + rest[1] * d22 + rest[0] * (out.dots[1] + out.dots[2])
    out.excess = wp.max(trace - 2.0, 0.0)
    out.shear = moduli[0] * (1.0 + STIFFENING * out.excess * out.excess)
    out.spread = moduli[1] * 0.5 * wp.log(square / unit) - moduli[0]
    return out


@wp.func
def edge_tensions(now: Stretch, rest: wp.vec4) -> wp.vec3:
    """Return force over length [N/m] of the springs along the edges that the membrane acts like."""
    s = rest[3] * now.shear
    k = rest[3] * now.spread * now.inverse
    return wp.vec3(s * rest[0] + k * now.dots[0], s * rest[1] + k * now.dots[1], s * rest[2] + k * now.dots[2])


@wp.func
def direction_angle(sine: float, cosine: float) -> float:
    """Return the angle whose sine and cosine are in the ratio given [rad].

    Up to 45 degrees from the tangent of its half by the polynomial of ``atanf`` in Cephes (Moshier 1989), which takes
    a CPU a third of the time of ``atan2``.
    """
    span = wp.sqrt(sine * sine + cosine * cosine) + cosine
    if wp.abs(sine) >= 0.41421356 * span:
        return wp.atan2(sine, cosine)
    t = sine / span
    z = t * t
    series = ((8.05374449538e-2 * z - 1.38776856032e-1) * z + 1.99777106478e-1) * z - 3.33329491539e-1
    return 2.0 * (t + series * z * t)


@wp.func
def hinge_angle(shell: ShellElements, x: wp.array2d[wp.vec3], h: int, w: int) -> float:
    """Return the dihedral angle of a hinge [rad], between the normals edge x a and b x edge."""
    corners = shell.hinges[h]
    start = x[corners[2], w]
    edge = x[corners[3], w] - start
    a = x[corners[0], w] - start
    b = x[corners[1], w] - start
    squared = wp.length_sq(edge)
    sine = -wp.sqrt(squared) * wp.dot(edge, wp.cross(a, b))
    return direction_angle(sine, wp.dot(a, edge) * wp.dot(b, edge) - squared * wp.dot(a, b))


@wp.kernel
def measure_hinges(first: int, x: wp.array2d[wp.vec3], shell: ShellElements):
    """Write ``shell.angle_change`` at the positions ``x`` [m], shape (V, W), from row ``first`` on. Launch (H, W)."""
    h, w = wp.tid()
    h += first
    shell.angle_change[h, w] = hinge_angle(shell, x, h, w) - shell.rest_angle[h, shell.patient[w]]


@wp.kernel
def measure_moments(first: int, tissue: Tissue, shell: ShellElements):
    """Moment of every hinge from row ``first`` on, from its own angle and those of the hinges it is coupled with.

    Launch (H, W).
    """
    h, w = wp.tid()
    h += first
    moduli = tissue.moduli[w]
    nu = moduli[1] / (moduli[1] + 2.0 * moduli[0])  # plane stress
    moment = float(0.0)
    for k in range(5):
        c = shell.coupling[h, k, shell.patient[w]]
        moment += ((1.0 - nu) * c[0] + nu * c[1]) * shell.angle_change[shell.coupled[h, k], w]
    shell.moment[h, w] = moment


@wp.func
def hinge_moment(shell: ShellElements, h: int, w: int) -> float:
    """Return the moment of a hinge over its length, for unit rigidity [1/m]; zero where there is none."""
    if h < 0:
        return 0.0
    return shell.inverse_length[h, shell.patient[w]] * shell.moment[h, w]


@wp.kernel
def measure_triangles(first: int, x: wp.array2d[wp.vec3], tissue: Tissue, shell: ShellElements):
    """Write ``shell.scaled_normal`` and ``shell.corner_force`` at ``x`` [m], shape (V, W), from row ``first`` on.

    Launch (F, W).

    A hinge turns its triangle by pulling at the corners along the normal: at the corner opposite with its moment over
    the height, and back at the others by where the foot of the height is.
    """
    t, w = wp.tid()
    t += first
    corners = shell.triangles[t]
    x0 = x[corners[0], w]
    d1 = x[corners[1], w] - x0
    d2 = x[corners[2], w] - x0
    normal = wp.cross(d1, d2)
    scaled_normal = normal / wp.max(wp.length_sq(normal), 1.0e-20)
    shell.scaled_normal[t, w] = scaled_normal
    rest = shell.rest[t, shell.patient[w]]
    edges = shell.edges[t]
    pull = edge_tensions(membrane_stretch(d1, d2, rest, tissue.moduli[w]), rest)
    bend = (4.0 * rest[3] * rest[3] * tissue.moduli[w][2]) * scaled_normal
    u0 = hinge_moment(shell, edges[0], w)
    u1 = hinge_moment(shell, edges[1], w)
    u2 = hinge_moment(shell, edges[2], w)
    one = (rest[2] * (u1 - u0) + rest[0] * (u1 - u2)) * bend - (pull[2] + pull[0]) * d1 + pull[0] * d2
    two = (rest[0] * (u2 - u1) + rest[1] * (u2 - u0)) * bend - (pull[1] + pull[0]) * d2 + pull[0] * d1
    shell.corner_force[3 * t, w] = -one - two
    shell.corner_force[3 * t + 1, w] = one
    shell.corner_force[3 * t + 2, w] = two


@wp.func
def add_stretching(block: VertexBlock, rest: wp.vec4, d1: wp.vec3, d2: wp.vec3, moduli: wp.vec3) -> VertexBlock:
    """Add the membrane terms of a triangle to its first corner, from where the edges ``d1`` and ``d2`` lead.

    With the corner's shape gradient m, g = F m, h = F C^-1 m, the normal n and s = mu (1 + b (I - 2)^2) |m|^2, the
    Hessian is A times s (Id - n n^T) + (lambda + mu - lambda ln J) h h^T + (s + (lambda ln J - mu) m.C^-1 m) n n^T
    + 4 b mu (I - 2) g g^T; negative factors, of a compressed triangle that would buckle, count as zero.
    """
    now = membrane_stretch(d1, d2, rest, moduli)
    pull = edge_tensions(now, rest)
    h = now.dots[2] * d1 + now.dots[1] * d2
    g = rest[2] * d1 + rest[1] * d2
    n = wp.cross(d1, d2)
    s = now.shear * (rest[1] + rest[2])
    along = wp.max(moduli[1] - now.spread, 0.0) * now.inverse * now.inverse
    across = wp.max(s + now.spread * now.inverse * (now.dots[1] + now.dots[2]), 0.0)
    stretched = 4.0 * STIFFENING * moduli[0] * now.excess
    out = block
    out.force += pull[2] * d1 + pull[1] * d2
    out.hessian += (rest[3] * s) * wp.identity(n=3, dtype=float)
    out.hessian += (rest[3] * along) * wp.outer(h, h) + (rest[3] * stretched) * wp.outer(g, g)
    out.hessian += (rest[3] * (across - s) * now.inverse) * wp.outer(n, n)
    return out


@wp.func
def add_hinge(block: VertexBlock, turn: wp.vec3, moment: float, further: float, stiffness: float) -> VertexBlock:
    """Add a hinge whose angle has the gradient ``turn`` at the vertex.

    Args:
        block: Block of the vertex.
        turn: Gradient [rad/m].
        moment: Moment where it was measured [N m].
        further: Angle since then [rad].
        stiffness: Bound on its stiffness [N m/rad]: the energy of this model is nowhere below the true one, whatever
            the hinges that this one is coupled with do meanwhile.
    """
    out = block
    out.force -= (moment + stiffness * further) * turn
    out.hessian += stiffness * wp.outer(turn, turn)
    return out


@wp.func
def add_elements(
    block: VertexBlock, shell: ShellElements, x: wp.array2d[wp.vec3], i: int, w: int, moduli: wp.vec3
) -> VertexBlock:
    """Add the terms of the triangles and hinges around vertex ``i`` of world ``w``.

    A hinge's angle has since fallen, for both of its triangles, by its length times the product of the scaled normal
    with the displacement of the vertex opposite from the foot of its height, which was zero when measured.
    """
    out = block
    here = x[i, w]
    for k in range(shell.fan_start[i], shell.fan_start[i + 1]):
        triangle = shell.fan[k]
        own = shell.fan_rest[k, shell.patient[w]]
        d1 = x[triangle.first, w] - here
        d2 = x[triangle.second, w] - here
        out = add_stretching(out, own.rest, d1, d2, moduli)
        scaled_normal = shell.scaled_normal[triangle.index, w]
        rise1 = wp.dot(scaled_normal, d1)
        rise2 = wp.dot(scaled_normal, d2)

        shape = own.rim
        away = x[triangle.rim_vertex, w] - here - (1.0 - shape[2]) * d1 - shape[2] * d2
        lift = wp.dot(shell.scaled_normal[triangle.rim_triangle, w], away) - (1.0 - shape[1]) * rise1 - shape[1] * rise2
        moment = moduli[2] * wp.where(shape[3] > 0.0, shell.moment[triangle.rim, w], 0.0)
        out = add_hinge(out, -shape[0] * scaled_normal, moment, -shape[0] * lift, moduli[2] * shape[3])

        shape = own.spoke
        other = shell.scaled_normal[triangle.spoke_triangle, w]
        lift = rise2 - shape[1] * rise1 + wp.dot(other, x[triangle.spoke_vertex, w] - here - shape[2] * d1)
        moment = moduli[2] * wp.where(shape[3] > 0.0, shell.moment[triangle.spoke, w], 0.0)
        turn = shape[0] * ((1.0 - shape[1]) * scaled_normal + (1.0 - shape[2]) * other)
        out = add_hinge(out, turn, moment, -shape[0] * lift, moduli[2] * shape[3])
    return out


@wp.func
def add_forces(
    block: VertexBlock, shell: ShellElements, x: wp.array2d[wp.vec3], i: int, w: int, moduli: wp.vec3
) -> VertexBlock:
    """Add the measured forces of the triangles around vertex ``i`` of world ``w``."""
    out = block
    for k in range(shell.fan_start[i], shell.fan_start[i + 1]):
        out.force += shell.corner_force[shell.fan_corner[k], w]
    return out


@wp.func
def positive_part(a: float, b: float, c: float) -> wp.vec3:
    """Return the positive semidefinite part of the symmetric matrix ((a, b), (b, c))."""
    middle = 0.5 * (a + c)
    radius = wp.sqrt(0.25 * (a - c) * (a - c) + b * b)
    low = middle - radius
    if low >= 0.0:
        return wp.vec3(a, b, c)
    share = wp.max(middle + radius, 0.0) / (2.0 * wp.max(radius, 1.0e-20))
    return share * wp.vec3(a - low, b, c - low)


@wp.struct
class EdgeStiffness:
    """Stiffness of a triangle between its two edges from the first corner [N/m]."""

    one: wp.mat33
    both: wp.mat33
    two: wp.mat33


@wp.func
def edge_stiffness(d1: wp.vec3, d2: wp.vec3, rest: wp.vec4, moduli: wp.vec3) -> EdgeStiffness:
    """Return the Hessian of the membrane in the edges ``d1`` and ``d2``, without its negative parts.

    Between edges a and b it is A times lambda h_a h_b^T + k (h_b h_a^T + h_a.h_b (Id - n n^T)) + T_ab Id +
    4 b mu (I - 2) g_a g_b^T, with the edges' duals h in the triangle and g at rest, k = mu - lambda ln J and the
    tension T: Bonet and Wood, section 6.5. ``add_stretching`` is the same for one corner.
    """
    now = membrane_stretch(d1, d2, rest, moduli)
    inv11 = now.inverse * (now.dots[0] + now.dots[2])
    inv22 = now.inverse * (now.dots[0] + now.dots[1])
    inv12 = -now.inverse * now.dots[0]
    h1 = inv11 * d1 + inv12 * d2
    h2 = inv12 * d1 + inv22 * d2
    rest11 = rest[2] + rest[0]
    rest22 = rest[1] + rest[0]
    tension = rest[3] * positive_part(
        now.shear * rest11 + now.spread * inv11,
        now.spread * inv12 - now.shear * rest[0],
        now.shear * rest22 + now.spread * inv22,
    )
    k = rest[3] * wp.max(-now.spread, 0.0)
    spread = rest[3] * moduli[1]
    n = wp.cross(d1, d2)
    eye = wp.identity(n=3, dtype=float)
    plane = k * (eye - now.inverse * wp.outer(n, n))
    out = EdgeStiffness()
    out.one = (spread + k) * wp.outer(h1, h1) + inv11 * plane + tension[0] * eye
    out.two = (spread + k) * wp.outer(h2, h2) + inv22 * plane + tension[2] * eye
    out.both = spread * wp.outer(h1, h2) + k * wp.outer(h2, h1) + inv12 * plane + tension[1] * eye
    stretched = 4.0 * STIFFENING * moduli[0] * now.excess * rest[3]
    if stretched > 0.0:
        g1 = rest11 * d1 - rest[0] * d2
        g2 = rest22 * d2 - rest[0] * d1
        out.one += stretched * wp.outer(g1, g1)
        out.two += stretched * wp.outer(g2, g2)
        out.both += stretched * wp.outer(g1, g2)
    return out


@wp.func
def add_band_triangle(
    band: BandMatrix,
    shell: ShellElements,
    rings: Rings,
    x: wp.array2d[wp.vec3],
    t: int,
    r: int,
    w: int,
    moduli: wp.vec3,
) -> BandMatrix:
    """Add the stretching of triangle ``t`` to the stiffness of the band of ring ``r`` of world ``w``.

    Two of its corners lie in one ring: the edge between them is the first one, that to the third the second.
    """
    p = shell.patient[w]
    corners = shell.triangles[t]
    rest = shell.rest[t, p]
    if rings.ring[corners[0]] != rings.ring[corners[1]]:
        if rings.ring[corners[1]] == rings.ring[corners[2]]:
            corners = wp.vec3i(corners[1], corners[2], corners[0])
            rest = wp.vec4(rest[1], rest[2], rest[0], rest[3])
        else:
            corners = wp.vec3i(corners[2], corners[0], corners[1])
            rest = wp.vec4(rest[2], rest[0], rest[1], rest[3])
    x0 = x[corners[0], w]
    k = edge_stiffness(x[corners[1], w] - x0, x[corners[2], w] - x0, rest, moduli)
    along = rings.plane[corners[1], p] - rings.plane[corners[0], p]
    across = band_fields(rings, corners[2], r, p) - band_fields(rings, corners[0], r, p)
    out = add_edge(band, across, k.two)
    if rings.ring[corners[0]] == r:
        return add_own_edge(out, along, across, k.one, k.both)
    return add_next_edge(out, along, across, k.one, k.both)
