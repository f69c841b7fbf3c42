# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Contact search between capsule links and the inner wall, by distance: rings, then patches, then faces.

W worlds, L links a world, R rings (centreline bins), P patches of faces, C candidate faces a link, S contact slots a
world, V wall vertices.
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
    patch_start: wp.array[int]  # first face of each patch, shape (P + 1,)
    ring_patch: wp.array[int]  # first patch of each ring, shape (R + 1,)
    reach: int  # rings on either side of a link's own whose faces may touch it from outside, too


@wp.struct
class Bounds:
    """Spheres around the faces of each patch and of each ring: center [m] and radius [m]."""

    patch: wp.array2d[wp.vec4]  # shape (P, W)
    ring: wp.array2d[wp.vec4]  # shape (R, W)


@wp.struct
class Candidates:
    """Patches near each link, up to Q of them, and the distances of their faces, up to F each."""

    patch: wp.array3d[int]  # twice the patch, and 1 more where its faces count from either side, shape (W, L, Q)
    patches: wp.array2d[int]  # number of them, also beyond Q, shape (W, L)
    distance: wp.array3d[float]  # of each patch's faces from the link's axis, FAR for none [m], shape (W, L, Q*F)
    count: wp.array2d[int]  # faces that are near, shape (W, L)
    patch_faces: int  # F


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

    A link whose center is outside the anus, before the first ring, is at distance FAR: the wall has no outer surface.

    Args:
        centers: Ring centers [m], shape (W, R).
        body_q: Link poses, shape (W*L,).
        max_shift: Rings that a link may cross since the last call.
        ring: Ring of each link or -1, shape (W, L); updated.
        ring_distance: Distance from its center [m], shape (W, L); written.
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
def bound_faces(x: wp.array2d[wp.vec3], surface: LumenSurface, bounds: Bounds):
    """Enclose the faces of each ring, patch by patch. Launch (R, W)."""
    r, w = wp.tid()
    first = surface.ring_patch[r]
    last = surface.ring_patch[r + 1]
    middle = wp.vec3(0.0)
    for p in range(first, last):
        center = wp.vec3(0.0)
        faces = surface.patch_start[p + 1] - surface.patch_start[p]
        for f in range(surface.patch_start[p], surface.patch_start[p + 1]):
            for k in range(3):
                center += x[surface.faces[f, k], w]
        center = center / float(3 * faces)
        radius = float(0.0)
        for f in range(surface.patch_start[p], surface.patch_start[p + 1]):
            for k in range(3):
                radius = wp.max(radius, wp.length_sq(x[surface.faces[f, k], w] - center))
        bounds.patch[p, w] = wp.vec4(center[0], center[1], center[2], wp.sqrt(radius))
        middle += center
    middle = middle / float(wp.max(1, last - first))
    radius = float(0.0)
    for p in range(first, last):
        sphere = bounds.patch[p, w]
        radius = wp.max(radius, wp.length(wp.vec3(sphere[0], sphere[1], sphere[2]) - middle) + sphere[3])
    bounds.ring[r, w] = wp.vec4(middle[0], middle[1], middle[2], radius)


@wp.func
def sphere_reached(sphere: wp.vec4, center: wp.vec3, axis: wp.vec3, limit: float) -> bool:
    """Whether a sphere comes within ``limit`` of the segment from ``center`` - ``axis`` to ``center`` + ``axis``."""
    p = wp.vec3(sphere[0], sphere[1], sphere[2])
    t = segment_parameter(p, center - axis, center + axis)
    reach = limit + sphere[3]
    return wp.length_sq(p - center - (2.0 * t - 1.0) * axis) < reach * reach


@wp.func
def face_distance(
    surface: LumenSurface,
    face: int,
    x: wp.array2d[wp.vec3],
    w: int,
    center: wp.vec3,
    axis: wp.vec3,
    limit: float,
    both_sides: bool,
) -> float:
    """Return the distance of a face from the segment from ``center`` - ``axis`` to ``center`` + ``axis`` [m].

    FAR beyond ``limit``, and where the middle of the segment is not on the lumen's side unless ``both_sides``.
    """
    a = x[surface.faces[face, 0], w] - center
    b = x[surface.faces[face, 1], w] - center
    c = x[surface.faces[face, 2], w] - center
    normal = wp.cross(b - a, c - a)
    if (both_sides or wp.dot(normal, a) > 0.0) and plane_reached(a, normal, axis, limit):
        d = segment_triangle(-axis, axis, a, b, c)[3]
        if d < limit:
            return d
    return FAR


