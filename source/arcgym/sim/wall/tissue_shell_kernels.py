# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Shell whose wall stiffens as chosen, is thinner where the colon is wider, relaxes, and may strain by cells, with gas
inside or without.

A triangle's membrane has the moduli of the tissue times its share of the thickness; its hinges have the cube of it in
their rest shape.

Relaxation: with G(t) = 1 - sum_k g_k (1 - exp(-t / tau_k)) the tension T of a wall whose tension at once is E is
T = E - sum_k g_k q_k, where q_k follows E: tau_k dq_k/dt = E - q_k (integrate dE by parts). E and q_k are the force
over length of the springs along its edges that a membrane acts like, three numbers a triangle. q_k is that of
the step's start; it changes by the share dt / tau_k of the tension in a step.

Some lines stand in ``shell_kernels`` as well: with functions shared between the two a compiler orders the arithmetic of
the plain shell anew, and published runs of it would differ in their last bits.
"""

import warp as wp

from arcgym.sim.wall.band_kernels import Rings, band_fields
from arcgym.sim.wall.band_matrix_kernels import BandMatrix, add_edge, add_next_edge, add_own_edge
from arcgym.sim.wall.cell_strain_kernels import Cells, cell_excess
from arcgym.sim.wall.gas_kernels import GasLoads
from arcgym.sim.wall.gas_shell_kernels import gas_pressure, gas_ties, rest_ties, triangle_ties
from arcgym.sim.wall.shell_kernels import (
    ShellElements,
    VertexTriangle,
    VertexTriangleRest,
    add_forces,
    add_hinge,
    hinge_moment,
)
from arcgym.sim.wall.tissue_membrane_kernels import (
    add_tissue_stretching,
    edge_tensions,
    tissue_edge_stiffness,
    tissue_stretch,
)
from arcgym.sim.wall.wall_kernels import Tissue, VertexBlock
from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class TissueShellElements:
    """A shell and what its tissue is like; F triangles, P patients, W worlds."""

    shell: ShellElements
    gas: GasLoads
    gassy: int  # whether there is gas
    stiffening: float  # factor b
    share: wp.array2d[float]  # thickness of each triangle over the tissue's, shape (F, P)
    relaxing: int  # whether tension fades
    relief: wp.array2d[wp.vec3]  # tension that has faded, along the edges opposite to the corners [N/m], shape (F, W)
    cells: Cells


@wp.func
def triangle_moduli(elements: TissueShellElements, t: int, w: int, moduli: wp.vec3) -> wp.vec3:
    """Return the moduli of triangle ``t`` of world ``w``; the rigidity is that of the tissue."""
    share = elements.share[t, elements.shell.patient[w]]
    return wp.vec3(share * moduli[0], share * moduli[1], moduli[2])


@wp.func
def tension_at_once(
    elements: TissueShellElements, t: int, w: int, d1: wp.vec3, d2: wp.vec3, moduli: wp.vec3
) -> wp.vec3:
    """Return the tension along a triangle's edges that does not know of time [N/m]."""
    rest = elements.shell.rest[t, elements.shell.patient[w]]
    own = triangle_moduli(elements, t, w, moduli)
    return edge_tensions(tissue_stretch(d1, d2, rest, own, elements.stiffening), rest)


@wp.func
def measure_triangle(
    shell: ShellElements,
    t: int,
    w: int,
    d1: wp.vec3,
    d2: wp.vec3,
    pull: wp.vec3,
    rigidity: float,
    edges: wp.vec3i,
    pressure: float,
):
    """Write scaled normal and corner forces of a triangle with edges ``d1`` and ``d2``.

    A hinge turns its triangle by pulling at the corners along the normal: at the corner opposite with its moment over
    the height, and back at the others by where the foot of the height is.

    Args:
        shell: Elements; written.
        t: Triangle.
        w: World.
        d1: Edge from the first corner to the second [m].
        d2: Edge from the first corner to the third [m].
        pull: Force over length of the springs along the edges that the membrane acts like [N/m].
        rigidity: Flexural rigidity [N m].
        edges: Hinges opposite to each corner.
        pressure: Of the gas, a third of whose push each corner bears [Pa].
    """
    normal = wp.cross(d1, d2)
    scaled_normal = normal / wp.max(wp.length_sq(normal), 1.0e-20)
    shell.scaled_normal[t, w] = scaled_normal
    rest = shell.rest[t, shell.patient[w]]
    bend = (4.0 * rest[3] * rest[3] * rigidity) * scaled_normal
    u0 = hinge_moment(shell, edges[0], w)
    u1 = hinge_moment(shell, edges[1], w)
    u2 = hinge_moment(shell, edges[2], w)
    one = (rest[2] * (u1 - u0) + rest[0] * (u1 - u2)) * bend - (pull[2] + pull[0]) * d1 + pull[0] * d2
    two = (rest[0] * (u2 - u1) + rest[1] * (u2 - u0)) * bend - (pull[1] + pull[0]) * d2 + pull[0] * d1
    third = (pressure / 6.0) * normal
    shell.corner_force[3 * t, w] = third - one - two
    shell.corner_force[3 * t + 1, w] = third + one
    shell.corner_force[3 * t + 2, w] = third + two


