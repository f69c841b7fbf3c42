# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What moves a scope: base drive, introducer, bending section, pull on the tip. One launch a scope substep each.

W worlds, L links, J joint coordinates a world; the root's slide and roll are coordinates 0 and 1 of a shaft.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class BaseDrive:
    """Springs that hold the shaft's base at its target."""

    slide_stiffness: float  # [N/m]
    slide_damping: float  # [N s/m]
    force_limit: float  # [N]
    furthest: float  # slide at which the base link reaches the anus [m]
    roll_stiffness: float  # [N m/rad]
    torque_limit: float  # [N m]


@wp.struct
class TipPull:
    """Force-limited spring from the tip to a target that moves at the commanded velocity."""

    stiffness: float  # [N/m]
    damping: float  # [N s/m]
    force_limit: float  # [N]
    angular_stiffness: float  # [N m/rad]
    angular_damping: float  # [N m s/rad]
    torque_limit: float  # [N m]


@wp.func
def limited(v: wp.vec3, limit: float) -> wp.vec3:
    """Vector shortened to ``limit``."""
    length = wp.length(v)
    if length > limit:
        return v * (limit / length)
    return v


@wp.kernel
def drive_base(
    joint_q: wp.array(dtype=float),
    joint_qd: wp.array(dtype=float),
    coords: int,
    dofs: int,
    drive: BaseDrive,
    velocity: wp.array(dtype=float),
    roll_rate: wp.array(dtype=float),
    dt: float,
    weight: float,
    target: wp.array(dtype=float),
    force: wp.array(dtype=float),
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
    push = drive.slide_stiffness * (t - z) - drive.slide_damping * joint_qd[w * dofs]
    force[w] = force[w] + weight * wp.clamp(push, -drive.force_limit, drive.force_limit)
    twist = drive.torque_limit / drive.roll_stiffness
    angle = joint_q[slide + 1]
    target[slide + 1] = wp.clamp(target[slide + 1] + roll_rate[w] * dt, angle - twist, angle + twist)


@wp.kernel
def drive_bending(
    command: wp.array(dtype=wp.vec2),
    rate: float,
    limit: wp.vec2,
    dt: float,
    first: int,
    hinges: int,
    coords: int,
    share: wp.vec2,
    bending: wp.array(dtype=wp.vec2),
    target: wp.array(dtype=float),
):
    """Turn the control wheels towards the command and spread the angle over the bending section. Launch (W,).

    Hinges alternate between pitch (odd) and yaw (even); ``first`` is the number of the first actuated one, and
    ``share`` the reciprocal of the number of hinges of either kind.
    """
    w = wp.tid()
    now = bending[w]
    for k in range(2):
        goal = wp.clamp(command[w][k], -limit[k], limit[k])
        now[k] = now[k] + wp.clamp(goal - now[k], -rate * dt, rate * dt)
    bending[w] = now
    for h in range(hinges):
        hinge = first + h
        angle = now[0] * share[0]
        if hinge % 2 == 0:
            angle = now[1] * share[1]
        target[w * coords + 1 + hinge] = angle


@wp.kernel
def guide_base(
    body_q: wp.array(dtype=wp.transform),
    body_qd: wp.array(dtype=wp.spatial_vector),
    stiffness: float,
    damping: float,
    height: float,
    radius: float,
    body_f: wp.array(dtype=wp.spatial_vector),
):
    """Introducer: spring every link still outside the anus sideways onto the Z axis. Launch (W*L,)."""
    i = wp.tid()
    p = wp.transform_get_translation(body_q[i])
    if p[2] < height and wp.abs(p[0]) < radius and wp.abs(p[1]) < radius:
        v = wp.spatial_top(body_qd[i])
        force = wp.vec3(-stiffness * p[0] - damping * v[0], -stiffness * p[1] - damping * v[1], 0.0)
        body_f[i] = body_f[i] + wp.spatial_vector(force, wp.vec3(0.0))


@wp.kernel
def pull_tip(
    body_q: wp.array(dtype=wp.transform),
    body_qd: wp.array(dtype=wp.spatial_vector),
    links: int,
    pull: TipPull,
    lin_command: wp.array(dtype=wp.vec3),
    ang_command: wp.array(dtype=wp.vec3),
    dt: float,
    weight: float,
    lead: wp.array(dtype=wp.vec3),
    turn: wp.array(dtype=wp.vec3),
    body_f: wp.array(dtype=wp.spatial_vector),
    force: wp.array(dtype=wp.vec3),
):
    """Pull the last link after its target. Launch (W,).

    ``lead`` [m] and ``turn`` [rad] are how far the target is ahead of the tip; they grow with the commanded velocity
    (given in the tip's frame) less the tip's own and never beyond what the force limits hold.
    """
    w = wp.tid()
    tip = (w + 1) * links - 1
    v = wp.spatial_top(body_qd[tip])
    omega = wp.spatial_bottom(body_qd[tip])
    v_goal = wp.transform_vector(body_q[tip], lin_command[w])
    omega_goal = wp.transform_vector(body_q[tip], ang_command[w])
    d = limited(lead[w] + (v_goal - v) * dt, pull.force_limit / pull.stiffness)
    e = limited(turn[w] + (omega_goal - omega) * dt, pull.torque_limit / pull.angular_stiffness)
    lead[w] = d
    turn[w] = e
    f = limited(pull.stiffness * d + pull.damping * (v_goal - v), pull.force_limit)
    m = limited(pull.angular_stiffness * e + pull.angular_damping * (omega_goal - omega), pull.torque_limit)
    body_f[tip] = body_f[tip] + wp.spatial_vector(f, m)
    force[w] = force[w] + weight * f


@wp.kernel
def add_gravity(
    body_mass: wp.array(dtype=float), gravity: wp.vec3, scaling: float, body_f: wp.array(dtype=wp.spatial_vector)
):
    """Weight of the real, unscaled link masses. Launch (W*L,)."""
    i = wp.tid()
    body_f[i] = body_f[i] + wp.spatial_vector(gravity * (body_mass[i] / scaling), wp.vec3(0.0))
