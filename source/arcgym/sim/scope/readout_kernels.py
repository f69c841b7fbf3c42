# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Quantities derived from the state once a control step: forces over lengths of scope, tip, camera, place along the
colon, broken worlds.

W worlds, L links, K windows, R rings.
"""

import warp as wp

from arcgym.sim.geometry_kernels import segment_parameter
from arcgym.utils import warp_setup  # noqa: F401


@wp.kernel
def collect_forces(step_force: wp.array[wp.vec3], total: wp.array[wp.vec3], peak: wp.array[float]):
    """Add one physics step's mean force to the control step's sum and peak, and clear it. Launch (W*L,).

    Args:
        step_force: Mean of the physics step [N], shape (W*L,); set to zero.
        total: Sum over the control step [N], shape (W*L,); added to.
        peak: Largest magnitude [N], shape (W*L,); raised.
    """
    i = wp.tid()
    f = step_force[i]
    total[i] = total[i] + f
    peak[i] = wp.max(peak[i], wp.length(f))
    step_force[i] = wp.vec3(0.0)


@wp.kernel
def measure_forces(force: wp.array[wp.vec3], magnitude: wp.array[float]):
    """Write the ``magnitude`` of each link's ``force`` [N], shape (W*L,) each. Launch (W*L,)."""
    i = wp.tid()
    magnitude[i] = wp.length(force[i])


@wp.struct
class WindowShares:
    """Shares of the links' forces in each part of the scope, the tip and K windows, of one world."""

    first: wp.array[int]
    """Place of each part's first link in the lists below, shape (K + 2,)."""
    link: wp.array[int]
    """Links of the parts, one part after the other."""
    share: wp.array[float]
    """Share of each of these links' forces."""


@wp.func
def part_force(shares: WindowShares, force: wp.array[wp.vec3], row: int, part: int) -> wp.vec3:
    """Return the force on a part of a scope whose base link is number ``row`` of ``force`` [N], shape (W*L,)."""
    total = wp.vec3(0.0)
    for i in range(shares.first[part], shares.first[part + 1]):
        total += shares.share[i] * force[row + shares.link[i]]
    return total


@wp.kernel
def raise_window_peaks(step_force: wp.array[wp.vec3], links: int, shares: WindowShares, peak: wp.array2d[float]):
    """Raise the peaks of tip and windows by one physics step's mean force. Launch (W, K + 1).

    Args:
        step_force: Mean force on each link in the physics step [N], shape (W*L,).
        links: Links a world, L.
        shares: Parts of the scope.
        peak: Largest magnitude so far [N], shape (W, K + 1); raised.
    """
    w, part = wp.tid()
    peak[w, part] = wp.max(peak[w, part], wp.length(part_force(shares, step_force, w * links, part)))


@wp.kernel
def measure_windows(
    force: wp.array[wp.vec3],
    links: int,
    shares: WindowShares,
    window_force: wp.array2d[wp.vec3],
    magnitude: wp.array2d[float],
):
    """Sum up the forces of tip and windows. Launch (W, K + 1).

    Args:
        force: Force on each link [N], shape (W*L,).
        links: Links a world, L.
        shares: Parts of the scope.
        window_force: Force on each part [N], shape (W, K + 1); written.
        magnitude: Its magnitude [N], shape (W, K + 1); written.
    """
    w, part = wp.tid()
    total = part_force(shares, force, w * links, part)
    window_force[w, part] = total
    magnitude[w, part] = wp.length(total)