@wp.struct
class Memory:
    """What the triangles remember of their tension, and how it fades."""

    shares: wp.vec2  # g_k
    ways: wp.vec2  # 1 - exp(-dt / tau_k)
    quick: wp.array2d[wp.vec3]  # first memory [N/m], shape (F, W)
    slow: wp.array2d[wp.vec3]  # second memory [N/m], shape (F, W)


@wp.func
def relax(x: wp.array2d[wp.vec3], tissue: Tissue, elements: TissueShellElements, memory: Memory, t: int, w: int):
    """Let the memory of the tension of triangle ``t`` of world ``w`` follow it, and write ``elements.relief``.

    Args:
        x: Positions at the start of a step [m], shape (V, W).
        tissue: Values of each world.
        elements: Elements; ``relief`` is written.
        memory: Moved in place.
        t: Triangle.
        w: World.
    """
    corners = elements.shell.triangles[t]
    x0 = x[corners[0], w]
    tension = tension_at_once(elements, t, w, x[corners[1], w] - x0, x[corners[2], w] - x0, tissue.moduli[w])
    if elements.cells.enabled == 1:
        own = triangle_moduli(elements, t, w, tissue.moduli[w])
        tension -= cell_excess(elements.shell, elements.cells, x, t, w, own, elements.stiffening)
    one = memory.quick[t, w] + memory.ways[0] * (tension - memory.quick[t, w])
    two = memory.slow[t, w] + memory.ways[1] * (tension - memory.slow[t, w])
    memory.quick[t, w] = one
    memory.slow[t, w] = two
    elements.relief[t, w] = memory.shares[0] * one + memory.shares[1] * two


@wp.func
def measure_at(x: wp.array2d[wp.vec3], tissue: Tissue, elements: TissueShellElements, t: int, w: int):
    """Write scaled normal and corner forces of triangle ``t`` of world ``w`` at ``x`` [m], shape (V, W)."""
    corners = elements.shell.triangles[t]
    x0 = x[corners[0], w]
    d1 = x[corners[1], w] - x0
    d2 = x[corners[2], w] - x0
    moduli = tissue.moduli[w]
    pull = tension_at_once(elements, t, w, d1, d2, moduli)
    if elements.relaxing == 1:
        pull = pull - elements.relief[t, w]
    if elements.cells.enabled == 1:
        own = triangle_moduli(elements, t, w, moduli)
        excess = cell_excess(elements.shell, elements.cells, x, t, w, own, elements.stiffening)
        elements.cells.excess[t, w] = excess
        pull = pull - excess
    pressure = float(0.0)
    if elements.gassy == 1:
        ties = triangle_ties(elements.gas, t, w)
        pull = pull + wp.vec3(ties[1], ties[2], ties[0])
        pressure = gas_pressure(elements.gas, t, w)
    measure_triangle(elements.shell, t, w, d1, d2, pull, moduli[2], elements.shell.edges[t], pressure)


@wp.kernel
def measure_tissue(first: int, x: wp.array2d[wp.vec3], tissue: Tissue, elements: TissueShellElements):
    """Write scaled normals and corner forces, the gas' among them, at ``x`` [m], shape (V, W).

    Launch (F, W), or some of the rows from ``first`` on.
    """
    t, w = wp.tid()
    t += first
    measure_at(x, tissue, elements, t, w)