@wp.func
def link_axis(body_q: wp.array[wp.transform], row: int, half_length: float) -> wp.vec3:
    """Half the axis of the link in ``row`` [m]."""
    return wp.transform_vector(body_q[row], wp.vec3(0.0, 0.0, half_length))


@wp.kernel
def find_patches(
    body_q: wp.array[wp.transform],
    links: LinkShapes,
    surface: LumenSurface,
    bounds: Bounds,
    law: ContactLaw,
    ring: wp.array2d[int],
    ring_distance: wp.array2d[float],
    candidates: Candidates,
):
    """Find the patches near each link, wherever along the colon they are. Launch (W, L).

    Args:
        body_q: Link poses, shape (W*L,).
        links: Capsules of one world.
        surface: Inner faces of one world.
        bounds: Spheres around rings and patches.
        law: Contact law.
        ring: Ring of each link, shape (W, L).
        ring_distance: Distance from its center, FAR for links outside the anus [m], shape (W, L).
        candidates: ``patch`` and ``patches`` are written.
    """
    w, link = wp.tid()
    n = int(0)
    if ring_distance[w, link] < FAR:
        row = w * ring.shape[1] + link
        center = wp.transform_get_translation(body_q[row])
        axis = link_axis(body_q, row, links.half_length[link])
        limit = links.radius[link] + law.wall_radius + law.search_gap
        for r in range(bounds.ring.shape[0]):
            if sphere_reached(bounds.ring[r, w], center, axis, limit):
                both_sides = int(wp.abs(r - ring[w, link]) <= surface.reach)
                for p in range(surface.ring_patch[r], surface.ring_patch[r + 1]):
                    if sphere_reached(bounds.patch[p, w], center, axis, limit):
                        if n < candidates.patch.shape[2]:
                            candidates.patch[w, link, n] = 2 * p + both_sides
                        n += 1
    candidates.patches[w, link] = n


