# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Points of a fine surface that the wall carries, where links are. W worlds, V wall vertices, M points, P patients.

R rings of the wall, L links a world; ring r of the fine surface is what is carried by the wall's rings r and r + 1.
"""

import warp as wp

from arcgym.sim.contact.contact_kernels import ContactLaw, LinkShapes
from arcgym.sim.contact.contact_search_kernels import link_axis
from arcgym.sim.contact.lumen_kernels import FAR, Bounds, LumenSurface, bound_ring, sphere_reached, write_ring
from arcgym.utils import warp_setup  # noqa: F401

MARGIN = wp.constant(1.01)
"""Factor on the radius of a sphere around a ring: for rounding, and for carriers beyond it, of up to a thousandth."""
FURTHER_RINGS = wp.constant(2)
"""Rings beyond those near a link whose points are carried, too: of the faces across a border, whose normals count."""


@wp.func
def carrying_sphere(
    x: wp.array2d[wp.vec3],
    surface: LumenSurface,
    room: wp.array2d[float],
    patient: wp.array[int],
    centers: wp.array2d[wp.vec3],
    r: int,
    w: int,
) -> wp.vec4:
    """Return the sphere around what ring ``r`` and the next one carry."""
    above = wp.min(r + 1, surface.rings.shape[0] - 1)
    middle = 0.5 * (centers[w, r] + centers[w, above])
    square = float(0.0)
    for k in range(surface.rings.shape[1]):
        square = wp.max(square, wp.length_sq(x[surface.rings[r, k], w] - middle))
        square = wp.max(square, wp.length_sq(x[surface.rings[above, k], w] - middle))
    return wp.vec4(middle[0], middle[1], middle[2], MARGIN * (wp.sqrt(square) + room[r, patient[w]]))


@wp.func
def link_near(
    sphere: wp.vec4,
    body_q: wp.array[wp.transform],
    links: LinkShapes,
    law: ContactLaw,
    ring_distance: wp.array2d[float],
    w: int,
) -> bool:
    """Return whether a link of world ``w`` may touch what is in a sphere."""
    count = links.radius.shape[0]
    found = bool(False)
    link = int(0)
    while link < count and not found:
        if ring_distance[w, link] < FAR:
            row = w * count + link
            center = wp.transform_get_translation(body_q[row])
            limit = links.radius[link] + law.wall_radius + law.search_gap
            found = sphere_reached(sphere, center, link_axis(body_q, row, links.half_length[link]), limit)
        link += 1
    return found


@wp.kernel
def mark_near_rings(
    x: wp.array2d[wp.vec3],
    surface: LumenSurface,
    room: wp.array2d[float],
    patient: wp.array[int],
    body_q: wp.array[wp.transform],
    links: LinkShapes,
    law: ContactLaw,
    ring_distance: wp.array2d[float],
    centers: wp.array2d[wp.vec3],
    near: wp.array2d[int],
):
    """Mark the rings of the fine surface that a link may touch. Launch (R, W).

    A point is a mean of wall vertices and an offset from there: it lies in a sphere around the two rings that carry it,
    larger by the longest offset.

    Args:
        x: Wall positions [m], shape (V, W).
        surface: Inner faces of one world.
        room: Longest offset of a point of each ring [m], shape (R, P).
        patient: Patient of each world, shape (W,).
        body_q: Link poses, shape (W*L,).
        links: Capsules of one world.
        law: Contact law.
        ring_distance: Distance from the center of the link's ring, FAR for links outside the anus [m], shape (W, L).
        centers: Center of each ring [m], shape (W, R).
        near: 1 where a link may touch the ring, else 0, shape (R, W); written.
    """
    r, w = wp.tid()
    sphere = carrying_sphere(x, surface, room, patient, centers, r, w)
    near[r, w] = int(link_near(sphere, body_q, links, law, ring_distance, w))


@wp.kernel
def mark_near_followed(
    x: wp.array2d[wp.vec3],
    surface: LumenSurface,
    room: wp.array2d[float],
    patient: wp.array[int],
    body_q: wp.array[wp.transform],
    links: LinkShapes,
    law: ContactLaw,
    ring_distance: wp.array2d[float],
    centers: wp.array2d[wp.vec3],
    moved: wp.array2d[int],
    slack: float,
    spheres: wp.array2d[wp.vec4],
    near: wp.array2d[int],
):
    """Do as ``mark_near_rings`` with spheres that are larger by the slack, and kept until a ring moves. Launch (R, W).

    Args:
        x: Wall positions [m], shape (V, W).
        surface: Inner faces of one world.
        room: Longest offset of a point of each ring [m], shape (R, P).
        patient: Patient of each world, shape (W,).
        body_q: Link poses, shape (W*L,).
        links: Capsules of one world.
        law: Contact law.
        ring_distance: Distance from the center of the link's ring, FAR for links outside the anus [m], shape (W, L).
        centers: Center of each ring [m], shape (W, R).
        moved: 1 where a vertex of a ring has moved by the slack, else 0, shape (R, W).
        slack: See ``follow_rings`` [m].
        spheres: Around each ring and the next, shape (R, W); updated.
        near: 1 where a link may touch the ring, else 0, shape (R, W); written.
    """
    r, w = wp.tid()
    sphere = spheres[r, w]
    if moved[r, w] == 1 or moved[wp.min(r + 1, moved.shape[0] - 1), w] == 1:
        sphere = carrying_sphere(x, surface, room, patient, centers, r, w)
        sphere = wp.vec4(sphere[0], sphere[1], sphere[2], sphere[3] + slack)
        spheres[r, w] = sphere
    near[r, w] = int(link_near(sphere, body_q, links, law, ring_distance, w))


@wp.kernel
def bound_near_faces(x: wp.array2d[wp.vec3], surface: LumenSurface, near: wp.array2d[int], bounds: Bounds):
    """Enclose the faces of each ring, patch by patch; those of rings that are not ``near`` are FAR. Launch (R, W)."""
    r, w = wp.tid()
    if near[r, w] == 1:
        bound_ring(x, surface, bounds, 0.0, r, w)
    else:
        write_ring(bounds, r, w, wp.vec4(FAR, FAR, FAR, 0.0))


@wp.kernel
def mark_carried_rings(near: wp.array2d[int], moved: wp.array2d[int]):
    """Write 1 to ``moved`` where a ring is ``near`` a link or a few rings from one that is, else 0. Launch (R, W)."""
    r, w = wp.tid()
    found = int(0)
    for k in range(wp.max(r - FURTHER_RINGS, 0), wp.min(r + FURTHER_RINGS + 1, near.shape[0])):
        found = wp.max(found, near[k, w])
    moved[r, w] = found


@wp.kernel
def carry_points(
    x: wp.array2d[wp.vec3],
    moved: wp.array2d[int],
    ring: wp.array[int],
    index: wp.array[wp.vec4i],
    weight: wp.array[wp.vec4],
    offset: wp.array2d[wp.vec3],
    patient: wp.array[int],
    points: wp.array2d[wp.vec3],
):
    """Move the points with the cells of the wall that carry them. Launch (M, W).

    Those far from the links stay where they were. The offset from the mean of the cell's corners is turned with the
    cell: by the frame of its mean direction along the colon and its normal.

    Args:
        x: Wall positions [m], shape (V, W).
        moved: 1 where the points of a ring are moved, else 0, shape (R, W).
        ring: Ring of each point's cell, shape (M,).
        index: Corners of each point's cell: on the lower ring, on the upper, both again in the next sector, shape (M,).
        weight: Their weights, shape (M,).
        offset: Offset of each point in the frame of its cell [m], shape (M, P).
        patient: Patient of each world, shape (W,).
        points: Positions [m], shape (M, W); written.
    """
    m, w = wp.tid()
    if moved[ring[m], w] == 0:
        return
    i = index[m]
    u = weight[m]
    a = x[i[0], w]
    b = x[i[1], w]
    c = x[i[2], w]
    d = x[i[3], w]
    along = wp.normalize(b + c - a - d)
    normal = wp.normalize(wp.cross(along, c + d - a - b))
    away = offset[m, patient[w]]
    turned = away[0] * along + away[1] * wp.cross(normal, along) + away[2] * normal
    points[m, w] = u[0] * a + u[1] * b + u[2] * c + u[3] * d + turned
