# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Data of the articulated-body algorithm of a serial chain: inertias, loads and joint forces at a step's start.

Linearly implicit Euler: springs, dampers and contacts act with their values at the end of the step, to first order in
the acceleration. All vectors have world axes. Inertias refer to the link's joint (its *anchor*; the center of mass of a
free root) and accelerations are those of the material point there, so that lengths stay short and float32 suffices.

W worlds, L links, D degrees of freedom a world. Scratch has the shape (L, W) or (D, W), world-fastest but where a warp
solves a world, whose rows lie side by side then.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class Chain:
    """Links and joints of one world's chain."""

    links: int  # L
    dofs: int  # D
    coords: int  # D, or D + 1 for a free root
    free: int  # whether the root is free
    parent_frame: wp.array[wp.transform]  # joint in the frame of the link before, shape (L,)
    child_frame: wp.array[wp.transform]  # joint in the link's frame, shape (L,)
    com: wp.array[wp.vec3]  # center of mass in the link's frame [m], shape (L,)
    mass: wp.array[float]  # [kg], shape (L,)
    inertia: wp.array[wp.mat33]  # about the center of mass, link's axes [kg m^2], shape (L,)
    dof_start: wp.array[int]  # first degree of freedom of each link's joint, shape (L + 1,)
    linear: wp.array[int]  # whether a degree of freedom slides, shape (D,)
    axis: wp.array[wp.vec3]  # in the joint's frame, shape (D,)
    stiffness: wp.array[float]  # of the drive [N/m or N m/rad], shape (D,)
    damping: wp.array[float]  # of the drive, shape (D,)
    effort: wp.array[float]  # largest force of the drive [N or N m], shape (D,)
    armature: wp.array[float]  # [kg or kg m^2], shape (D,)
    lower: wp.array[float]  # [m or rad], shape (D,)
    upper: wp.array[float]  # [m or rad], shape (D,)
    stop_stiffness: wp.array[float]  # beyond lower and upper, shape (D,)
    stop_damping: wp.array[float]  # shape (D,)


@wp.struct
class LinkLoads:
    """Forces on the links that resist their acceleration, about the center of mass.

    The force at the end of the step is ``wrench`` less the inertias times the link's acceleration: ``wrench`` holds for
    a link that keeps its velocity v, and a spring K and damper C add dt (C + dt K) to the inertias.
    """

    wrench: wp.array2d[wp.spatial_vector]  # force [N], torque [N m], shape (L, W)
    ll: wp.array2d[wp.mat33]  # force by linear acceleration [kg], shape (L, W)
    la: wp.array2d[wp.mat33]  # force by angular acceleration [kg m], shape (L, W)
    aa: wp.array2d[wp.mat33]  # torque by angular acceleration [kg m^2], shape (L, W)


@wp.struct
class ChainWork:
    """Scratch of a step, and what can be read after it."""

    ll: wp.array2d[wp.mat33]  # inertia of each link and its loads about its anchor, shape (L, W)
    la: wp.array2d[wp.mat33]
    aa: wp.array2d[wp.mat33]
    force: wp.array2d[wp.vec3]  # bias force and torque, shape (L, W)
    torque: wp.array2d[wp.vec3]
    arm: wp.array2d[wp.vec3]  # from the anchor before to the link's own [m], shape (L, W)
    lever: wp.array2d[wp.vec3]  # from the anchor to the center of mass [m], shape (L, W)
    drift_lin: wp.array2d[wp.vec3]  # acceleration of the joint at constant joint velocities, shape (L, W)
    drift_ang: wp.array2d[wp.vec3]
    axis: wp.array2d[wp.vec3]  # shape (D, W)
    drive: wp.array2d[float]  # drive's force if the joint keeps its velocity, shape (D, W)
    drive_inertia: wp.array2d[float]  # its drop by acceleration, shape (D, W)
    stop: wp.array2d[float]  # the same of the stop, shape (D, W)
    stop_inertia: wp.array2d[float]
    gain_lin: wp.array2d[wp.vec3]  # joint acceleration = offset - gain . parent's acceleration, shape (D, W)
    gain_ang: wp.array2d[wp.vec3]
    offset: wp.array2d[float]
    drive_force: wp.array2d[float]  # force of each drive at the end of the step [N or N m], shape (D, W)
    acc_lin: wp.array2d[wp.vec3]  # of each center of mass [m/s^2], shape (L, W)
    acc_ang: wp.array2d[wp.vec3]  # [rad/s^2], shape (L, W)


@wp.struct
class ArticulatedBody:
    """Force [N] and torque [N m] at a point as functions of its linear a and angular acceleration b.

    force = ll a + la b + force, torque = la^T a + aa b + torque.
    """

    ll: wp.mat33
    la: wp.mat33
    aa: wp.mat33
    force: wp.vec3
    torque: wp.vec3


