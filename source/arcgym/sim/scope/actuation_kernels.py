# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""What moves a scope: base drive, introducer, bending section, pull on the tip. Launched every scope substep.

Forces hold for links that keep their velocity; ``resistance`` is the diagonal of their drop by acceleration (linear
[kg], angular [kg m^2]), with which a solver makes springs and dampers implicit.

W worlds, L links, J joint coordinates a world; the root's slide and roll are coordinates 0 and 1 of a shaft.
"""

import warp as wp

from arcgym.sim.geometry_kernels import clamp_length
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


FIRST_RINGS = wp.constant(1)
"""Last of the colon's rings that a link near the anus may be in."""
SPHINCTER = wp.constant(0.05)
"""Length over which the sphincter lifts what sinks into it; what is farther down is out, and stays there [m]."""


@wp.struct
class Introducer:
    """Springs that keep the shaft straight outside the anus, and what is inside from coming out of it."""

    stiffness: float  # [N/m]
    damping: float  # [N s/m]
    height: float  # up to which links are pulled onto the Z axis [m]
    min_height: float  # down to which links that belong inside may sink [m]
    rest: wp.array(dtype=float)  # height of each link where the slide is at zero and the shaft straight [m], shape (L,)


@wp.kernel
def drive_base(
    joint_q: wp.array(dtype=float),
    coords: int,
    drive: BaseDrive,
    velocity: wp.array(dtype=float),
    roll_rate: wp.array(dtype=float),
    dt: float,
    target: wp.array(dtype=float),
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
def drive_bending(
    command: wp.array(dtype=wp.vec2),
    rate: float,
    limit: wp.vec2,
    dt: float,
    first: int,
    hinge_coords: wp.array(dtype=int),
    coords: int,
    share: wp.vec2,
    bending: wp.array(dtype=wp.vec2),
    target: wp.array(dtype=float),
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


@wp.kernel
def load_links(
    body_q: wp.array(dtype=wp.transform),
    body_qd: wp.array(dtype=wp.spatial_vector),
    body_mass: wp.array(dtype=float),
    gravity: wp.vec3,
    guide: Introducer,
    joint_q: wp.array(dtype=float),
    coords: int,
    ring: wp.array2d(dtype=int),
    dt: float,
    body_f: wp.array(dtype=wp.spatial_vector),
    resistance: wp.array2d(dtype=wp.spatial_vector),
):
    """Weight of every link, and the springs of the introducer near the colon's first rings. Launch (L, W).

    Low links are pulled sideways onto the Z axis. The base's slide tells how high each would be in a straight shaft; a
    link up to ``SPHINCTER`` lower than that, and lower than ``min_height``, is lifted. ``ring`` has the shape (W, L).
    """
    link, w = wp.tid()
    i = w * resistance.shape[0] + link
    force = body_mass[i] * gravity
    held = wp.vec3(0.0)
    p = wp.transform_get_translation(body_q[i])
    if ring[w, link] <= FIRST_RINGS:
        v = wp.spatial_top(body_qd[i])
        damping = guide.damping + dt * guide.stiffness
        if p[2] < guide.height:
            force -= wp.vec3(guide.stiffness * p[0] + damping * v[0], guide.stiffness * p[1] + damping * v[1], 0.0)
            held = wp.vec3(dt * damping, dt * damping, 0.0)
        low = guide.min_height + wp.min(guide.rest[link] + joint_q[w * coords], 0.0) - p[2]
        if low > 0.0 and low < SPHINCTER:
            force[2] = force[2] + guide.stiffness * low - damping * v[2]
            held[2] = dt * damping
    body_f[i] = wp.spatial_vector(force, wp.vec3(0.0))
    resistance[link, w] = wp.spatial_vector(held, wp.vec3(0.0))


@wp.kernel
def pull_tip(
    body_q: wp.array(dtype=wp.transform),
    body_qd: wp.array(dtype=wp.spatial_vector),
    pull: TipPull,
    lin_command: wp.array(dtype=wp.vec3),
    ang_command: wp.array(dtype=wp.vec3),
    dt: float,
    lead: wp.array(dtype=wp.vec3),
    turn: wp.array(dtype=wp.vec3),
    body_f: wp.array(dtype=wp.spatial_vector),
    resistance: wp.array2d(dtype=wp.spatial_vector),
    force: wp.array(dtype=wp.vec4),
):
    """Pull the last link after its target. Launch (W,).

    ``lead`` [m] and ``turn`` [rad] are how far the target is ahead of the tip; they grow with the commanded velocity
    (given in the tip's frame) less the tip's own and never beyond what the force limits hold. ``force`` is the pull and
    its drop by the tip's acceleration; a pull at its limit does not drop.
    """
    w = wp.tid()
    links = resistance.shape[0]
    tip = (w + 1) * links - 1
    ahead = wp.transform_vector(body_q[tip], lin_command[w]) - wp.spatial_top(body_qd[tip])
    spin = wp.transform_vector(body_q[tip], ang_command[w]) - wp.spatial_bottom(body_qd[tip])
    d = clamp_length(lead[w] + dt * ahead, pull.force_limit / pull.stiffness)
    e = clamp_length(turn[w] + dt * spin, pull.torque_limit / pull.angular_stiffness)
    lead[w] = d
    turn[w] = e
    f = pull.stiffness * d + (pull.damping + dt * pull.stiffness) * ahead
    m = pull.angular_stiffness * e + (pull.angular_damping + dt * pull.angular_stiffness) * spin
    f_drop = dt * (pull.damping + dt * pull.stiffness)
    m_drop = dt * (pull.angular_damping + dt * pull.angular_stiffness)
    if wp.length(f) >= pull.force_limit:
        f = clamp_length(f, pull.force_limit)
        f_drop = 0.0
    if wp.length(m) >= pull.torque_limit:
        m = clamp_length(m, pull.torque_limit)
        m_drop = 0.0
    body_f[tip] = body_f[tip] + wp.spatial_vector(f, m)
    drop = wp.spatial_vector(f_drop, f_drop, f_drop, m_drop, m_drop, m_drop)
    resistance[links - 1, w] = resistance[links - 1, w] + drop
    force[w] = wp.vec4(f[0], f[1], f[2], f_drop)


@wp.kernel
def record_push(drive_force: wp.array2d(dtype=float), weight: float, total: wp.array(dtype=float)):
    """Add ``weight`` times the force of the slide's drive to ``total``. Launch (W,)."""
    w = wp.tid()
    total[w] = total[w] + weight * drive_force[0, w]


@wp.kernel
def record_pull(
    force: wp.array(dtype=wp.vec4), acc_lin: wp.array2d(dtype=wp.vec3), weight: float, total: wp.array(dtype=wp.vec3)
):
    """Add ``weight`` times the pull at the end of the step to ``total``. Launch (W,)."""
    w = wp.tid()
    f = force[w]
    total[w] = total[w] + weight * (wp.vec3(f[0], f[1], f[2]) - f[3] * acc_lin[acc_lin.shape[0] - 1, w])


@wp.kernel
def slide_force(
    joint_q: wp.array(dtype=float),
    joint_qd: wp.array(dtype=float),
    target: wp.array(dtype=float),
    coords: int,
    drive: BaseDrive,
    force: wp.array2d(dtype=float),
):
    """Force of the slide's drive by its spring law, for solvers that do not tell. Launch (W,)."""
    w = wp.tid()
    i = w * coords
    push = drive.slide_stiffness * (target[i] - joint_q[i]) - drive.slide_damping * joint_qd[i]
    force[0, w] = wp.clamp(push, -drive.force_limit, drive.force_limit)
