# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Articulated-body algorithm of a serial chain (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 7).

One thread a world walks from the tip to the base, gathering what the chain beyond each joint resists, and back, giving
each joint its acceleration. What the next link and joint need is read while this one is worked on: on a GPU the
walk would otherwise wait for memory a dozen times a link. W worlds, L links, D degrees of freedom a world.
"""

import warp as wp

from arcgym.sim.scope.scope_kernels import ArticulatedBody, Chain, ChainWork, shift_origin
from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class LinkRow:
    """What the walk inwards needs of a link."""

    own: ArticulatedBody
    arm: wp.vec3
    drift_lin: wp.vec3
    drift_ang: wp.vec3


@wp.struct
class JointRow:
    """What the walk inwards needs of a degree of freedom."""

    axis: wp.vec3
    stop: float
    stop_inertia: float
    drive: float
    drive_inertia: float


@wp.func
def read_link(work: ChainWork, link: int, w: int) -> LinkRow:
    """Read a link's row; that of the first where ``link`` is before it."""
    k = wp.max(link, 0)
    out = LinkRow()
    out.own.ll = work.ll[k, w]
    out.own.la = work.la[k, w]
    out.own.aa = work.aa[k, w]
    out.own.force = work.force[k, w]
    out.own.torque = work.torque[k, w]
    out.arm = work.arm[k, w]
    out.drift_lin = work.drift_lin[k, w]
    out.drift_ang = work.drift_ang[k, w]
    return out


@wp.func
def read_joint(work: ChainWork, d: int, w: int) -> JointRow:
    """Read the row of a degree of freedom; that of the first where ``d`` is before it."""
    k = wp.max(d, 0)
    out = JointRow()
    out.axis = work.axis[k, w]
    out.stop = work.stop[k, w]
    out.stop_inertia = work.stop_inertia[k, w]
    out.drive = work.drive[k, w]
    out.drive_inertia = work.drive_inertia[k, w]
    return out


@wp.func
def eliminate_joint(
    chain: Chain, work: ChainWork, d: int, w: int, joint: JointRow, body: ArticulatedBody
) -> ArticulatedBody:
    """Eliminate degree of freedom ``d``; stores the gains and offset from which its acceleration is recovered."""
    axis = joint.axis
    u_lin = body.la * axis
    u_ang = body.aa * axis
    pivot = wp.dot(axis, u_ang)
    rest = joint.stop - wp.dot(axis, body.torque)
    if chain.linear[d] == 1:
        u_lin = body.ll * axis
        u_ang = axis * body.la
        pivot = wp.dot(axis, u_lin)
        rest = joint.stop - wp.dot(axis, body.force)
    pivot += joint.stop_inertia
    drive = joint.drive
    inertia = joint.drive_inertia
    at_end = drive - inertia * (rest + drive) / (pivot + inertia)
    if wp.abs(at_end) > chain.effort[d]:
        drive = wp.sign(at_end) * chain.effort[d]
        inertia = 0.0
        work.drive[d, w] = drive
        work.drive_inertia[d, w] = inertia
    scale = 1.0 / (pivot + inertia)
    offset = scale * (rest + drive)
    g_lin = scale * u_lin
    g_ang = scale * u_ang
    work.gain_lin[d, w] = g_lin
    work.gain_ang[d, w] = g_ang
    work.offset[d, w] = offset
    out = ArticulatedBody()
    out.ll = body.ll - wp.outer(u_lin, g_lin)
    out.la = body.la - wp.outer(u_lin, g_ang)
    out.aa = body.aa - wp.outer(u_ang, g_ang)
    out.force = body.force + offset * u_lin
    out.torque = body.torque + offset * u_ang
    return out


