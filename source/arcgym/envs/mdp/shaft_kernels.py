# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Kernels that tell loops of the shaft apart; definitions are in :mod:`arcgym.envs.mdp.shaft_metrics`.

N worlds, L links, base first, R rings. The picture plane is seen from the front: x to the patient's right, z cranial.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401

NO_CROSSING = wp.constant(1 << 30)
"""Key of a world whose shaft does not cross itself."""


@wp.kernel
def link_places(
    links: wp.array2d[wp.vec3],
    rings: wp.array2d[wp.vec3],
    ring_arc: wp.array2d[float],
    last: wp.array[float],
    counts: wp.array2d[wp.bool],
):
    """Mark the links that lie in the colon up to an arc length, by the nearest ring's center. Launch (N, L).

    Args:
        links: Centers of the links [m], shape (N, L).
        rings: Centers of the rings [m], shape (N, R).
        ring_arc: Arc length of the rings [m], shape (N, R).
        last: Arc length up to which links count [m], shape (N,).
        counts: Whether the link counts, shape (N, L); written.
    """
    world, link = wp.tid()
    place = links[world, link]
    nearest = wp.float32(1.0e9)
    arc = wp.float32(0.0)
    for ring in range(rings.shape[1]):
        distance = wp.length_sq(rings[world, ring] - place)
        if distance < nearest:
            nearest = distance
            arc = ring_arc[world, ring]
    counts[world, link] = place[2] > 0.0 and arc <= last[world]


@wp.kernel
def find_crossings(links: wp.array2d[wp.vec3], counts: wp.array2d[wp.bool], shortest: float, first: wp.array[wp.int32]):
    """Find the crossing of the shaft with itself that is completed first, seen from the front. Launch (N, L - 1).

    Args:
        links: Centers of the links [m], shape (N, L).
        counts: Whether a link counts, shape (N, L).
        shortest: Length of shaft between the two passes from which on they are a loop [m].
        first: Twice the number of the later pass's link, plus one for a left-handed crossing, shape (N,); the least
            is kept.
    """
    world, i = wp.tid()
    if not (counts[world, i] and counts[world, i + 1]):
        return
    a = links[world, i]
    u = links[world, i + 1] - a
    way = wp.float32(0.0)
    for j in range(i + 1, links.shape[1] - 1):
        c = links[world, j]
        v = links[world, j + 1] - c
        if way >= shortest and counts[world, j] and counts[world, j + 1]:
            across = u[0] * v[2] - u[2] * v[0]
            if across != 0.0:
                on_u = ((c[0] - a[0]) * v[2] - (c[2] - a[2]) * v[0]) / across
                on_v = ((c[0] - a[0]) * u[2] - (c[2] - a[2]) * u[0]) / across
                if on_u >= 0.0 and on_u < 1.0 and on_v >= 0.0 and on_v < 1.0:
                    depth = (a[1] + on_u * u[1]) - (c[1] + on_v * v[1])
                    key = 2 * j
                    if -across * depth < 0.0:
                        key += 1
                    wp.atomic_min(first, world, key)
        way += wp.length(v)


@wp.kernel
def classify(
    links: wp.array2d[wp.vec3],
    counts: wp.array2d[wp.bool],
    first: wp.array[wp.int32],
    drop: float,
    kind: wp.array[wp.int32],
):
    """Name the loop: 0 none, 1 N, 2 alpha, 3 reverse alpha. Launch (N,).

    Args:
        links: Centers of the links [m], shape (N, L).
        counts: Whether a link counts, shape (N, L).
        first: What :func:`find_crossings` left, shape (N,).
        drop: Height by which the shaft must come down and rise again to be an N [m].
        kind: The loop's kind, shape (N,); written.
    """
    world = wp.tid()
    if first[world] < NO_CROSSING:
        kind[world] = 2 + first[world] % 2
        return
    highest = wp.float32(-1.0e9)
    lowest = wp.float32(1.0e9)
    is_n = wp.int32(0)
    for link in range(links.shape[1]):
        if counts[world, link]:
            z = links[world, link][2]
            if z > highest and lowest > highest - drop:
                highest = z
                lowest = z
            lowest = wp.min(lowest, z)
            if lowest <= highest - drop and z >= lowest + drop:
                is_n = 1
    kind[world] = is_n