@wp.kernel
def relax_and_measure(
    first: int,
    start: wp.array2d[wp.vec3],
    x: wp.array2d[wp.vec3],
    tissue: Tissue,
    elements: TissueShellElements,
    memory: Memory,
):
    """Let tension fade where a step starts, then measure as ``measure_tissue`` does. Launch (F, W), or some rows.

    Args:
        first: First row of this launch.
        start: Positions at the start of the step [m], shape (V, W).
        x: Positions to measure at [m], shape (V, W).
        tissue: Values of each world.
        elements: Elements; written.
        memory: Moved in place.
    """
    t, w = wp.tid()
    t += first
    relax(start, tissue, elements, memory, t, w)
    measure_at(x, tissue, elements, t, w)


@wp.func
def add_fan_hinges(
    block: VertexBlock,
    shell: ShellElements,
    triangle: VertexTriangle,
    own: VertexTriangleRest,
    x: wp.array2d[wp.vec3],
    here: wp.vec3,
    d1: wp.vec3,
    d2: wp.vec3,
    w: int,
    rigidity: float,
) -> VertexBlock:
    """Add rim and spoke of one triangle of a vertex's fan.

    A hinge's angle has since fallen, for both of its triangles, by its length times the product of the scaled normal
    with the displacement of the vertex opposite from the foot of its height, which was zero when measured.

    Args:
        block: Block of the vertex.
        shell: Elements, measured.
        triangle: The triangle as the vertex sees it.
        own: Its rest shape likewise.
        x: Positions [m], shape (V, W).
        here: The vertex [m].
        d1: Edge to the triangle's next corner [m].
        d2: Edge to the one after [m].
        w: World.
        rigidity: Flexural rigidity [N m].
    """
    scaled_normal = shell.scaled_normal[triangle.index, w]
    rise1 = wp.dot(scaled_normal, d1)
    rise2 = wp.dot(scaled_normal, d2)

    shape = own.rim
    away = x[triangle.rim_vertex, w] - here - (1.0 - shape[2]) * d1 - shape[2] * d2
    lift = wp.dot(shell.scaled_normal[triangle.rim_triangle, w], away) - (1.0 - shape[1]) * rise1 - shape[1] * rise2
    moment = rigidity * wp.where(shape[3] > 0.0, shell.moment[triangle.rim, w], 0.0)
    out = add_hinge(block, -shape[0] * scaled_normal, moment, -shape[0] * lift, rigidity * shape[3])

    shape = own.spoke
    other = shell.scaled_normal[triangle.spoke_triangle, w]
    lift = rise2 - shape[1] * rise1 + wp.dot(other, x[triangle.spoke_vertex, w] - here - shape[2] * d1)
    moment = rigidity * wp.where(shape[3] > 0.0, shell.moment[triangle.spoke, w], 0.0)
    turn = shape[0] * ((1.0 - shape[1]) * scaled_normal + (1.0 - shape[2]) * other)
    return add_hinge(out, turn, moment, -shape[0] * lift, rigidity * shape[3])


@wp.func
def add_tissue_elements(
    block: VertexBlock, elements: TissueShellElements, x: wp.array2d[wp.vec3], i: int, w: int, moduli: wp.vec3
) -> VertexBlock:
    """Add triangles, hinges and gas around vertex ``i`` of world ``w``, as :func:`.shell_kernels.add_elements`.

    What has faded, or is beyond the cell's, counts for the force alone: the Hessian is that of the triangle's tension
    at once, which is larger. The Hessian of the pressure is zero for a closed fan.
    """
    shell = elements.shell
    out = block
    stiffer = float(0.0)
    here = x[i, w]
    for k in range(shell.fan_start[i], shell.fan_start[i + 1]):
        triangle = shell.fan[k]
        own = shell.fan_rest[k, shell.patient[w]]
        d1 = x[triangle.first, w] - here
        d2 = x[triangle.second, w] - here
        out = add_tissue_stretching(
            out, own.rest, d1, d2, triangle_moduli(elements, triangle.index, w, moduli), elements.stiffening
        )
        if elements.relaxing == 1:
            relief = elements.relief[triangle.index, w]
            corner = shell.fan_corner[k] - 3 * triangle.index
            out.force -= relief[(corner + 2) % 3] * d1 + relief[(corner + 1) % 3] * d2
        if elements.cells.enabled == 1:
            excess = elements.cells.excess[triangle.index, w]
            corner = shell.fan_corner[k] - 3 * triangle.index
            out.force -= excess[(corner + 2) % 3] * d1 + excess[(corner + 1) % 3] * d2
        if elements.gassy == 1:
            ties = gas_ties(elements.gas, shell.fan_corner[k], w)
            pressure = gas_pressure(elements.gas, triangle.index, w)
            out.force += (pressure / 6.0) * wp.cross(d1, d2) + ties[0] * d1 + ties[1] * d2
            stiffer += ties[0] + ties[1]
        out = add_fan_hinges(out, shell, triangle, own, x, here, d1, d2, w, moduli[2])
    if elements.gassy == 1:
        out.hessian += stiffer * wp.identity(n=3, dtype=float)
        if elements.gas.tense == 1:
            out.force += elements.gas.hold[i, w]
    return out


