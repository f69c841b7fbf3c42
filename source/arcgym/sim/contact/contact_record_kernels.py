# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Records of the contacts that the search has found: slots, closest points, lists by vertex and by ring.

W worlds, L links a world, S contact slots a world, V wall vertices.
"""

import warp as wp

from arcgym.sim.contact.contact_kernels import CLEARANCE, ContactRecords, LinkShapes
from arcgym.sim.contact.contact_search_kernels import FAR, Candidates, LumenSurface
from arcgym.sim.geometry_kernels import corner_point, segment_parameter, segment_triangle_mean
from arcgym.utils import warp_setup  # noqa: F401

SMOOTHING = wp.constant(5.0e-5)
"""Length over which the contact point is a mean of a face's nearest points, weighted by exp(-distance / length) [m]."""
EDGE_BAND = wp.constant(0.1)
"""Barycentric coordinate under which the face across the opposite edge takes part in a contact."""
EDGE_WEIGHT = wp.constant(0.45)
"""Weight of a contact for each edge that it lies on: two faces touch it there, and about six at a corner."""


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
