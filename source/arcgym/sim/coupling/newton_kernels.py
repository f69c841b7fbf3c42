# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Copies between our wall arrays (V, W) and Newton's particles (V wall vertices and A anchors a world)."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.kernel
def to_particles(ours: wp.array2d[wp.vec3], stride: int, particles: wp.array[wp.vec3]):
    """Copy ``ours``, shape (V, W), to the first of each world's ``stride`` particles. Launch (V, W)."""
    i, w = wp.tid()
    particles[w * stride + i] = ours[i, w]


@wp.kernel
def from_particles(particles: wp.array[wp.vec3], stride: int, ours: wp.array2d[wp.vec3]):
    """Copy the first of each world's ``stride`` particles to ``ours``, shape (V, W). Launch (V, W)."""
    i, w = wp.tid()
    ours[i, w] = particles[w * stride + i]


@wp.kernel
def damp(factor: float, velocity: wp.array[wp.vec3]):
    """Multiply all particles' velocities, shape (P,), by ``factor``. Launch (P,)."""
    i = wp.tid()
    velocity[i] = factor * velocity[i]


@wp.kernel
def add_coupling_forces(wrench: wp.array[wp.spatial_vector], weight: float, total: wp.array[wp.vec3]):
    """Add ``weight`` times the force of each link's ``wrench`` to ``total`` [N], shape (W*L,) each. Launch (W*L,)."""
    i = wp.tid()
    total[i] = total[i] + weight * wp.spatial_top(wrench[i])