@wp.func
def add_tissue_forces(
    block: VertexBlock, elements: TissueShellElements, x: wp.array2d[wp.vec3], i: int, w: int, moduli: wp.vec3
) -> VertexBlock:
    """Add the measured forces of the triangles around vertex ``i`` of world ``w``."""
    out = add_forces(block, elements.shell, x, i, w, moduli)
    if elements.gassy == 1:
        if elements.gas.tense == 1:
            out.force += elements.gas.hold[i, w]
    return out


@wp.struct
class BandCorners:
    """Corners of a triangle such that the first two lie in one ring, and its rest shape in that order."""

    corners: wp.vec3i
    rest: wp.vec4
    first: int  # which of the triangle's corners is the first one


@wp.func
def band_corners(shell: ShellElements, rings: Rings, t: int, p: int) -> BandCorners:
    """Return the corners of triangle ``t`` of patient ``p`` in the order of its band."""
    out = BandCorners()
    corners = shell.triangles[t]
    rest = shell.rest[t, p]
    if rings.ring[corners[0]] != rings.ring[corners[1]]:
        if rings.ring[corners[1]] == rings.ring[corners[2]]:
            corners = wp.vec3i(corners[1], corners[2], corners[0])
            rest = wp.vec4(rest[1], rest[2], rest[0], rest[3])
            out.first = 1
        else:
            corners = wp.vec3i(corners[2], corners[0], corners[1])
            rest = wp.vec4(rest[2], rest[0], rest[1], rest[3])
            out.first = 2
    out.corners = corners
    out.rest = rest
    return out


@wp.func
def add_band_stretching(
    band: BandMatrix,
    shell: ShellElements,
    rings: Rings,
    x: wp.array2d[wp.vec3],
    t: int,
    r: int,
    w: int,
    moduli: wp.vec3,
    stiffening: float,
    tie: wp.vec3,
) -> BandMatrix:
    """Add the stretching of triangle ``t`` and its tension at rest to the band of ring ``r`` of world ``w``.

    Two of its corners lie in one ring: the edge between them is the first one, that to the third the second.
    """
    p = shell.patient[w]
    ordered = band_corners(shell, rings, t, p)
    corners = ordered.corners
    x0 = x[corners[0], w]
    k = tissue_edge_stiffness(x[corners[1], w] - x0, x[corners[2], w] - x0, ordered.rest, moduli, stiffening)
    own_tie = tie[ordered.first]
    far_tie = tie[(ordered.first + 1) % 3]
    eye = wp.identity(n=3, dtype=float)
    k.one += (own_tie + far_tie) * eye
    k.two += (tie[(ordered.first + 2) % 3] + far_tie) * eye
    k.both -= far_tie * eye
    along = rings.plane[corners[1], p] - rings.plane[corners[0], p]
    across = band_fields(rings, corners[2], r, p) - band_fields(rings, corners[0], r, p)
    out = add_edge(band, across, k.two)
    if rings.ring[corners[0]] == r:
        return add_own_edge(out, along, across, k.one, k.both)
    return add_next_edge(out, along, across, k.one, k.both)


@wp.func
def add_tissue_band_triangle(
    band: BandMatrix,
    elements: TissueShellElements,
    rings: Rings,
    x: wp.array2d[wp.vec3],
    t: int,
    r: int,
    w: int,
    moduli: wp.vec3,
) -> BandMatrix:
    """Add the stretching at once of triangle ``t`` to a band as :func:`.shell_kernels.add_band_stretching`."""
    own = triangle_moduli(elements, t, w, moduli)
    tie = wp.vec3(0.0)
    if elements.gassy == 1:
        tie = rest_ties(elements.gas, t, w)
    return add_band_stretching(band, elements.shell, rings, x, t, r, w, own, elements.stiffening, tie)
