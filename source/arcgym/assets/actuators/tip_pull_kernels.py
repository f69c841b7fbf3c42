# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Kernels of the pull on a tip. W worlds, L links.

Forces hold for a link that keeps its velocity; ``resistance`` is the diagonal of their drop by acceleration (linear
[kg], angular [kg m^2]), with which a solver makes springs and dampers implicit.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.math_kernels import clamp_length


@wp.struct
class TipSpring:
    """Force-limited spring from the tip to a target that moves at the commanded velocity."""

    stiffness: float  # [N/m]
    damping: float  # [N s/m]
    force_limit: float  # [N]
    angular_stiffness: float  # [N m/rad]
    angular_damping: float  # [N m s/rad]
    torque_limit: float  # [N m]


@wp.kernel
def pull_tip(
    body_q: wp.array[wp.transform],
    body_qd: wp.array[wp.spatial_vector],
    pull: TipSpring,
    lin_command: wp.array[wp.vec3],
    ang_command: wp.array[wp.vec3],
    dt: float,
    lead: wp.array[wp.vec3],
    turn: wp.array[wp.vec3],
    body_f: wp.array[wp.spatial_vector],
    resistance: wp.array2d[wp.spatial_vector],
    force: wp.array[wp.vec4],
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
def record_pull(force: wp.array[wp.vec4], acc_lin: wp.array2d[wp.vec3], weight: float, total: wp.array[wp.vec3]):
    """Add ``weight`` times the pull at the end of the step to ``total``. Launch (W,)."""
    w = wp.tid()
    f = force[w]
    total[w] = total[w] + weight * (wp.vec3(f[0], f[1], f[2]) - f[3] * acc_lin[acc_lin.shape[0] - 1, w])
