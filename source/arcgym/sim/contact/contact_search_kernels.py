# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Narrow phase between capsule links and the inner wall, binned along the centreline.

Launch dimensions: W worlds, L links a world, R rings (centreline bins), M candidate faces a link, V wall vertices.
"""

import warp as wp

from arcgym.sim.contact.contact_kernels import CLEARANCE, ContactLaw, ContactRecords, LinkShapes
from arcgym.sim.geometry_kernels import corner_point, segment_parameter, segment_triangle, segment_triangle_mean
from arcgym.utils import warp_setup  # noqa: F401

FAR = wp.constant(1.0e9)
SMOOTHING = wp.constant(5.0e-5)
"""Length over which the contact point is a mean of a face's nearest points, weighted by exp(-distance / length) [m]."""
EDGE_BAND = wp.constant(0.1)
"""Barycentric coordinate under which the face across the opposite edge takes part in a contact."""
EDGE_WEIGHT = wp.constant(0.45)
"""Weight of a contact for each edge that it lies on: two faces touch it there, and about six at a corner."""


@wp.struct
class LumenSurface:
    """Inner faces of one world's wall, sorted by ring; normals point from the lumen into the wall."""

    rings: wp.array2d[int]  # inner vertices of each ring, padded with the first, shape (R, S)
    faces: wp.array2d[int]  # shape (F, 3)
    neighbors: wp.array2d[int]  # face across the edge opposite to each corner or -1, shape (F, 3)
    ring_start: wp.array[int]  # first face of each ring, shape (R + 1,)
    reach: int  # rings searched on either side of a link's own


@wp.kernel
def ring_centers(x: wp.array2d[wp.vec3], surface: LumenSurface, centers: wp.array2d[wp.vec3]):
    """Compute the mean of each ring's inner vertices. Launch (W, R).

    Args:
        x: Wall positions [m], shape (V, W).
        surface: Inner faces of one world.
        centers: Ring centres [m], shape (W, R); written.
    """
    w, r = wp.tid()
    n = surface.rings.shape[1]
    total = wp.vec3(0.0)
    for k in range(n):
        total += x[surface.rings[r, k], w]
    centers[w, r] = total / float(n)


@wp.kernel
def track_rings(
    centers: wp.array2d[wp.vec3],
    body_q: wp.array[wp.transform],
    max_shift: int,
    ring: wp.array2d[int],
    ring_distance: wp.array2d[float],
):
    """Find the ring nearest to each link, and its distance [m]. Launch (W, L).

    Searches ``max_shift`` rings on either side of the last one, and all of them where it is -1.

    A link whose centre is outside the anus, before the first ring, is at distance FAR: the wall has no outer surface.

    Args:
        centers: Ring centres [m], shape (W, R).
        body_q: Link poses, shape (W*L,).
        max_shift: Rings that a link may cross since the last call.
        ring: Ring of each link or -1, shape (W, L); updated.
        ring_distance: Distance from its centre [m], shape (W, L); written.
    """
    w, link = wp.tid()
    p = wp.transform_get_translation(body_q[w * ring.shape[1] + link])
    last = ring[w, link]
    lo = int(0)
    hi = centers.shape[1]
    if last >= 0:
        lo = wp.max(0, last - max_shift)
        hi = wp.min(hi, last + max_shift + 1)
    best = float(FAR)
    found = last
    for r in range(lo, hi):
        d = wp.length_sq(p - centers[w, r])
        if d < best:
            best = d
            found = r
    ring[w, link] = found
    ring_distance[w, link] = wp.sqrt(best)
    if found == 0 and wp.dot(p - centers[w, 0], centers[w, 1] - centers[w, 0]) < 0.0:
        ring_distance[w, link] = FAR


@wp.func
def plane_reached(a: wp.vec3, normal: wp.vec3, axis: wp.vec3, limit: float) -> bool:
    """Return whether the plane through ``a`` comes within ``limit`` of the segment from ``-axis`` to ``axis``."""
    gap = wp.abs(wp.dot(normal, a)) - wp.abs(wp.dot(normal, axis))
    return gap <= 0.0 or gap * gap <= limit * limit * wp.length_sq(normal)


