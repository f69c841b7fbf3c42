# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Articulated-body algorithm of a serial chain (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 7).

One thread a world walks from the tip to the base, gathering what the chain beyond each joint resists, and back, giving
each joint its acceleration. W worlds, L links, D degrees of freedom a world.
"""

import warp as wp

from arcgym.sim.scope.scope_kernels import ArticulatedBody, Chain, ChainWork, shift_origin
from arcgym.utils import warp_setup  # noqa: F401


@wp.func
def eliminate_joint(chain: Chain, work: ChainWork, d: int, w: int, body: ArticulatedBody) -> ArticulatedBody:
    """Eliminate degree of freedom ``d``; stores the gains and offset from which its acceleration is recovered."""
    axis = work.axis[d, w]
    u_lin = body.la * axis
    u_ang = body.aa * axis
    pivot = wp.dot(axis, u_ang)
    rest = work.stop[d, w] - wp.dot(axis, body.torque)
    if chain.linear[d] == 1:
        u_lin = body.ll * axis
        u_ang = axis * body.la
        pivot = wp.dot(axis, u_lin)
        rest = work.stop[d, w] - wp.dot(axis, body.force)
    pivot += work.stop_inertia[d, w]
    drive = work.drive[d, w]
    inertia = work.drive_inertia[d, w]
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
    for step in range(chain.links):
        link = chain.links - 1 - step
        body = ArticulatedBody()
        body.ll = carried.ll + work.ll[link, w]
        body.la = carried.la + work.la[link, w]
        body.aa = carried.aa + work.aa[link, w]
        body.force = carried.force + work.force[link, w]
        body.torque = carried.torque + work.torque[link, w]
        if link > 0 or chain.free == 0:
            first = chain.dof_start[link]
            count = chain.dof_start[link + 1] - first
            for k in range(count):
                body = eliminate_joint(chain, work, first + count - 1 - k, w, body)
            drift_lin = work.drift_lin[link, w]
            drift_ang = work.drift_ang[link, w]
            body.force += body.ll * drift_lin + body.la * drift_ang
            body.torque += drift_lin * body.la + body.aa * drift_ang
            carried = shift_origin(body, work.arm[link, w])
        else:
            carried = body
    return carried


@wp.struct
class LinkMotion:
    """Pose of a link, velocity of its centre of mass and its spin."""

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


@wp.func
def next_motion(
    chain: Chain,
    link: int,
    w: int,
    before: LinkMotion,
    joint_q: wp.array[float],
    joint_qd: wp.array[float],
) -> LinkMotion:
    """Return the motion of a link from that of the one before it and the joint between them."""
    out = LinkMotion()
    joint = before.pose * chain.parent_frame[link]
    shift = wp.vec3(0.0)
    rot = wp.quat_identity()
    rate = wp.vec3(0.0)
    spin = wp.vec3(0.0)
    for d in range(chain.dof_start[link], chain.dof_start[link + 1]):
        q = joint_q[w * chain.coords + d + chain.coords - chain.dofs]
        v = joint_qd[w * chain.dofs + d]
        axis = chain.axis[d]
        if chain.linear[d] == 1:
            shift += q * axis
            rate += v * axis
        else:
            spin += v * wp.quat_rotate(rot, axis)
            rot = rot * wp.quat_from_axis_angle(axis, q)
    here = joint * wp.transform(shift, rot)
    out.pose = here * wp.transform_inverse(chain.child_frame[link])
    out.ang = before.ang + wp.transform_vector(joint, spin)
    place = wp.transform_get_translation(here)
    com = wp.transform_point(out.pose, chain.com[link])
    out.lin = before.lin + wp.transform_vector(joint, rate) + wp.cross(out.ang, com - place)
    if link > 0:
        out.lin += wp.cross(before.ang, place - wp.transform_point(before.pose, chain.com[link - 1]))
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
    for link in range(chain.links):
        row = w * chain.links + link
        omega = wp.spatial_bottom(body_qd[row])
        if link == 0 and chain.free == 1:
            inverse = wp.inverse(whole.ll)
            coupled = inverse * whole.la
            schur = whole.aa - wp.transpose(whole.la) * coupled
            ang = wp.inverse(schur) * (whole.force * coupled - whole.torque)
            lin = -(inverse * whole.force) - coupled * ang
            now = free_motion(chain, w, lin, ang, dt, body_q, joint_q, joint_qd)
        else:
            lin += wp.cross(ang, work.arm[link, w]) + work.drift_lin[link, w]
            ang += work.drift_ang[link, w]
            for d in range(chain.dof_start[link], chain.dof_start[link + 1]):
                a = work.offset[d, w] - wp.dot(work.gain_lin[d, w], lin) - wp.dot(work.gain_ang[d, w], ang)
                if chain.linear[d] == 1:
                    lin += a * work.axis[d, w]
                else:
                    ang += a * work.axis[d, w]
                work.drive_force[d, w] = work.drive[d, w] - work.drive_inertia[d, w] * a
                v = joint_qd[w * chain.dofs + d] + dt * a
                i = w * chain.coords + d + chain.coords - chain.dofs
                joint_qd[w * chain.dofs + d] = v
                joint_q[i] = joint_q[i] + dt * v
            now = next_motion(chain, link, w, now, joint_q, joint_qd)
        lever = work.lever[link, w]
        work.acc_lin[link, w] = lin + wp.cross(ang, lever) + wp.cross(omega, wp.cross(omega, lever))
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
            now = next_motion(chain, link, w, now, joint_q, joint_qd)
        body_q[w * chain.links + link] = now.pose
        body_qd[w * chain.links + link] = wp.spatial_vector(now.lin, now.ang)
