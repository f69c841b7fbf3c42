# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Forces that the checks put on links. One launch a scope substep."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.kernel
def add_loads(
    body_q: wp.array(dtype=wp.transform),
    point: wp.array(dtype=wp.vec3),
    force: wp.array(dtype=wp.vec3),
    torque: wp.array(dtype=wp.vec3),
    guide: wp.array(dtype=float),
    body_f: wp.array(dtype=wp.spatial_vector),
):
    """Add a dead force and a sideways spring to the Z axis at a ``point`` of each link, and a torque. Launch (W*L,)."""
    i = wp.tid()
    p = wp.transform_point(body_q[i], point[i])
    f = force[i] - guide[i] * wp.vec3(p[0], p[1], 0.0)
    arm = p - wp.transform_get_translation(body_q[i])
    body_f[i] = body_f[i] + wp.spatial_vector(f, wp.cross(arm, f) + torque[i])