@wp.kernel
def face_distances(
    x: wp.array2d[wp.vec3],
    body_q: wp.array[wp.transform],
    links: LinkShapes,
    surface: LumenSurface,
    law: ContactLaw,
    ring: wp.array2d[int],
    ring_distance: wp.array2d[float],
    distance: wp.array3d[float],
):
    """Compute the distance from each link's axis to each candidate face. Launch (W, L, M).

    Args:
        x: Wall positions [m], shape (V, W).
        body_q: Link poses, shape (W*L,).
        links: Capsules of one world.
        surface: Inner faces of one world.
        law: Contact law.
        ring: Ring of each link, shape (W, L).
        ring_distance: Distance from its centre [m], shape (W, L).
        distance: Distance, or FAR where there is no contact [m], shape (W, L, M); written.
    """
    w, link, m = wp.tid()
    if ring_distance[w, link] > law.max_distance + links.half_length[link] + links.radius[link]:
        distance[w, link, m] = FAR
        return
    nr = surface.ring_start.shape[0] - 1
    face = surface.ring_start[wp.max(0, ring[w, link] - surface.reach)] + m
    d = float(FAR)
    if face < surface.ring_start[wp.min(nr, ring[w, link] + surface.reach + 1)]:
        a = x[surface.faces[face, 0], w]
        b = x[surface.faces[face, 1], w]
        c = x[surface.faces[face, 2], w]
        pose = body_q[w * ring.shape[1] + link]
        center = wp.transform_get_translation(pose)
        axis = wp.transform_vector(pose, wp.vec3(0.0, 0.0, links.half_length[link]))
        limit = links.radius[link] + law.wall_radius + law.search_gap
        g = (a + b + c) / 3.0
        size = wp.sqrt(wp.max(wp.length_sq(a - g), wp.max(wp.length_sq(b - g), wp.length_sq(c - g))))
        t = segment_parameter(g, center - axis, center + axis)
        near = wp.length_sq(g - center - (2.0 * t - 1.0) * axis) < (limit + size) * (limit + size)
        if near and plane_reached(a - center, wp.cross(b - a, c - a), axis, limit):
            u = segment_triangle(center - axis, center + axis, a, b, c)
            if u[3] < limit:
                d = u[3]
    distance[w, link, m] = d


@wp.func
def face_normal(surface: LumenSurface, face: int, x: wp.array2d[wp.vec3], w: int) -> wp.vec3:
    """Return the unit normal of a face, from the lumen into the wall."""
    a = x[surface.faces[face, 0], w]
    return wp.normalize(wp.cross(x[surface.faces[face, 1], w] - a, x[surface.faces[face, 2], w] - a))


@wp.func
def edge_proximity(u: float) -> float:
    """Return 1 on the edge opposite to a corner with barycentric coordinate ``u``, falling to 0 off it."""
    return 1.0 - wp.clamp(u / EDGE_BAND, 0.0, 1.0)


@wp.func
def surface_normal(surface: LumenSurface, face: int, u: wp.vec3, x: wp.array2d[wp.vec3], w: int) -> wp.vec3:
    """Return the normal at barycentric ``u`` of ``face``; towards an edge, the mean with the face beyond it.

    At a sharp fold the face's own normal may be at more than a right angle to the direction to the link, and its sign
    would be wrong
    (Baerentzen and Aanaes 2005, "Signed distance computation using the angle weighted pseudonormal").
    """
    normal = face_normal(surface, face, x, w)
    for k in range(3):
        other = surface.neighbors[face, k]
        if u[k] < EDGE_BAND and other >= 0:
            normal += edge_proximity(u[k]) * face_normal(surface, other, x, w)
    return wp.normalize(normal)


@wp.func
def face_corners(surface: LumenSurface, face: int) -> wp.vec3i:
    """Return the vertices of a face."""
    return wp.vec3i(surface.faces[face, 0], surface.faces[face, 1], surface.faces[face, 2])


@wp.struct
class ClosestPoint:
    """Point of a face that is closest to a link."""

    bary: wp.vec3  # barycentric coordinates
    normal: wp.vec3  # of the wall there
    direction: wp.vec3  # unit vector there from the link's axis


@wp.func
def closest_point(
    surface: LumenSurface,
    face: int,
    x: wp.array2d[wp.vec3],
    w: int,
    center: wp.vec3,
    axis: wp.vec3,
    distance: float,
) -> ClosestPoint:
    """Return the point of ``face`` closest to the link from ``center`` - ``axis`` to ``center`` + ``axis``."""
    f = face_corners(surface, face)
    out = ClosestPoint()
    out.bary = segment_triangle_mean(
        center - axis, center + axis, x[f[0], w], x[f[1], w], x[f[2], w], distance, SMOOTHING
    )
    out.normal = surface_normal(surface, face, out.bary, x, w)
    p = corner_point(x, f, out.bary, w)
    t = segment_parameter(p, center - axis, center + axis)
    out.direction = wp.normalize(p - center - (2.0 * t - 1.0) * axis)
    return out


