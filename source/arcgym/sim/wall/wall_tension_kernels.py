# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""What else holds the imaged shape under the tension and the pressure that it had.

Tension and pressure of a tube, p R around and half of it along, balance each other in a straight tube alone. In folds
and bends a rest is left, which taeniae, folds and a wall of uneven thickness bear in truth. Here it is a load on each
vertex that turns with its ring, so that a colon that swings as a whole feels nothing of it.
V wall vertices, R rings, P patients, W worlds.
"""

import warp as wp

from arcgym.sim.wall.gas_kernels import GasLaw, GasLoads, LumenRings, measure_slice
from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class HeldShape:
    """Loads that hold the imaged shape of each of P patients."""

    members: wp.array2d[int]  # vertices of each ring, -1 padded, shape (R, S)
    plane: wp.array2d[wp.vec2]  # in-plane coordinates of each vertex at rest, shape (V, P)
    load: wp.array2d[wp.vec3]  # at the imaging pressure, in the ring's frame [N], shape (V, P)


@wp.func
def ring_frame(x: wp.array2d[wp.vec3], held: HeldShape, r: int, w: int, patient: int) -> wp.mat33:
    """Return the frame of ring ``r``: its columns are the directions of p, of q and across both."""
    p = wp.vec3(0.0)
    q = wp.vec3(0.0)
    for k in range(held.members.shape[1]):
        i = held.members[r, k]
        if i >= 0:
            plane = held.plane[i, patient]
            p += plane[0] * x[i, w]
            q += plane[1] * x[i, w]
    p = wp.normalize(p)
    q = wp.normalize(q - wp.dot(p, q) * p)
    return wp.matrix_from_cols(p, q, wp.cross(p, q))


@wp.func
def turn_load(x: wp.array2d[wp.vec3], held: HeldShape, loads: GasLoads, r: int, w: int):
    """Turn the loads of ring ``r`` of world ``w`` with it, at ``x`` [m]; ``loads.hold`` is written."""
    patient = loads.patient[w]
    frame = loads.share[w] * ring_frame(x, held, r, w, patient)
    for k in range(held.members.shape[1]):
        i = held.members[r, k]
        if i >= 0:
            loads.hold[i, w] = frame * held.load[i, patient]


@wp.kernel
def turn_loads(x: wp.array2d[wp.vec3], held: HeldShape, loads: GasLoads):
    """Turn the loads with the rings. Launch (R, W).

    Args:
        x: Wall positions [m], shape (V, W).
        held: Loads of the imaged shapes.
        loads: What the gas does; ``hold`` is written.
    """
    r, w = wp.tid()
    turn_load(x, held, loads, r, w)


@wp.kernel
def measure_held_slices(
    x: wp.array2d[wp.vec3],
    lumen: LumenRings,
    law: GasLaw,
    held: HeldShape,
    volume: wp.array2d[float],
    loads: GasLoads,
):
    """Measure every ring's slice of the lumen, see ``measure_slice``, and turn the loads with it. Launch (R, W).

    Args:
        x: Wall positions [m], shape (V, W).
        lumen: Lumen of all patients.
        law: Settings.
        held: Loads of the imaged shapes.
        volume: Parts of the lumen's volume [m^3], shape (R, W); written.
        loads: What the gas does; ``prop`` and ``hold`` are written.
    """
    r, w = wp.tid()
    measure_slice(x, lumen, law, volume, loads.prop, r, w)
    turn_load(x, held, loads, r, w)
