# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Rings of the wall that hardly move, on a GPU: the stiffness around them is kept, and rows of the ring equations.

W worlds, V wall vertices, R rings.
"""

import warp as wp

from arcgym.sim.contact.contact_kernels import ContactRecords
from arcgym.sim.contact.self_contact_kernels import SelfContactForce
from arcgym.sim.wall.band_kernels import RingAxes, Rings
from arcgym.sim.wall.coarse_kernels import RingLoads, place_ring
from arcgym.sim.wall.kept_rows_kernels import KeptRows
from arcgym.sim.wall.wall_kernels import Tissue
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.warp_setup import FAST


@wp.struct
class KeptRingState:
    """What the rings were like when the stiffness around them was measured."""

    place: wp.array2d[wp.vec3]  # positions of the vertices [m], shape (V, W)
    tissue: wp.array2d[wp.vec4]  # see ``tissue_of``, shape (R, W)
    changed: wp.array2d[int]  # 1 where a ring has just been found to have moved since, else 0, shape (R, W)


@wp.func
def tissue_of(tissue: Tissue, w: int) -> wp.vec4:
    """Return all of a world's tissue that its ring equations depend on."""
    moduli = tissue.moduli[w]
    return wp.vec4(moduli[0], moduli[1], moduli[2], wp.where(tissue.rigid[w] == 1, -2.0, tissue.anchor[w]))


@wp.kernel(module="unique", module_options=FAST)
def place_changed_rings(
    x: wp.array2d[wp.vec3],
    rings: Rings,
    loads: RingLoads,
    axes: RingAxes,
    shift: wp.array2d[wp.vec3],
    tissue: Tissue,
    unmoved: float,
    kept: KeptRingState,
):
    """Do as ``place_rings``, and find the rings that have moved since they were measured. Launch (R, W).

    Args:
        x: Wall positions [m], shape (V, W).
        rings: Rings of all patients.
        loads: Loads of all patients.
        axes: Directions of the rings; written.
        shift: Shift of each ring's center [m], shape (R, W); written.
        tissue: Values of each world.
        unmoved: How far a vertex may be from its place in a ring that has not moved [m].
        kept: ``changed`` is written, and the rest where a ring has moved.
    """
    r, w = wp.tid()
    place_ring(x, rings, loads, axes, shift, r, w)
    now = tissue_of(tissue, w)
    farthest = float(0.0)
    for k in range(loads.members.shape[1]):
        i = wp.max(loads.members[r, k], loads.members[r, 0])
        farthest = wp.max(farthest, wp.length_sq(x[i, w] - kept.place[i, w]))
    changed = farthest > unmoved * unmoved or wp.length_sq(kept.tissue[r, w] - now) > 0.0
    kept.changed[r, w] = int(changed)
    if changed:
        kept.tissue[r, w] = now
        for k in range(loads.members.shape[1]):
            i = wp.max(loads.members[r, k], loads.members[r, 0])
            kept.place[i, w] = x[i, w]


@wp.kernel
def find_changed_rows(records: ContactRecords, self_contact: SelfContactForce, kept: KeptRingState, rows: KeptRows):
    """Find the row of each world from which on all are what they were at the last solution. Launch (R, W).

    A row holds the stiffness of the bands on either side of its ring, and that of the contacts there.

    Args:
        records: Contacts, listed by ring.
        self_contact: Contact of the wall with itself.
        kept: Rings, of which ``changed`` is read.
        rows: ``first``, zero before, and ``touched`` are written.
    """
    r, w = wp.tid()
    touches = records.ring_head[r, w] >= 0 or self_contact.in_contact[r, w] == 1
    if r > 0:
        touches = touches or records.ring_head[r - 1, w] >= 0
    changed = touches or rows.touched[r, w] == 1
    for k in range(wp.max(r - 1, 0), wp.min(r + 2, kept.changed.shape[0])):
        changed = changed or kept.changed[k, w] == 1
    rows.touched[r, w] = int(touches)
    if changed:
        wp.atomic_max(rows.first, w, r + 1)
