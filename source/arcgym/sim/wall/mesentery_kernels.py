# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Pull of the mesenteries on the rings of the wall. V wall vertices, R rings, P patients, W worlds.

A sheet of the length l from its root to the middle of a ring pulls the ring to the root by T per length of colon,
T = E t / b (exp(b e) - 1) with the strain e = d / l - 1 at the distance d, by nothing where it lies in folds, e < 0.
"""

import warp as wp

from arcgym.sim.wall.outer_force_kernels import OuterForce, put_outer_force
from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class Sheets:
    """Mesentery of each of P patients, and what differs between worlds."""

    patient: wp.array[int]  # patient of each world, shape (W,)
    members: wp.array2d[int]  # vertices of each ring, -1 padded, shape (R, S)
    root: wp.array2d[wp.vec3]  # where the sheet of each ring begins [m], shape (R, P)
    height: wp.array2d[float]  # way from there to the ring as imaged, 0 where there is no sheet [m], shape (R, P)
    width: wp.array2d[float]  # length of colon that each ring stands for [m], shape (R, P)
    fullness: wp.array[float]  # length of the sheets over their heights, shape (W,)
    stiffness: wp.array[float]  # E t [N/m], shape (W,)
    stiffening: float  # b
    largest_strain: float  # from which the tension grows linearly


@wp.func
def sheet_tension(strain: float, stiffness: float, stiffening: float, largest: float) -> wp.vec2:
    """Return the tension of a sheet per width [N/m], and its slope by the strain [N/m]; none in folds."""
    if strain <= 0.0:
        return wp.vec2(0.0, 0.0)
    e = wp.min(strain, largest)
    slope = stiffness * wp.exp(stiffening * e)
    tension = stiffness * e
    if stiffening > 1.0e-3:
        tension = (slope - stiffness) / stiffening
    return wp.vec2(tension + slope * (strain - e), slope)


@wp.func
def ring_middle(x: wp.array2d[wp.vec3], members: wp.array2d[int], r: int, w: int) -> wp.vec4:
    """Return the mean of a ring's vertices [m], and their number."""
    total = wp.vec3(0.0)
    count = float(0.0)
    for k in range(members.shape[1]):
        i = members[r, k]
        if i >= 0:
            total += x[i, w]
            count += 1.0
    return wp.vec4(total[0] / count, total[1] / count, total[2] / count, count)


@wp.func
def sheet_pull(sheets: Sheets, u: wp.vec3, r: int, w: int) -> wp.vec2:
    """Return the pull of ring ``r``'s sheet at ``u`` from its root [N], and its slope by the distance [N/m]."""
    p = sheets.patient[w]
    rest = sheets.height[r, p] * sheets.fullness[w]
    law = sheet_tension(wp.length(u) / rest - 1.0, sheets.stiffness[w], sheets.stiffening, sheets.largest_strain)
    return sheets.width[r, p] * wp.vec2(law[0], law[1] / rest)


@wp.func
def pull_ring(x: wp.array2d[wp.vec3], sheets: Sheets, scale: wp.array[float], outer: OuterForce, r: int, w: int):
    """Pull ring ``r`` of world ``w`` to the root of its sheet, all its vertices alike.

    Args:
        x: Wall positions [m], shape (V, W).
        sheets: Mesenteries.
        scale: Factor on all attachments of a world, shape (W,).
        outer: Forces; added to.
        r: Ring.
        w: World.
    """
    p = sheets.patient[w]
    if sheets.height[r, p] == 0.0:
        return
    middle = ring_middle(x, sheets.members, r, w)
    u = wp.vec3(middle[0], middle[1], middle[2]) - sheets.root[r, p]
    law = (scale[w] / middle[3]) * sheet_pull(sheets, u, r, w)
    if law[0] <= 0.0:
        return
    d = wp.length(u)
    along = wp.outer(u, u) / (d * d)
    stiffness = law[1] * along + (law[0] / d) * (wp.identity(n=3, dtype=float) - along)
    for k in range(sheets.members.shape[1]):
        i = sheets.members[r, k]
        if i >= 0:
            put_outer_force(outer, i, w, x[i, w], (-law[0] / d) * u, stiffness)
    outer.near[r, w] = 1


@wp.kernel
def read_sheets(
    x: wp.array2d[wp.vec3],
    sheets: Sheets,
    scale: wp.array[float],
    tension: wp.array2d[float],
    tension_peak: wp.array2d[float],
):
    """Add the pulls of the sheets to the sums and peaks of the rings' tensions. Launch (R, W).

    Args:
        x: Wall positions [m], shape (V, W).
        sheets: Mesenteries.
        scale: Factor on all attachments of a world, shape (W,).
        tension: Sum of tensions [N], shape (R, W); added to.
        tension_peak: Largest tension [N], shape (R, W); raised.
    """
    r, w = wp.tid()
    p = sheets.patient[w]
    if sheets.height[r, p] == 0.0:
        return
    middle = ring_middle(x, sheets.members, r, w)
    u = wp.vec3(middle[0], middle[1], middle[2]) - sheets.root[r, p]
    pull = scale[w] * sheet_pull(sheets, u, r, w)[0]
    tension[r, w] = tension[r, w] + pull
    tension_peak[r, w] = wp.max(tension_peak[r, w], pull)