@wp.func
def skew_times(r: wp.vec3, m: wp.mat33) -> wp.mat33:
    """Return the matrix of the cross products of ``r`` with the columns of ``m``."""
    return wp.matrix_from_rows(r[1] * m[2] - r[2] * m[1], r[2] * m[0] - r[0] * m[2], r[0] * m[1] - r[1] * m[0])


@wp.func
def shift_origin(body: ArticulatedBody, r: wp.vec3) -> ArticulatedBody:
    """Return the same body with its reference point moved by ``-r``."""
    out = ArticulatedBody()
    out.ll = body.ll
    out.la = body.la + wp.transpose(skew_times(r, body.ll))
    out.aa = body.aa + skew_times(r, out.la) + wp.transpose(skew_times(r, body.la))
    out.force = body.force
    out.torque = body.torque + wp.cross(r, body.force)
    return out


@wp.func
def anchor(chain: Chain, link: int, pose: wp.transform) -> wp.vec3:
    """Return the point that a link's inertia and acceleration refer to."""
    if link == 0 and chain.free == 1:
        return wp.transform_point(pose, chain.com[0])
    return wp.transform_point(pose, wp.transform_get_translation(chain.child_frame[link]))


@wp.func
def link_inertia(
    chain: Chain, link: int, pose: wp.transform, omega: wp.vec3, lever: wp.vec3, load: ArticulatedBody
) -> ArticulatedBody:
    """Return the articulated body of a link with its loads (about the center of mass) at its anchor."""
    rot = wp.quat_to_matrix(wp.transform_get_rotation(pose))
    inertia = rot * chain.inertia[link] * wp.transpose(rot)
    centripetal = wp.cross(omega, wp.cross(omega, lever))
    out = load
    out.ll += chain.mass[link] * wp.identity(n=3, dtype=float)
    out.aa += inertia
    out.force += out.ll * centripetal
    out.torque += wp.transpose(out.la) * centripetal + wp.cross(omega, inertia * omega)
    return shift_origin(out, lever)


@wp.func
def load_on_link(loads: LinkLoads, link: int, w: int) -> ArticulatedBody:
    """Return the loads on one link as an articulated body."""
    out = ArticulatedBody()
    out.ll = loads.ll[link, w]
    out.la = loads.la[link, w]
    out.aa = loads.aa[link, w]
    out.force = -wp.spatial_top(loads.wrench[link, w])
    out.torque = -wp.spatial_bottom(loads.wrench[link, w])
    return out


@wp.func
def prepare_axes(
    chain: Chain,
    body_q: wp.array[wp.transform],
    body_qd: wp.array[wp.spatial_vector],
    joint_q: wp.array[float],
    joint_qd: wp.array[float],
    here: wp.vec3,
    link: int,
    w: int,
    work: ChainWork,
):
    """Write axes and velocity products of a link's joint; every axis is turned by those before it."""
    row = w * chain.links + link
    parent = chain.parent_frame[link]
    arm = wp.vec3(0.0)
    spin = wp.vec3(0.0)
    if link > 0:
        parent = body_q[row - 1] * parent
        arm = here - anchor(chain, link - 1, body_q[row - 1])
        spin = wp.spatial_bottom(body_qd[row - 1])
    rot = wp.transform_get_rotation(parent)
    drift_lin = wp.cross(spin, wp.cross(spin, arm))
    drift_ang = wp.vec3(0.0)
    first = chain.dof_start[link]
    if link > 0 or chain.free == 0:
        for d in range(first, chain.dof_start[link + 1]):
            axis = wp.quat_rotate(rot, chain.axis[d])
            work.axis[d, w] = axis
            rate = axis * joint_qd[w * chain.dofs + d]
            if chain.linear[d] == 1:
                drift_lin += 2.0 * wp.cross(spin, rate)
            else:
                drift_ang += wp.cross(spin, rate)
                spin += rate
                angle = joint_q[w * chain.coords + d + chain.coords - chain.dofs]
                rot = rot * wp.quat_from_axis_angle(chain.axis[d], angle)
    work.arm[link, w] = arm
    work.drift_lin[link, w] = drift_lin
    work.drift_ang[link, w] = drift_ang