@wp.func
def inward_pass(chain: Chain, work: ChainWork, w: int) -> ArticulatedBody:
    """Walk from the tip to the base; return the articulated body of the whole chain at the root's anchor."""
    carried = ArticulatedBody()
    next_link = read_link(work, chain.links - 1, w)
    next_joint = read_joint(work, chain.dofs - 1, w)
    for step in range(chain.links):
        link = chain.links - 1 - step
        row = next_link
        next_link = read_link(work, link - 1, w)
        body = ArticulatedBody()
        body.ll = carried.ll + row.own.ll
        body.la = carried.la + row.own.la
        body.aa = carried.aa + row.own.aa
        body.force = carried.force + row.own.force
        body.torque = carried.torque + row.own.torque
        if link > 0 or chain.free == 0:
            first = chain.dof_start[link]
            count = chain.dof_start[link + 1] - first
            for k in range(count):
                d = first + count - 1 - k
                joint = next_joint
                next_joint = read_joint(work, d - 1, w)
                body = eliminate_joint(chain, work, d, w, joint, body)
            body.force += body.ll * row.drift_lin + body.la * row.drift_ang
            body.torque += row.drift_lin * body.la + body.aa * row.drift_ang
            carried = shift_origin(body, row.arm)
        else:
            carried = body
    return carried


@wp.struct
class LinkMotion:
    """Pose of a link, velocity of its center of mass and its spin."""

    pose: wp.transform
    lin: wp.vec3
    ang: wp.vec3


@wp.func
def free_motion(
    chain: Chain,
    w: int,
    lin: wp.vec3,
    ang: wp.vec3,
    dt: float,
    body_q: wp.array[wp.transform],
    joint_q: wp.array[float],
    joint_qd: wp.array[float],
) -> LinkMotion:
    """Integrate a free root in place with the accelerations ``lin`` and ``ang``."""
    out = LinkMotion()
    i = w * chain.dofs
    out.lin = wp.vec3(joint_qd[i], joint_qd[i + 1], joint_qd[i + 2]) + dt * lin
    out.ang = wp.vec3(joint_qd[i + 3], joint_qd[i + 4], joint_qd[i + 5]) + dt * ang
    pose = body_q[w * chain.links]
    turn = wp.length(out.ang) * dt
    rot = wp.transform_get_rotation(pose)
    if turn > 0.0:
        rot = wp.normalize(wp.quat_from_axis_angle(wp.normalize(out.ang), turn) * rot)
    com = wp.transform_point(pose, chain.com[0]) + dt * out.lin
    out.pose = wp.transform(com - wp.quat_rotate(rot, chain.com[0]), rot)
    for k in range(3):
        joint_qd[i + k] = out.lin[k]
        joint_qd[i + 3 + k] = out.ang[k]
        joint_q[w * chain.coords + k] = out.pose[k]
    for k in range(4):
        joint_q[w * chain.coords + 3 + k] = out.pose[3 + k]
    return out


@wp.struct
class JointMotion:
    """Displacement of a joint and its rate, in the joint's frame."""

    shift: wp.vec3
    rot: wp.quat
    rate: wp.vec3
    spin: wp.vec3


@wp.func
def move_joint(chain: Chain, d: int, q: float, v: float, before: JointMotion) -> JointMotion:
    """Add degree of freedom ``d`` at ``q`` with velocity ``v`` to those of its joint before it."""
    out = before
    axis = chain.axis[d]
    if chain.linear[d] == 1:
        out.shift = before.shift + q * axis
        out.rate = before.rate + v * axis
    else:
        out.spin = before.spin + v * wp.quat_rotate(before.rot, axis)
        out.rot = before.rot * wp.quat_from_axis_angle(axis, q)
    return out


