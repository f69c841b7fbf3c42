# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Weight of the wall and of what it holds. V wall vertices, P patients, W worlds."""

import warp as wp

from arcgym.sim.wall.wall_kernels import Tissue, WallNodes
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.math_kernels import clamp_length


@wp.kernel
def add_weight(
    nodes: WallNodes,
    tissue: Tissue,
    dt: float,
    load: wp.array2d[float],
    gravity: wp.array[wp.vec3],
    imaged: wp.vec3,
    inertial: wp.array2d[wp.vec3],
):
    """Add the way that weight falls in a step to where inertia takes mobile vertices. Launch (V, W).

    Inertia over the squared step, m / dt^2, times that way, load (g - g0) dt^2, is the weight m load (g - g0).

    Args:
        nodes: Vertices of all patients.
        tissue: Values of each world.
        dt: Physics step [s].
        load: Mass that weighs over the vertex's own, shape (V, P).
        gravity: Acceleration of free fall now [m/s^2], shape (W,).
        imaged: That which the rest shape bears already [m/s^2].
        inertial: Positions that inertia pulls to [m], shape (V, W); moved in place.
    """
    i, w = wp.tid()
    p = nodes.patient[w]
    if nodes.mobile[i, p] == 1 and tissue.rigid[w] == 0:
        inertial[i, w] = inertial[i, w] + (dt * dt * load[i, p]) * (gravity[w] - imaged)


@wp.kernel
def predict_weighing(
    first: int,
    x: wp.array2d[wp.vec3],
    v: wp.array2d[wp.vec3],
    nodes: WallNodes,
    tissue: Tissue,
    decay: float,
    largest_speed: float,
    dt: float,
    load: wp.array2d[float],
    gravity: wp.array[wp.vec3],
    imaged: wp.vec3,
    x_prev: wp.array2d[wp.vec3],
    inertial: wp.array2d[wp.vec3],
):
    """Do what ``wall_kernels.predict`` and then ``add_weight`` do. Launch (V, W), or some rows; arguments as theirs."""
    i, w = wp.tid()
    i += first
    p = nodes.patient[w]
    target = x[i, w]
    x_prev[i, w] = target
    if nodes.mobile[i, p] == 1 and tissue.rigid[w] == 0:
        target += dt * clamp_length(decay * v[i, w], largest_speed)
        target = target + (dt * dt * load[i, p]) * (gravity[w] - imaged)
    inertial[i, w] = target