@wp.func
def free_slot(records: ContactRecords, distance: wp.array3d[float], w: int, link: int, n: int, d: float) -> int:
    """Return the slot for a contact at distance ``d``: the next one, else that of the farthest contact, or -1."""
    row = w * distance.shape[1] + link
    if n < records.capacity:
        return row * records.capacity + n
    worst = int(-1)
    for k in range(records.capacity):
        slot = row * records.capacity + k
        if records.distance[slot] > d:
            d = records.distance[slot]
            worst = slot
    return worst


@wp.kernel
def select_contacts(surface: LumenSurface, ring: wp.array2d[int], distance: wp.array3d[float], records: ContactRecords):
    """Make a record of every face near a link, the nearest where there are too many. Launch (W, L).

    Args:
        surface: Inner faces of one world.
        ring: Ring of each link, shape (W, L).
        distance: Distance of each candidate face or FAR [m], shape (W, L, M).
        records: Contacts; ``count``, ``face`` and ``distance`` are written.
    """
    w, link = wp.tid()
    row = w * ring.shape[1] + link
    first = surface.ring_start[wp.max(0, ring[w, link] - surface.reach)]
    n = int(0)
    for m in range(distance.shape[2]):
        d = distance[w, link, m]
        if d < FAR:
            slot = free_slot(records, distance, w, link, n, d)
            if slot >= 0:
                records.face[slot] = first + m
                records.distance[slot] = d
                n = wp.min(n + 1, records.capacity)
    records.count[row] = n


@wp.kernel
def locate_contacts(
    x: wp.array2d[wp.vec3],
    body_q: wp.array[wp.transform],
    links: LinkShapes,
    surface: LumenSurface,
    records: ContactRecords,
):
    """Find where every recorded face comes closest to its link. Launch (W, L, capacity).

    Args:
        x: Wall positions [m], shape (V, W).
        body_q: Link poses, shape (W*L,).
        links: Capsules of one world.
        surface: Inner faces of one world.
        records: Contacts; ``corners``, ``bary``, ``weight``, ``normal`` and ``direction`` are written.
    """
    w, link, k = wp.tid()
    row = w * links.radius.shape[0] + link
    if k >= records.count[row]:
        return
    slot = row * records.capacity + k
    pose = body_q[row]
    center = wp.transform_get_translation(pose)
    axis = wp.transform_vector(pose, wp.vec3(0.0, 0.0, links.half_length[link]))
    face = records.face[slot]
    point = closest_point(surface, face, x, w, center, axis, records.distance[slot])
    u = point.bary
    records.corners[slot] = face_corners(surface, face)
    records.bary[slot] = u
    records.weight[slot] = wp.pow(EDGE_WEIGHT, edge_proximity(u[0]) + edge_proximity(u[1]) + edge_proximity(u[2]))
    records.normal[slot] = point.normal
    records.direction[slot] = point.direction


@wp.kernel
def use_directions_as_normals(links: LinkShapes, records: ContactRecords):
    """Replace the normals of a link that is clear of the wall by the directions to the contacts. Launch (W, L).

    A link whose axis is clear of the wall has not gone through and will not in this step. The far side of a fold, whose
    normal points away from the link, pushes it back then, too.
    """
    w, link = wp.tid()
    row = w * links.radius.shape[0] + link
    nearest = float(FAR)
    for k in range(records.count[row]):
        nearest = wp.min(nearest, records.distance[row * records.capacity + k])
    if nearest > CLEARANCE * links.radius[link]:
        for k in range(records.count[row]):
            slot = row * records.capacity + k
            records.normal[slot] = records.direction[slot]


@wp.kernel
def build_contact_lists(vertex_ring: wp.array[int], links: int, records: ContactRecords):
    """Link each world's records into lists by vertex and by ring, in ascending order. Launch (W,).

    One thread a world keeps the order, and with it every sum over contacts, the same on CPU and GPU.

    Args:
        vertex_ring: Ring of each wall vertex, shape (V,).
        links: Links a world, L.
        records: Contacts; the lists, emptied before, are written.
    """
    w = wp.tid()
    for step in range(links):
        row = (w + 1) * links - 1 - step
        n = records.count[row]
        for back in range(n):
            slot = row * records.capacity + n - 1 - back
            face = records.corners[slot]
            lowest = records.ring_head.shape[0]
            for k in range(3):
                entry = 3 * slot + k
                v = face[k]
                records.vertex_next[entry] = records.vertex_head[v, w]
                records.vertex_head[v, w] = entry
                lowest = wp.min(lowest, vertex_ring[v])
            records.ring_next[slot] = records.ring_head[lowest, w]
            records.ring_head[lowest, w] = slot
