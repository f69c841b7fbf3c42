# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Balls strewn over space, of which stool and bubbles are made."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.func
def cell_state(seed: int, x: int, y: int, z: int) -> wp.uint32:
    """Return the generator's state of a cell of space."""
    state = wp.rand_init(seed, x)
    state = wp.rand_init(int(state), y)
    return wp.rand_init(int(state), z)


@wp.func
def blob_at(place: wp.vec3, cell: float, share: float, small: float, large: float, seed: int) -> wp.vec2:
    """Return how deep a place lies in the nearest ball, 0 at its rim and 1 in its middle, and its shade; -1 outside.

    A share of the cells of a cubic grid holds a ball each, of a radius between ``small`` and ``large`` cells.
    """
    best = wp.vec2(-1.0, 0.0)
    at = place / cell
    ix = int(wp.floor(at[0]))
    iy = int(wp.floor(at[1]))
    iz = int(wp.floor(at[2]))
    for dx in range(-1, 2):
        for dy in range(-1, 2):
            for dz in range(-1, 2):
                state = cell_state(seed, ix + dx, iy + dy, iz + dz)
                if wp.randf(state) < share:
                    middle = wp.vec3(float(ix + dx), float(iy + dy), float(iz + dz))
                    middle += wp.vec3(wp.randf(state), wp.randf(state), wp.randf(state))
                    radius = small + (large - small) * wp.randf(state)
                    inside = 1.0 - wp.length(at - middle) / radius
                    if inside > best[0]:
                        best = wp.vec2(inside, wp.randf(state))
    return best
