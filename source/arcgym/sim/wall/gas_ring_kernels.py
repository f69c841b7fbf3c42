# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""How far the rings give way to a pressure in the lumen, see ``gas_rings``.

R rings, V wall vertices, M modes, W worlds.
"""

import warp as wp

from arcgym.sim.wall.band_kernels import Rings
from arcgym.sim.wall.block_tridiagonal_kernels import MODES, Unknowns
from arcgym.sim.wall.coarse_kernels import RingLoads, add_share, ring_fields
from arcgym.sim.wall.gas_kernels import GasLaw, GasLoads, GasState, add_flow, note_pressure, set_loads, total_volume
from arcgym.sim.wall.shell_kernels import ShellElements
from arcgym.sim.wall.wall_kernels import Tissue
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.math_kernels import clamp_length


@wp.func
def volume_share(shell: ShellElements, i: int, w: int) -> wp.vec3:
    """Return what a move of vertex ``i`` adds to the volume of world ``w``, the force of 1 Pa on it [m^2]."""
    total = wp.vec3(0.0)
    for k in range(shell.fan_start[i], shell.fan_start[i + 1]):
        scaled = shell.scaled_normal[shell.fan_corner[k] // 3, w]
        total += scaled / wp.max(wp.length_sq(scaled), 1.0e-12)
    return total / 6.0


@wp.kernel
def assemble_push(
    shell: ShellElements,
    rings: Rings,
    loads: RingLoads,
    tissue: Tissue,
    push: wp.array3d[float],
    answer: wp.array3d[float],
):
    """Sum up the force of 1 Pa on every unknown of the coarse system. Launch (R, W).

    Args:
        shell: The shell, measured.
        rings: Rings of all patients.
        loads: Loads of all patients.
        tissue: Values of each world.
        push: Force of 1 Pa on each unknown [m^2], shape (R, W, M); written.
        answer: The same, to be solved for; written.
    """
    r, w = wp.tid()
    p = rings.patient[w]
    total = Unknowns()
    if rings.moves[r, p] == 1 and tissue.rigid[w] == 0:
        for j in range(loads.members.shape[1]):
            v = loads.members[r, j]
            if v >= 0:
                total = add_share(total, ring_fields(rings, v, p), volume_share(shell, v, w))
    for a in range(MODES):
        push[r, w, a] = total[a]
        answer[r, w, a] = total[a]


@wp.kernel
def measure_gain(
    push: wp.array3d[float], solution: wp.array3d[float], answer: wp.array3d[float], gain: wp.array2d[wp.vec2]
):
    """Measure the volume that each ring's move adds, and that its answer to 1 Pa would add. Launch (R, W).

    Args:
        push: Force of 1 Pa on each unknown [m^2], shape (R, W, M).
        solution: Move of the wall without a change of pressure [m], shape (R, W, M).
        answer: Move by 1 Pa [m/Pa], shape (R, W, M).
        gain: The two volumes [m^3], [m^3/Pa], shape (R, W); written.
    """
    r, w = wp.tid()
    moved = float(0.0)
    given = float(0.0)
    for a in range(MODES):
        moved += push[r, w, a] * solution[r, w, a]
        given += push[r, w, a] * answer[r, w, a]
    gain[r, w] = wp.vec2(moved, given)


@wp.kernel
def settle_pressure(
    volume: wp.array2d[float],
    gain: wp.array2d[wp.vec2],
    law: GasLaw,
    dt: float,
    last: int,
    gas: GasState,
    loads: GasLoads,
    change: wp.array[float],
):
    """Let gas flow, and find the pressure at which gas and wall agree at the end of the step. Launch (W,).

    Args:
        volume: Parts of the volume where the wall is [m^3], shape (R, W).
        gain: Volumes that its move adds without a change of pressure, and with it, shape (R, W).
        law: Settings.
        dt: Time in which gas flows [s].
        last: Whether the step ends with it: 1, or 0.
        gas: State; amount and pressure are changed.
        loads: Loads of the pressure; written.
        change: Change of the pressure [Pa], shape (W,); written.
    """
    w = wp.tid()
    if dt > 0.0:
        add_flow(law, dt, gas, w)
    moved = float(0.0)
    given = float(0.0)
    for r in range(gain.shape[0]):
        moved += gain[r, w][0]
        given += gain[r, w][1]
    here = total_volume(volume, w)
    there = wp.max(here + moved, 0.5 * here)
    absolute = law.ambient + gas.pressure[w]
    by = (gas.amount[w] - absolute * there) / (there + absolute * wp.max(given, 0.0))
    gas.pressure[w] = gas.pressure[w] + by
    gas.volume[w] = there + given * by
    change[w] = by
    set_loads(law, gas, loads, w)
    if last == 1:
        note_pressure(gas, w)


@wp.kernel
def prolong_with_gas(
    first: int,
    rings: Rings,
    solution: wp.array3d[float],
    answer: wp.array3d[float],
    change: wp.array[float],
    largest_move: float,
    x: wp.array2d[wp.vec3],
):
    """Move every vertex with its ring, which answers to the change of pressure, too. Launch (V, W), or some rows.

    Args:
        first: First row of this launch.
        rings: Rings of all patients.
        solution: Amplitude of each unknown without a change of pressure [m], shape (R, W, M).
        answer: That of 1 Pa [m/Pa], shape (R, W, M).
        change: Change of the pressure [Pa], shape (W,).
        largest_move: Longest displacement of a vertex [m].
        x: Positions [m], shape (V, W); moved in place.
    """
    i, w = wp.tid()
    i += first
    r = rings.ring[i]
    by = change[w]
    fields = ring_fields(rings, i, rings.patient[w])
    d = wp.vec3(0.0)
    for k in range(3):
        d += fields[k] * wp.vec3(
            solution[r, w, 3 * k] + by * answer[r, w, 3 * k],
            solution[r, w, 3 * k + 1] + by * answer[r, w, 3 * k + 1],
            solution[r, w, 3 * k + 2] + by * answer[r, w, 3 * k + 2],
        )
    x[i, w] = x[i, w] + clamp_length(d, largest_move)
