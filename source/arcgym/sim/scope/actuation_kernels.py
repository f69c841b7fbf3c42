# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Weight of the links and the introducer. Launched every scope substep, before the actuators.

Forces hold for links that keep their velocity; ``resistance`` is the diagonal of their drop by acceleration (linear
[kg], angular [kg m^2]), with which a solver makes springs and dampers implicit.

W worlds, L links; the root's slide is joint coordinate 0 of a shaft.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401

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
    rest: wp.array[float]  # height of each link where the slide is at zero and the shaft straight [m], shape (L,)


@wp.kernel
def load_links(
    body_q: wp.array[wp.transform],
    body_qd: wp.array[wp.spatial_vector],
    body_mass: wp.array[float],
    gravity: wp.vec3,
    guide: Introducer,
    joint_q: wp.array[float],
    coords: int,
    ring: wp.array2d[int],
    dt: float,
    body_f: wp.array[wp.spatial_vector],
    resistance: wp.array2d[wp.spatial_vector],
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
