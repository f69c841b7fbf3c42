# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""What a CPU does for the equations of the rings once, and a GPU in every thread of ``coarse_kernels.assemble``.

Launch dimensions: R rings, W worlds.
"""

import warp as wp

from arcgym.sim.contact.contact_kernels import ContactRecords
from arcgym.sim.wall.band_kernels import Rings
from arcgym.sim.wall.block_tridiagonal_kernels import MODES, Unknowns
from arcgym.sim.wall.coarse_kernels import RingLoads, add_share, ring_fields
from arcgym.sim.wall.wall_kernels import MeasuredContacts, Tissue
from arcgym.utils import warp_setup  # noqa: F401


@wp.kernel
def list_touching(records: ContactRecords, measured: MeasuredContacts):
    """Leave in the lists by ring what touches alone, in ascending order, for the equations of the rings. Launch (W,).

    Args:
        records: Contacts; ``ring_head`` and ``ring_next`` are written.
        measured: The same, measured.
    """
    w = wp.tid()
    first = w * records.capacity
    count = records.start[w, records.start.shape[1] - 1]
    for k in range(count):
        records.ring_head[records.ring[first + k], w] = -1
    for k in range(count):
        slot = first + count - 1 - k
        if measured.stiffness[slot][0] > 0.0:
            r = records.ring[slot]
            records.ring_next[slot] = records.ring_head[r, w]
            records.ring_head[r, w] = slot


@wp.kernel
def sum_forces(
    first: int,
    force: wp.array2d[wp.vec3],
    rings: Rings,
    loads: RingLoads,
    tissue: Tissue,
    rhs: wp.array3d[float],
):
    """Sum up the force on each unknown of a ring, on a CPU, which has all of them at hand. Launch (R, W).

    Arguments as of ``assemble``.
    """
    r, w = wp.tid()
    r += first
    p = rings.patient[w]
    total = Unknowns()
    if rings.moves[r, p] == 1 and tissue.rigid[w] == 0:
        for j in range(loads.members.shape[1]):
            v = wp.max(loads.members[r, j], 0)
            fields = float(loads.members[r, j] >= 0) * ring_fields(rings, v, p)
            total = add_share(total, fields, force[v, w])
    for a in range(MODES):
        rhs[r, w, a] = total[a]
