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
    first: int,
    hinge_coords: wp.array[int],
    coords: int,
    share: wp.vec2,
    bending: wp.array[wp.vec2],
    target: wp.array[float],
):
    """Turn the control wheels towards the command and spread the angle over the bending section. Launch (W,).

    Hinges alternate between pitch (odd) and yaw (even); ``first`` is the number of the first actuated one,
    ``hinge_coords`` the joint coordinate of each, and ``share`` the reciprocal of the number of hinges of either kind.
    """
    w = wp.tid()
    now = bending[w]
    for k in range(2):
        goal = wp.clamp(command[w][k], -limit[k], limit[k])
        now[k] = now[k] + wp.clamp(goal - now[k], -rate * dt, rate * dt)
    bending[w] = now
    for h in range(hinge_coords.shape[0]):
        hinge = first + h
        angle = now[0] * share[0]
        if hinge % 2 == 0:
            angle = now[1] * share[1]
        target[w * coords + hinge_coords[h]] = angle