@wp.kernel
def prepare_links(
    chain: Chain,
    body_q: wp.array[wp.transform],
    body_qd: wp.array[wp.spatial_vector],
    body_f: wp.array[wp.spatial_vector],
    joint_q: wp.array[float],
    joint_qd: wp.array[float],
    resistance: wp.array2d[wp.spatial_vector],
    loads: LinkLoads,
    work: ChainWork,
):
    """Compute inertia, bias force, joint axes and velocity products of every link. Launch (L, W).

    Args:
        chain: Links and joints of one world.
        body_q: Link poses, shape (W*L,).
        body_qd: Link velocities [m/s, rad/s], shape (W*L,).
        body_f: Force [N] and torque [N m] on the centers of mass, shape (W*L,).
        joint_q: Joint coordinates [m or rad], shape (W*J,), J = D, or D + 1 for a free root.
        joint_qd: Joint velocities [m/s or rad/s], shape (W*D,).
        resistance: Diagonal of the drop of ``body_f`` by acceleration [kg, kg m^2], shape (L, W).
        loads: Further loads of the links.
        work: Scratch; all that concerns links, and ``axis``, is written.
    """
    link, w = wp.tid()
    row = w * chain.links + link
    pose = body_q[row]
    omega = wp.spatial_bottom(body_qd[row])
    here = anchor(chain, link, pose)
    lever = wp.transform_point(pose, chain.com[link]) - here
    load = load_on_link(loads, link, w)
    load.ll += wp.diag(wp.spatial_top(resistance[link, w]))
    load.aa += wp.diag(wp.spatial_bottom(resistance[link, w]))
    load.force -= wp.spatial_top(body_f[row])
    load.torque -= wp.spatial_bottom(body_f[row])
    body = link_inertia(chain, link, pose, omega, lever, load)
    work.ll[link, w] = body.ll
    work.la[link, w] = body.la
    work.aa[link, w] = body.aa
    work.force[link, w] = body.force
    work.torque[link, w] = body.torque
    work.lever[link, w] = lever
    prepare_axes(chain, body_q, body_qd, joint_q, joint_qd, here, link, w, work)


@wp.kernel
def prepare_joints(
    chain: Chain,
    joint_q: wp.array[float],
    joint_qd: wp.array[float],
    target: wp.array[float],
    joint_f: wp.array[float],
    dt: float,
    work: ChainWork,
):
    """Compute the forces of drives and stops if the joints keep their velocities. Launch (W, D).

    A spring K that acts with its value at the end of the step loses energy as if it had a damper dt K. That much is
    taken off the drive's own damper, and the two together lose what the damper should.

    Args:
        chain: Links and joints of one world.
        joint_q: Joint coordinates [m or rad], shape (W*J,), J = D, or D + 1 for a free root.
        joint_qd: Joint velocities [m/s or rad/s], shape (W*D,).
        target: Targets of the drives [m or rad], shape (W*J,).
        joint_f: Further joint forces [N or N m], shape (W*D,).
        dt: Substep [s].
        work: Scratch; ``drive``, ``drive_inertia``, ``stop`` and ``stop_inertia`` are written.
    """
    w, d = wp.tid()
    if chain.free == 1 and d < 6:
        return
    i = w * chain.coords + d + chain.coords - chain.dofs
    v = joint_qd[w * chain.dofs + d]
    end = joint_q[i] + dt * v
    damping = wp.max(chain.damping[d] - dt * chain.stiffness[d], 0.0)
    work.drive[d, w] = chain.stiffness[d] * (target[i] - end) - damping * v
    work.drive_inertia[d, w] = dt * (damping + dt * chain.stiffness[d])
    stop = joint_f[w * chain.dofs + d]
    stop_inertia = chain.armature[d]
    beyond = wp.min(joint_q[i] - chain.lower[d], 0.0) + wp.max(joint_q[i] - chain.upper[d], 0.0)
    if beyond != 0.0:
        stop -= chain.stop_stiffness[d] * (beyond + dt * v) + chain.stop_damping[d] * v
        stop_inertia += dt * (chain.stop_damping[d] + dt * chain.stop_stiffness[d])
    work.stop[d, w] = stop
    work.stop_inertia[d, w] = stop_inertia


@wp.kernel
def record_loads(
    loads: LinkLoads,
    acc_lin: wp.array2d[wp.vec3],
    acc_ang: wp.array2d[wp.vec3],
    weight: float,
    mean_load: wp.array[wp.vec3],
):
    """Add up the force of each link's loads at the end of the step. Launch (L, W).

    Args:
        loads: Loads of the links.
        acc_lin: Accelerations of the centers of mass [m/s^2], shape (L, W).
        acc_ang: Angular accelerations [rad/s^2], shape (L, W).
        weight: Share of the step in the mean.
        mean_load: Mean force on each link [N], shape (W*L,); added to.
    """
    link, w = wp.tid()
    row = w * loads.wrench.shape[0] + link
    given = loads.ll[link, w] * acc_lin[link, w] + loads.la[link, w] * acc_ang[link, w]
    mean_load[row] = mean_load[row] + weight * (wp.spatial_top(loads.wrench[link, w]) - given)