@wp.kernel
def face_distances(
    x: wp.array2d[wp.vec3],
    body_q: wp.array[wp.transform],
    links: LinkShapes,
    surface: LumenSurface,
    law: ContactLaw,
    candidates: Candidates,
):
    """Measure the distance of the faces of the patches near each link. Launch (W, L, Q*F).

    Far along the colon from the link's own ring, faces count that have the link on their lumen's side: the wall
    gathered around the link, but not the outside of a neighboring loop.

    Args:
        x: Wall positions [m], shape (V, W).
        body_q: Link poses, shape (W*L,).
        links: Capsules of one world.
        surface: Inner faces of one world.
        law: Contact law.
        candidates: Patches near each link; ``distance`` is written.
    """
    w, link, m = wp.tid()
    k = m // candidates.patch_faces
    if k >= candidates.patches[w, link]:
        return
    code = candidates.patch[w, link, k]
    face = surface.patch_start[code // 2] + m - k * candidates.patch_faces
    d = float(FAR)
    if face < surface.patch_start[code // 2 + 1]:
        row = w * candidates.patches.shape[1] + link
        center = wp.transform_get_translation(body_q[row])
        axis = link_axis(body_q, row, links.half_length[link])
        limit = links.radius[link] + law.wall_radius + law.search_gap
        d = face_distance(surface, face, x, w, center, axis, limit, code % 2 == 1)
    candidates.distance[w, link, m] = d


@wp.kernel
def count_candidates(candidates: Candidates, dropped: wp.array[int]):
    """Count the faces near each link. Launch (W, L).

    Args:
        candidates: Distances of the faces of the patches near each link; ``count`` is written.
        dropped: Contacts that found no room, shape (W,); the faces of patches beyond Q are added to it.
    """
    w, link = wp.tid()
    patches = candidates.patches[w, link]
    room = candidates.patch.shape[2]
    if patches > room:
        wp.atomic_add(dropped, w, (patches - room) * candidates.patch_faces)
        candidates.patches[w, link] = room
        patches = room
    n = int(0)
    for m in range(patches * candidates.patch_faces):
        if candidates.distance[w, link, m] < FAR:
            n += 1
    candidates.count[w, link] = n


@wp.kernel
def allot_slots(candidates: Candidates, records: ContactRecords):
    """Give every link as many slots as it has candidates. Launch (W,)."""
    w = wp.tid()
    links = candidates.count.shape[1]
    slot = int(0)
    dropped = int(0)
    for link in range(links):
        records.start[w, link] = slot
        wanted = candidates.count[w, link]
        given = wp.min(wanted, records.capacity - slot)
        dropped += wanted - given
        slot += given
    records.start[w, links] = slot
    records.dropped[w] = records.dropped[w] + dropped


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


@wp.struct
class PastContacts:
    """Contacts of the last step, see :class:`ContactRecords`."""

    start: wp.array2d[int]  # shape (W, L + 1)
    face: wp.array[int]  # shape (W*S,)
    slide: wp.array[wp.vec3]  # [m], shape (W*S,)


@wp.func
def past_slide(past: PastContacts, face: int, link: int, w: int, capacity: int) -> wp.vec3:
    """Return the displacement that friction held between a link and a face, zero where they did not touch [m]."""
    for k in range(past.start[w, link], past.start[w, link + 1]):
        if past.face[w * capacity + k] == face:
            return past.slide[w * capacity + k]
    return wp.vec3(0.0)


@wp.kernel
def fill_slots(surface: LumenSurface, candidates: Candidates, past: PastContacts, records: ContactRecords):
    """Copy the candidates into the slots of their links. Launch (W, L + 1); the last frees what is left over.

    Args:
        surface: Inner faces of one world.
        candidates: Faces near each link.
        past: Contacts of the last step, from which friction goes on.
        records: Contacts; ``link``, ``face``, ``distance`` and ``slide`` are written.
    """
    w, link = wp.tid()
    first = w * records.capacity
    if link == candidates.count.shape[1]:
        for k in range(records.start[w, link], records.capacity):
            records.link[first + k] = -1
        return
    slot = first + records.start[w, link]
    end = first + records.start[w, link + 1]
    for m in range(candidates.patches[w, link] * candidates.patch_faces):
        d = candidates.distance[w, link, m]
        if d < FAR and slot < end:
            patch = m // candidates.patch_faces
            face = surface.patch_start[candidates.patch[w, link, patch] // 2] + m - patch * candidates.patch_faces
            records.link[slot] = link
            records.face[slot] = face
            records.distance[slot] = d
            records.slide[slot] = past_slide(past, face, link, w, records.capacity)
            slot += 1


@wp.kernel
def locate_contacts(
    x: wp.array2d[wp.vec3],
    body_q: wp.array[wp.transform],
    links: LinkShapes,
    surface: LumenSurface,
    records: ContactRecords,
):
    """Find where every recorded face comes closest to its link. Launch (W, S).

    Args:
        x: Wall positions [m], shape (V, W).
        body_q: Link poses, shape (W*L,).
        links: Capsules of one world.
        surface: Inner faces of one world.
        records: Contacts; ``corners``, ``bary``, ``weight``, ``normal`` and ``direction`` are written.
    """
    w, k = wp.tid()
    slot = w * records.capacity + k
    link = records.link[slot]
    if link < 0:
        return
    pose = body_q[w * links.radius.shape[0] + link]
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
    first = w * records.capacity
    nearest = float(FAR)
    for k in range(records.start[w, link], records.start[w, link + 1]):
        nearest = wp.min(nearest, records.distance[first + k])
    if nearest > CLEARANCE * links.radius[link]:
        for k in range(records.start[w, link], records.start[w, link + 1]):
            records.normal[first + k] = records.direction[first + k]


@wp.kernel
def build_contact_lists(vertex_ring: wp.array[int], parts: int, records: ContactRecords):
    """Link each world's records into lists by vertex and by ring, in ascending order. Launch (W, ``parts``).

    Each thread goes through all records of its world, and sees to the lists of every ``parts``-th vertex and ring. That
    keeps the order, and with it every sum over contacts, the same on CPU and GPU.

    Args:
        vertex_ring: Ring of each wall vertex, shape (V,).
        parts: Threads a world.
        records: Contacts; the lists, emptied before, are written.
    """
    w, part = wp.tid()
    first = w * records.capacity
    count = records.start[w, records.start.shape[1] - 1]
    for back in range(count):
        slot = first + count - 1 - back
        face = records.corners[slot]
        lowest = records.ring_head.shape[0]
        for k in range(3):
            v = face[k]
            lowest = wp.min(lowest, vertex_ring[v])
            if v % parts == part:
                entry = 3 * slot + k
                records.vertex_next[entry] = records.vertex_head[v, w]
                records.vertex_head[v, w] = entry
        if lowest % parts == part:
            records.ring_next[slot] = records.ring_head[lowest, w]
            records.ring_head[lowest, w] = slot
