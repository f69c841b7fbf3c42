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

    stiffness: float  # by length of shaft [N/m^2]
    damping: float  # by length of shaft [N s/m^2]
    length: wp.array[float]  # of each link [m], shape (L,)
    height: float  # up to which the shaft is pulled onto the Z axis [m]
    min_height: float  # down to which links that belong inside may sink [m]
    rest: wp.array[float]  # height of each link where the slide is at zero and the shaft straight [m], shape (L,)


@wp.func
def length_below(height: float, pose: wp.transform, length: float) -> float:
    """Return how much of a link, its axis along Z, is lower than a height [m]."""
    middle = wp.transform_get_translation(pose)[2]
    rise = wp.abs(wp.transform_vector(pose, wp.vec3(0.0, 0.0, length))[2])
    return length * wp.clamp(0.5 + (height - middle) / wp.max(rise, 0.1 * length), 0.0, 1.0)


@wp.kernel
def load_links(
    body_q: wp.array[wp.transform],
    body_qd: wp.array[wp.spatial_vector],
    body_mass: wp.array[float],
    gravity: wp.array[wp.vec3],
    mass_scaling: float,
    guide: Introducer,
    joint_q: wp.array[float],
    coords: int,
    ring: wp.array2d[int],
    dt: float,
    body_f: wp.array[wp.spatial_vector],
    resistance: wp.array2d[wp.spatial_vector],
):
    """Weight of every link, and the springs of the introducer near the colon's first rings. Launch (W, L).

    What is low of a link is pulled sideways onto the Z axis. The base's slide tells how high each would be in a
    straight shaft; a link up to ``SPHINCTER`` lower than that, and lower than ``min_height``, is lifted. ``ring`` has
    the shape (W, L), ``gravity`` the shape (W,).
    """
    w, link = wp.tid()
    i = w * resistance.shape[0] + link
    force = body_mass[i] * (gravity[w] / mass_scaling)
    held = wp.vec3(0.0)
    p = wp.transform_get_translation(body_q[i])
    if ring[w, link] <= FIRST_RINGS:
        v = wp.spatial_top(body_qd[i])
        damping = guide.damping + dt * guide.stiffness
        guided = length_below(guide.height, body_q[i], guide.length[link])
        away = guide.stiffness * p + damping * v
        force -= guided * wp.vec3(away[0], away[1], 0.0)
        held = guided * dt * damping * wp.vec3(1.0, 1.0, 0.0)
        low = guide.min_height + wp.min(guide.rest[link] + joint_q[w * coords], 0.0) - p[2]
        if low > 0.0 and low < SPHINCTER:
            force[2] = force[2] + guide.length[link] * (guide.stiffness * low - damping * v[2])
            held[2] = guide.length[link] * dt * damping
    body_f[i] = wp.spatial_vector(force, wp.vec3(0.0))
    resistance[link, w] = wp.spatial_vector(held, wp.vec3(0.0))