@wp.func
def next_motion(chain: Chain, link: int, before: LinkMotion, moved: JointMotion) -> LinkMotion:
    """Return the motion of a link from that of the one before it and of the joint between them."""
    out = LinkMotion()
    joint = before.pose * chain.parent_frame[link]
    here = joint * wp.transform(moved.shift, moved.rot)
    out.pose = here * wp.transform_inverse(chain.child_frame[link])
    out.ang = before.ang + wp.transform_vector(joint, moved.spin)
    place = wp.transform_get_translation(here)
    com = wp.transform_point(out.pose, chain.com[link])
    out.lin = before.lin + wp.transform_vector(joint, moved.rate) + wp.cross(out.ang, com - place)
    if link > 0:
        out.lin += wp.cross(before.ang, place - wp.transform_point(before.pose, chain.com[link - 1]))
    return out


@wp.struct
class GainRow:
    """What the walk outwards needs of a degree of freedom."""

    offset: float
    gain_lin: wp.vec3
    gain_ang: wp.vec3
    axis: wp.vec3
    drive: float
    drive_inertia: float
    q: float
    v: float


@wp.func
def read_gain(
    chain: Chain, work: ChainWork, d: int, w: int, joint_q: wp.array[float], joint_qd: wp.array[float]
) -> GainRow:
    """Read the row of a degree of freedom; that of the last where ``d`` is beyond it."""
    k = wp.min(d, chain.dofs - 1)
    out = GainRow()
    out.offset = work.offset[k, w]
    out.gain_lin = work.gain_lin[k, w]
    out.gain_ang = work.gain_ang[k, w]
    out.axis = work.axis[k, w]
    out.drive = work.drive[k, w]
    out.drive_inertia = work.drive_inertia[k, w]
    out.q = joint_q[w * chain.coords + k + chain.coords - chain.dofs]
    out.v = joint_qd[w * chain.dofs + k]
    return out


@wp.struct
class DriftRow:
    """What the walk outwards needs of a link."""

    arm: wp.vec3
    drift_lin: wp.vec3
    drift_ang: wp.vec3
    lever: wp.vec3
    omega: wp.vec3


@wp.func
def read_drift(chain: Chain, work: ChainWork, link: int, w: int, body_qd: wp.array[wp.spatial_vector]) -> DriftRow:
    """Read a link's row; that of the last where ``link`` is beyond it."""
    k = wp.min(link, chain.links - 1)
    out = DriftRow()
    out.arm = work.arm[k, w]
    out.drift_lin = work.drift_lin[k, w]
    out.drift_ang = work.drift_ang[k, w]
    out.lever = work.lever[k, w]
    out.omega = wp.spatial_bottom(body_qd[w * chain.links + k])
    return out