@wp.kernel
def read_tip(
    body_q: wp.array[wp.transform],
    body_qd: wp.array[wp.spatial_vector],
    links: int,
    tip_offset: wp.vec3,
    camera_offset: wp.transform,
    tip_pose: wp.array[wp.transform],
    tip_velocity: wp.array[wp.spatial_vector],
    camera_pose: wp.array[wp.transform],
):
    """Compute pose and velocity of the front of the last link, and the camera's pose. Launch (W,).

    Args:
        body_q: Link poses, shape (W*L,).
        body_qd: Link velocities [m/s, rad/s], shape (W*L,).
        links: Links a world, L.
        tip_offset: Front of the last link in its frame [m].
        camera_offset: Camera in the last link's frame.
        tip_pose: Front of the tip, shape (W,); written.
        tip_velocity: Its velocity [m/s, rad/s], shape (W,); written.
        camera_pose: Camera, shape (W,); written.
    """
    w = wp.tid()
    link = (w + 1) * links - 1
    pose = body_q[link]
    omega = wp.spatial_bottom(body_qd[link])
    tip = wp.transform_point(pose, tip_offset)
    tip_pose[w] = wp.transform(tip, wp.transform_get_rotation(pose))
    arm = tip - wp.transform_get_translation(pose)
    tip_velocity[w] = wp.spatial_vector(wp.spatial_top(body_qd[link]) + wp.cross(omega, arm), omega)
    camera_pose[w] = wp.transform_multiply(pose, camera_offset)


@wp.kernel
def locate_tip(
    tip_pose: wp.array[wp.transform],
    centers: wp.array2d[wp.vec3],
    patient: wp.array[int],
    ring_arc: wp.array2d[float],
    link_ring: wp.array2d[int],
    span: int,
    arc: wp.array[float],
    distance: wp.array[float],
    direction: wp.array[wp.vec3],
):
    """Find the closest point of the deformed centerline to the tip, near the last link's ring. Launch (W,).

    Before the first ring and beyond the last the centerline goes on along its end segments.

    Args:
        tip_pose: Front of the tip, shape (W,).
        centers: Ring centers [m], shape (W, R).
        patient: Patient of each world, shape (W,).
        ring_arc: Arc length of the rings at rest [m], shape (R, P).
        link_ring: Ring of each link or -1, shape (W, L).
        span: Rings searched on either side.
        arc: Arc length of the point at rest [m], shape (W,); written.
        distance: Distance of the tip from it [m], shape (W,); written.
        direction: Direction of the centerline there, shape (W,); written.
    """
    w = wp.tid()
    rings = centers.shape[1]
    p = wp.transform_get_translation(tip_pose[w])
    near = link_ring[w, link_ring.shape[1] - 1]
    lo = int(0)
    hi = rings - 1
    if near >= 0:
        lo = wp.max(0, near - span)
        hi = wp.min(rings - 1, near + span)
    best = float(1.0e9)
    for r in range(lo, hi):
        a = centers[w, r]
        b = centers[w, r + 1]
        t = segment_parameter(p, a, b)
        d = wp.length(p - a - t * (b - a))
        if d < best:
            best = d
            if (r == 0 and t <= 0.0) or (r == rings - 2 and t >= 1.0):
                t = wp.dot(p - a, b - a) / wp.max(wp.length_sq(b - a), 1.0e-12)
            start = ring_arc[r, patient[w]]
            arc[w] = start + t * (ring_arc[r + 1, patient[w]] - start)
            distance[w] = wp.length(p - a - t * (b - a))
            direction[w] = wp.normalize(b - a)


@wp.func
def broken(p: wp.vec3) -> bool:
    """Return whether a position is not finite or farther than 10 m away."""
    return not (wp.abs(p[0]) < 10.0 and wp.abs(p[1]) < 10.0 and wp.abs(p[2]) < 10.0)


@wp.kernel
def flag_broken_points(x: wp.array2d[wp.vec3], flag: wp.array[int]):
    """Set ``flag``, shape (W,), of worlds with a broken position ``x`` [m], shape (V, W). Launch (V, W)."""
    i, w = wp.tid()
    if broken(x[i, w]):
        flag[w] = 1


@wp.kernel
def flag_broken_bodies(body_q: wp.array[wp.transform], per_world: int, flag: wp.array[int]):
    """Set ``flag``, shape (W,), of worlds with a broken pose ``body_q``, shape (W*L,). Launch (W*L,)."""
    i = wp.tid()
    if broken(wp.transform_get_translation(body_q[i])):
        flag[i // per_world] = 1
