# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Kernel of the bending section. W worlds."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.kernel
def drive_bending(
    command: wp.array[wp.vec2],
    rate: float,
    limit: wp.vec2,
    dt: float,
    hinge_coords: wp.array[wp.vec2i],
    coords: int,
    bending: wp.array[wp.vec2],
    target: wp.array[float],
):
    """Turn the control wheels towards the command and spread the angle over the bending section. Launch (W,).

    ``hinge_coords`` are the joint coordinates of each actuated hinge's pitch and yaw; all hinges share alike.
    """
    w = wp.tid()
    now = bending[w]
    for k in range(2):
        goal = wp.clamp(command[w][k], -limit[k], limit[k])
        now[k] = now[k] + wp.clamp(goal - now[k], -rate * dt, rate * dt)
    bending[w] = now
    share = now / float(hinge_coords.shape[0])
    for h in range(hinge_coords.shape[0]):
        for k in range(2):
            target[w * coords + hinge_coords[h][k]] = share[k]


@wp.kernel
def drive_bending_by_cables(
    command: wp.array[wp.vec2],
    rate: float,
    limit: wp.vec2,
    dt: float,
    hinge_coords: wp.array[wp.vec2i],
    coords: int,
    play: float,
    way: float,
    bending: wp.array[wp.vec2],
    slack: wp.array[wp.vec2],
    behind: wp.array[wp.vec2],
    target: wp.array[float],
):
    """Do as ``drive_bending`` with play between the wheels and the cables, and a lag behind those. Launch (W,).

    The cables hold still while the wheel is within ``play`` [rad] of them, and the section goes the share ``way`` of
    what it is ``behind`` them in a step. ``slack`` is wheel less cables, so that zeros are a drive at rest.
    """
    w = wp.tid()
    now = bending[w]
    cable = now + behind[w]
    wheel = cable + slack[w]
    for k in range(2):
        goal = wp.clamp(command[w][k], -limit[k], limit[k])
        wheel[k] = wheel[k] + wp.clamp(goal - wheel[k], -rate * dt, rate * dt)
        cable[k] = wp.clamp(cable[k], wheel[k] - play, wheel[k] + play)
        now[k] = now[k] + way * (cable[k] - now[k])
    bending[w] = now
    slack[w] = wheel - cable
    behind[w] = cable - now
    share = now / float(hinge_coords.shape[0])
    for h in range(hinge_coords.shape[0]):
        for k in range(2):
            target[w * coords + hinge_coords[h][k]] = share[k]