@wp.kernel
def solve_chain(
    chain: Chain,
    body_q: wp.array[wp.transform],
    body_qd: wp.array[wp.spatial_vector],
    dt: float,
    work: ChainWork,
    joint_q: wp.array[float],
    joint_qd: wp.array[float],
    body_q_out: wp.array[wp.transform],
    body_qd_out: wp.array[wp.spatial_vector],
):
    """Solve for the accelerations of all joints, and integrate joints and links. Launch (W,).

    Args:
        chain: Links and joints of one world.
        body_q: Link poses at the start, shape (W*L,).
        body_qd: Link velocities at the start [m/s, rad/s], shape (W*L,).
        dt: Substep [s].
        work: Prepared links and joints; gains, accelerations and drive forces are written.
        joint_q: Joint coordinates [m or rad], shape (W*J,); advanced in place.
        joint_qd: Joint velocities [m/s or rad/s], shape (W*D,); advanced in place.
        body_q_out: Link poses at the end, shape (W*L,).
        body_qd_out: Link velocities at the end [m/s, rad/s], shape (W*L,).
    """
    w = wp.tid()
    whole = inward_pass(chain, work, w)
    lin = wp.vec3(0.0)
    ang = wp.vec3(0.0)
    now = LinkMotion()
    now.pose = wp.transform_identity()
    next_link = read_drift(chain, work, 0, w, body_qd)
    next_joint = read_gain(chain, work, 6 * chain.free, w, joint_q, joint_qd)
    for link in range(chain.links):
        row = w * chain.links + link
        here = next_link
        next_link = read_drift(chain, work, link + 1, w, body_qd)
        if link == 0 and chain.free == 1:
            inverse = wp.inverse(whole.ll)
            coupled = inverse * whole.la
            schur = whole.aa - wp.transpose(whole.la) * coupled
            ang = wp.inverse(schur) * (whole.force * coupled - whole.torque)
            lin = -(inverse * whole.force) - coupled * ang
            now = free_motion(chain, w, lin, ang, dt, body_q, joint_q, joint_qd)
        else:
            lin += wp.cross(ang, here.arm) + here.drift_lin
            ang += here.drift_ang
            moved = JointMotion()
            moved.rot = wp.quat_identity()
            for d in range(chain.dof_start[link], chain.dof_start[link + 1]):
                joint = next_joint
                next_joint = read_gain(chain, work, d + 1, w, joint_q, joint_qd)
                a = joint.offset - wp.dot(joint.gain_lin, lin) - wp.dot(joint.gain_ang, ang)
                if chain.linear[d] == 1:
                    lin += a * joint.axis
                else:
                    ang += a * joint.axis
                work.drive_force[d, w] = joint.drive - joint.drive_inertia * a
                v = joint.v + dt * a
                q = joint.q + dt * v
                joint_qd[w * chain.dofs + d] = v
                joint_q[w * chain.coords + d + chain.coords - chain.dofs] = q
                moved = move_joint(chain, d, q, v, moved)
            now = next_motion(chain, link, now, moved)
        work.acc_lin[link, w] = lin + wp.cross(ang, here.lever) + wp.cross(here.omega, wp.cross(here.omega, here.lever))
        work.acc_ang[link, w] = ang
        body_q_out[row] = now.pose
        body_qd_out[row] = wp.spatial_vector(now.lin, now.ang)


@wp.kernel
def chain_kinematics(
    chain: Chain,
    joint_q: wp.array[float],
    joint_qd: wp.array[float],
    world_mask: wp.array[wp.bool],
    body_q: wp.array[wp.transform],
    body_qd: wp.array[wp.spatial_vector],
):
    """Compute poses and velocities of all links as :func:`solve_chain` does. Launch (W,).

    Args:
        chain: Links and joints of one world.
        joint_q: Joint coordinates [m or rad], shape (W*J,).
        joint_qd: Joint velocities [m/s or rad/s], shape (W*D,).
        world_mask: Worlds to compute, shape (W,).
        body_q: Link poses, shape (W*L,); written.
        body_qd: Link velocities [m/s, rad/s], shape (W*L,); written.
    """
    w = wp.tid()
    if not world_mask[w]:
        return
    now = LinkMotion()
    now.pose = wp.transform_identity()
    for link in range(chain.links):
        if link == 0 and chain.free == 1:
            i = w * chain.coords
            k = w * chain.dofs
            rot = wp.quat(joint_q[i + 3], joint_q[i + 4], joint_q[i + 5], joint_q[i + 6])
            now.pose = wp.transform(wp.vec3(joint_q[i], joint_q[i + 1], joint_q[i + 2]), rot)
            now.lin = wp.vec3(joint_qd[k], joint_qd[k + 1], joint_qd[k + 2])
            now.ang = wp.vec3(joint_qd[k + 3], joint_qd[k + 4], joint_qd[k + 5])
        else:
            moved = JointMotion()
            moved.rot = wp.quat_identity()
            for d in range(chain.dof_start[link], chain.dof_start[link + 1]):
                q = joint_q[w * chain.coords + d + chain.coords - chain.dofs]
                moved = move_joint(chain, d, q, joint_qd[w * chain.dofs + d], moved)
            now = next_motion(chain, link, now, moved)
        body_q[w * chain.links + link] = now.pose
        body_qd[w * chain.links + link] = wp.spatial_vector(now.lin, now.ang)
