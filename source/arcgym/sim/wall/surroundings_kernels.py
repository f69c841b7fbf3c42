# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Forces of all that lies around the wall, in one launch. V wall vertices, R rings, W worlds."""

import warp as wp

from arcgym.sim.contact.bend_contact_kernels import Bends, push_limbs
from arcgym.sim.wall.abdomen_kernels import AbdomenShape, AbdominalHand, press_wall
from arcgym.sim.wall.mesentery_kernels import Sheets, pull_ring
from arcgym.sim.wall.outer_force_kernels import OuterForce, clear_outer_force
from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class Around:
    """What there is around the wall; what there is not has no arrays."""

    members: wp.array2d[int]  # vertices of each ring, -1 padded, shape (R, S)
    pressing: int  # whether there is an abdomen
    shape: AbdomenShape
    hand: AbdominalHand
    load: wp.array2d[wp.vec3]  # of each ring on hand and abdomen, see ``press_wall``, shape (R, W)
    pulling: int  # whether there are mesenteries
    sheets: Sheets
    folding: int  # whether limbs of one bend push on each other
    bends: Bends


@wp.kernel
def measure_surroundings(x: wp.array2d[wp.vec3], around: Around, scale: wp.array[float], dt: float, outer: OuterForce):
    """Forget the last step's forces on each ring, and measure those of abdomen, mesentery and bends. Launch (R, W).

    Args:
        x: Wall positions [m], shape (V, W).
        around: What there is around the wall; ``load`` is written.
        scale: Factor on all attachments of a world, shape (W,).
        dt: Physics step [s].
        outer: Forces; written.
    """
    r, w = wp.tid()
    clear_outer_force(around.members, outer, r, w)
    if around.pressing == 1:
        press_wall(x, around.shape, around.hand, dt, outer, around.load, r, w)
    if around.pulling == 1:
        pull_ring(x, around.sheets, scale, outer, r, w)
    if around.folding == 1:
        push_limbs(x, around.bends, outer, r, w)
