# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Shell with gas inside: pressure on its triangles, and the tension that the wall had when it was imaged.

At rest the stage's shape bears the pressure of its imaging, p0 across the wall, by a tension that is no part of the
simulated wall: at p0 neither acts. Above, the pressure p - p0 pushes outwards. Below, the tension, p0 R around and half
of it lengthwise, draws the wall together where the gas no longer bears it, by (p0 - p) R: the same radial load as a
pressure p - p0, but one that does not buckle the wall, which it does not in truth while the wall is in tension. Below
zero the whole tension draws, and the pressure p itself pushes inwards: there the wall collapses.

The tension is one of the imaged shape (second Piola-Kirchhoff), so that it acts as springs without a length along the
triangles' edges.
"""

import warp as wp

from arcgym.sim.wall.band_kernels import Rings, band_fields
from arcgym.sim.wall.band_matrix_kernels import BandMatrix, add_edge
from arcgym.sim.wall.gas_kernels import GasLoads
from arcgym.sim.wall.shell_kernels import ShellElements, add_band_triangle, add_elements, add_forces
from arcgym.sim.wall.wall_kernels import VertexBlock
from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class GasShellElements:
    """A shell and what the gas does to it."""

    shell: ShellElements
    gas: GasLoads


@wp.func
def gas_pressure(gas: GasLoads, t: int, w: int) -> float:
    """Return the pressure on triangle ``t`` of world ``w`` from within [Pa]."""
    return gas.push[w] + gas.prop[gas.ring[t], w]


@wp.func
def gas_ties(gas: GasLoads, corner: int, w: int) -> wp.vec2:
    """Return force over length along the two edges of a triangle from a corner, 3 * triangle + corner [N/m]."""
    return gas.draw[w] * gas.tie[corner, gas.patient[w]]


@wp.kernel
def add_gas(x: wp.array2d[wp.vec3], elements: GasShellElements):
    """Add the gas to the measured corner forces at ``x`` [m], shape (V, W). Launch (F, W)."""
    t, w = wp.tid()
    shell = elements.shell
    corners = shell.triangles[t]
    x0 = x[corners[0], w]
    d1 = x[corners[1], w] - x0
    d2 = x[corners[2], w] - x0
    third = (gas_pressure(elements.gas, t, w) / 6.0) * wp.cross(d1, d2)
    from_first = gas_ties(elements.gas, 3 * t, w)
    across = gas_ties(elements.gas, 3 * t + 1, w)[0]
    first = third + from_first[0] * d1 + from_first[1] * d2
    second = third - from_first[0] * d1 + across * (d2 - d1)
    shell.corner_force[3 * t, w] = shell.corner_force[3 * t, w] + first
    shell.corner_force[3 * t + 1, w] = shell.corner_force[3 * t + 1, w] + second
    shell.corner_force[3 * t + 2, w] = shell.corner_force[3 * t + 2, w] + (3.0 * third - first - second)


@wp.func
def add_gas_elements(
    block: VertexBlock, elements: GasShellElements, x: wp.array2d[wp.vec3], i: int, w: int, moduli: wp.vec3
) -> VertexBlock:
    """Add shell and gas around vertex ``i`` of world ``w``, as :func:`.shell_kernels.add_elements`.

    The Hessian of the pressure is zero for a closed fan.
    """
    shell = elements.shell
    out = add_elements(block, shell, x, i, w, moduli)
    if elements.gas.tense == 1:
        out.force += elements.gas.hold[i, w]
    here = x[i, w]
    for k in range(shell.fan_start[i], shell.fan_start[i + 1]):
        triangle = shell.fan[k]
        d1 = x[triangle.first, w] - here
        d2 = x[triangle.second, w] - here
        ties = gas_ties(elements.gas, shell.fan_corner[k], w)
        pressure = gas_pressure(elements.gas, triangle.index, w)
        out.force += (pressure / 6.0) * wp.cross(d1, d2) + ties[0] * d1 + ties[1] * d2
        out.hessian += (ties[0] + ties[1]) * wp.identity(n=3, dtype=float)
    return out


@wp.func
def add_gas_forces(
    block: VertexBlock, elements: GasShellElements, x: wp.array2d[wp.vec3], i: int, w: int, moduli: wp.vec3
) -> VertexBlock:
    """Add the measured forces of the triangles around vertex ``i`` of world ``w``, the gas among them."""
    out = add_forces(block, elements.shell, x, i, w, moduli)
    if elements.gas.tense == 1:
        out.force += elements.gas.hold[i, w]
    return out


@wp.func
def triangle_ties(gas: GasLoads, t: int, w: int) -> wp.vec3:
    """Return force over length along the edges of a triangle, from each corner to the next [N/m]."""
    return wp.vec3(gas_ties(gas, 3 * t, w)[0], gas_ties(gas, 3 * t + 1, w)[0], gas_ties(gas, 3 * t + 2, w)[0])


@wp.func
def rest_ties(gas: GasLoads, t: int, w: int) -> wp.vec3:
    """Return force over length along the edges of a triangle, from each corner to the next, of its tension at rest
    [N/m]; zero without one.

    The pressure, which takes part of this stiffness back, is left out: the coarse matrix must nowhere be softer than
    the wall.
    """
    if gas.tense == 0:
        return wp.vec3(0.0)
    return triangle_ties(gas, t, w)


@wp.func
def add_band_ties(band: BandMatrix, elements: GasShellElements, rings: Rings, t: int, r: int, w: int) -> BandMatrix:
    """Add the tension at rest of triangle ``t`` to the stiffness of the band of ring ``r`` of world ``w``."""
    p = elements.shell.patient[w]
    corners = elements.shell.triangles[t]
    ties = rest_ties(elements.gas, t, w)
    a = band_fields(rings, corners[0], r, p)
    b = band_fields(rings, corners[1], r, p)
    c = band_fields(rings, corners[2], r, p)
    eye = wp.identity(n=3, dtype=float)
    out = add_edge(band, b - a, ties[0] * eye)
    out = add_edge(out, c - b, ties[1] * eye)
    return add_edge(out, a - c, ties[2] * eye)


@wp.func
def add_gas_band_triangle(
    band: BandMatrix,
    elements: GasShellElements,
    rings: Rings,
    x: wp.array2d[wp.vec3],
    t: int,
    r: int,
    w: int,
    moduli: wp.vec3,
) -> BandMatrix:
    """Add triangle ``t`` to a band as :func:`.shell_kernels.add_band_triangle`, and a tension that is there at rest."""
    out = add_band_triangle(band, elements.shell, rings, x, t, r, w, moduli)
    if elements.gas.tense == 1:
        out = add_band_ties(out, elements, rings, t, r, w)
    return out
