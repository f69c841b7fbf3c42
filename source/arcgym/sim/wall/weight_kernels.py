# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Weight of the wall and of what it holds. V wall vertices, P patients, W worlds."""

import warp as wp

from arcgym.sim.wall.wall_kernels import Tissue, WallNodes
from arcgym.utils import warp_setup  # noqa: F401


@wp.kernel
def add_weight(
    nodes: WallNodes,
    tissue: Tissue,
    load: wp.array2d[float],
    gravity: wp.array[wp.vec3],
    imaged: wp.vec3,
    dt: float,
    inertial: wp.array2d[wp.vec3],
):
    """Add the way that weight falls in a step to where inertia takes mobile vertices. Launch (V, W).

    Inertia over the squared step, m / dt^2, times that way, load (g - g0) dt^2, is the weight m load (g - g0).

    Args:
        nodes: Vertices of all patients.
        tissue: Values of each world.
        load: Mass that weighs over the vertex's own, shape (V, P).
        gravity: Acceleration of free fall now [m/s^2], shape (W,).
        imaged: That which the rest shape bears already [m/s^2].
        dt: Physics step [s].
        inertial: Positions that inertia pulls to [m], shape (V, W); moved in place.
    """
    i, w = wp.tid()
    p = nodes.patient[w]
    if nodes.mobile[i, p] == 1 and tissue.rigid[w] == 0:
        inertial[i, w] = inertial[i, w] + (dt * dt * load[i, p]) * (gravity[w] - imaged)
