# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Kernels of a shaft's base. W worlds; slide and roll are a world's joint coordinates 0 and 1."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class BaseSprings:
    """Springs that hold the shaft's base at its target."""

    slide_stiffness: float  # [N/m]
    slide_damping: float  # [N s/m]
    force_limit: float  # [N]
    furthest: float  # slide at which the base link reaches the anus [m]
    roll_stiffness: float  # [N m/rad]
    torque_limit: float  # [N m]


@wp.kernel
def drive_base(
    joint_q: wp.array[float],
    coords: int,
    drive: BaseSprings,
    velocity: wp.array[float],
    roll_rate: wp.array[float],
    dt: float,
    target: wp.array[float],
):
    """Move the base targets on, never further ahead than the drive's force limits reach. Launch (W,).

    The drive's force is k (target - z) - c v; the target may therefore lead by the limit plus the damping's share.
    """
    w = wp.tid()
    slide = w * coords
    z = joint_q[slide]
    lead = drive.force_limit / drive.slide_stiffness
    lag = drive.slide_damping * velocity[w] / drive.slide_stiffness
    t = target[slide] + velocity[w] * dt
    t = wp.clamp(t, z - lead + wp.min(lag, 0.0), z + lead + wp.max(lag, 0.0))
    t = wp.min(t, drive.furthest)
    target[slide] = t
    twist = drive.torque_limit / drive.roll_stiffness
    angle = joint_q[slide + 1]
    target[slide + 1] = wp.clamp(target[slide + 1] + roll_rate[w] * dt, angle - twist, angle + twist)


@wp.kernel
def record_push(drive_force: wp.array2d[float], weight: float, total: wp.array[float]):
    """Add ``weight`` times the force of the slide's drive to ``total``. Launch (W,)."""
    w = wp.tid()
    total[w] = total[w] + weight * drive_force[0, w]


@wp.kernel
def slide_force(
    joint_q: wp.array[float],
    joint_qd: wp.array[float],
    target: wp.array[float],
    coords: int,
    drive: BaseSprings,
    force: wp.array2d[float],
):
    """Force of the slide's drive by its spring law, for solvers that do not tell. Launch (W,)."""
    w = wp.tid()
    i = w * coords
    push = drive.slide_stiffness * (target[i] - joint_q[i]) - drive.slide_damping * joint_qd[i]
    force[0, w] = wp.clamp(push, -drive.force_limit, drive.force_limit)
