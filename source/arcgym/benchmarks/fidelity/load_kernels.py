# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Forces that the checks put on links, launched every scope substep, and those of the contacts on the wall."""

import warp as wp

from arcgym.sim.wall.wall_kernels import WallContacts, contact_force_at
from arcgym.utils import warp_setup  # noqa: F401


@wp.kernel
def add_loads(
    body_q: wp.array(dtype=wp.transform),
    point: wp.array(dtype=wp.vec3),
    force: wp.array(dtype=wp.vec3),
    torque: wp.array(dtype=wp.vec3),
    guide: wp.array(dtype=float),
    dt: float,
    body_f: wp.array(dtype=wp.spatial_vector),
    resistance: wp.array2d(dtype=wp.spatial_vector),
):
    """Add a dead force and a sideways spring to the Z axis at a ``point`` of each link, and a torque. Launch (L, W).

    A resistance above that of the spring leaves the equilibrium as it is.
    """
    link, w = wp.tid()
    i = w * resistance.shape[0] + link
    p = wp.transform_point(body_q[i], point[i])
    f = force[i] - guide[i] * wp.vec3(p[0], p[1], 0.0)
    arm = p - wp.transform_get_translation(body_q[i])
    body_f[i] = body_f[i] + wp.spatial_vector(f, wp.cross(arm, f) + torque[i])
    lin = 2.0 * dt * dt * guide[i]
    ang = lin * wp.dot(arm, arm)
    resistance[link, w] = resistance[link, w] + wp.spatial_vector(lin, lin, lin, ang, ang, ang)


@wp.kernel
def contact_on_wall(contacts: WallContacts, x: wp.array2d(dtype=wp.vec3), force: wp.array2d(dtype=wp.vec3)):
    """Compute the contact force that every wall vertex had in the step that has just ended. Launch (V, W).

    Friction is what its spring holds at the end of the step, for the slide that it began with is no longer known.
    """
    i, w = wp.tid()
    records = contacts.records
    total = wp.vec3(0.0)
    entry = records.vertex_head[i, w]
    while entry >= 0:
        slot = entry // 4
        c = contact_force_at(contacts, slot, x, w)
        friction = (records.weight[slot] * contacts.law.friction_stiffness) * records.slide[slot]
        total += records.bary[slot][entry - 4 * slot] * (c.normal_force * c.normal + friction + records.owed[slot])
        entry = records.vertex_next[entry]
    force[i, w] = total
