# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Records of the contacts that the search has found: slots and closest points.

W worlds, L links a world, S contact slots a world, V wall vertices.
"""

import warp as wp

from arcgym.sim.contact.contact_kernels import (
    BEHIND_REACH,
    CLEARANCE,
    ContactLaw,
    ContactRecords,
    LinkShapes,
    carried,
    softness,
)
from arcgym.sim.contact.contact_search_kernels import Candidates, count_link, count_pair, measure_faces, sum_before
from arcgym.sim.contact.lumen_kernels import FAR, LumenSurface
from arcgym.sim.geometry_kernels import corner_point, segment_parameter, segment_triangle_mean
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.block_queue_kernels import wait_for_block
from arcgym.utils.warp_setup import FAST

SMOOTHING = wp.constant(5.0e-5)
"""Length over which the contact point is a mean of a face's nearest points, weighted by exp(-distance / length) [m]."""
EDGE_BAND = wp.constant(0.1)
"""Barycentric coordinate under which the face across the opposite edge takes part in a contact."""
EDGE_WEIGHT = wp.constant(0.45)
"""Weight of a contact for each edge that it lies on: two faces touch it there, and about six at a corner."""


@wp.func
def allot_slots(link: int, w: int, candidates: Candidates, records: ContactRecords):
    """Give a link as many slots as it has candidates, after those of the links before."""
    before = sum_before(candidates.count, w, link)
    records.start[w, link] = wp.min(before, records.capacity)
    if link == candidates.count.shape[1] - 1:
        wanted = before + candidates.count[w, link]
        given = wp.min(wanted, records.capacity)
        records.start[w, link + 1] = given
        records.dropped[w] = records.dropped[w] + wanted - given


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
def side_normal(point: ClosestPoint, distance: float, nearest: float, radius: float) -> wp.vec3:
    """Return the normal that tells on which side of a face a link is, see ``contact_geometry``.

    That of the wall if the link may have gone through the face, else the direction to it: the link is then in front of
    the face whichever way it turns. Where a wall is crumpled, a link has one fold at its axis and others around it,
    whose far sides are towards it: taken for faces that it went through, they threw it about with hundreds of newtons.

    Args:
        point: Closest point of the face.
        distance: Distance of the face from the link's axis [m].
        nearest: Least distance of a face from it [m].
        radius: Radius of the link [m].
    """
    if nearest > CLEARANCE * radius or distance > BEHIND_REACH * radius:
        return point.direction
    return point.normal


@wp.struct
class PastContacts:
    """Contacts of the last step, see :class:`ContactRecords`."""

    start: wp.array2d[int]  # shape (W, L + 1)
    face: wp.array[int]  # shape (W*S,)
    slide: wp.array[wp.vec3]  # [m], shape (W*S,)


@wp.kernel
def keep_past(records: ContactRecords, past: PastContacts):
    """Keep a copy of each world's contacts before they are found anew. Launch (W, T)."""
    w, thread = wp.tid()
    links = records.start.shape[1] - 1
    link = int(thread)
    while link <= links:
        past.start[w, link] = records.start[w, link]
        link += records.threads
    slot = w * records.capacity + thread
    end = w * records.capacity + records.start[w, links]
    while slot < end:
        past.face[slot] = records.face[slot]
        past.slide[slot] = records.slide[slot]
        slot += records.threads


@wp.func
def past_slide(past: PastContacts, face: int, link: int, w: int, capacity: int) -> wp.vec3:
    """Return the displacement that friction held between a link and a face, zero where they did not touch [m].

    The faces of a link are in ascending order.
    """
    low = past.start[w, link]
    high = past.start[w, link + 1]
    while low < high:
        middle = (low + high) // 2
        if past.face[w * capacity + middle] < face:
            low = middle + 1
        else:
            high = middle
    if low < past.start[w, link + 1] and past.face[w * capacity + low] == face:
        return past.slide[w * capacity + low]
    return wp.vec3(0.0)


@wp.func
def fill_slots(k: int, w: int, surface: LumenSurface, candidates: Candidates, records: ContactRecords):
    """Copy the faces of a pair that are near into the slots of its link."""
    link = candidates.link[w, k]
    slot = records.start[w, link] + candidates.faces[w, k]
    for m in range(candidates.patch_faces):
        d = candidates.distance[w, k, m]
        if d < FAR and slot < records.start[w, link + 1]:
            at = w * records.capacity + slot
            records.link[at] = link
            records.face[at] = surface.patch_start[candidates.patch[w, k] // 2] + m
            records.distance[at] = d
            slot += 1


@wp.kernel(launch_bounds=(256, 3), module="unique", module_options=FAST)
def record_faces(
    x: wp.array2d[wp.vec3],
    body_q: wp.array[wp.transform],
    links: LinkShapes,
    surface: LumenSurface,
    law: ContactLaw,
    candidates: Candidates,
    records: ContactRecords,
):
    """Give each face near a link a slot, link after link, in ascending order. Launch (W, T).

    The T threads of a world share each part of the work out. On a GPU they are one block; they list the faces that
    quick tests leave, a quarter of all, and share those out, so that all threads of a warp have one to measure.

    Args:
        x: Vertices of the surface [m], shape (V, W).
        body_q: Link poses, shape (W*L,).
        links: Capsules of one world.
        surface: Inner faces of one world.
        law: Contact law.
        candidates: Patches near each link; all but them is written.
        records: Contacts; ``start``, ``link``, ``face`` and ``distance`` are written.
    """
    w, thread = wp.tid()
    threads = records.threads
    count = links.radius.shape[0]
    measure_faces(x, body_q, links, surface, law, w, thread, threads, candidates)
    k = int(thread)
    while k < candidates.start[w, count]:
        count_pair(k, w, candidates)
        k += threads
    wait_for_block()
    link = int(thread)
    while link < count:
        count_link(link, w, candidates)
        link += threads
    wait_for_block()
    link = int(thread)
    while link < count:
        allot_slots(link, w, candidates, records)
        link += threads
    wait_for_block()
    k = int(thread)
    while k < candidates.start[w, count]:
        fill_slots(k, w, surface, candidates, records)
        k += threads


@wp.func
def locate_contact(
    slot: int,
    w: int,
    x: wp.array2d[wp.vec3],
    points: wp.array2d[wp.vec3],
    body_q: wp.array[wp.transform],
    links: LinkShapes,
    surface: LumenSurface,
    nearest: wp.array2d[float],
    past: PastContacts,
    law: ContactLaw,
    moduli: wp.array[wp.vec3],
    records: ContactRecords,
):
    """Find point, weight and normal of the record in ``slot``, see :func:`locate_contacts`."""
    link = records.link[slot]
    pose = body_q[w * links.radius.shape[0] + link]
    center = wp.transform_get_translation(pose)
    axis = wp.transform_vector(pose, wp.vec3(0.0, 0.0, links.half_length[link]))
    face = records.face[slot]
    point = closest_point(surface, face, points, w, center, axis, records.distance[slot])
    u = point.bary
    corners = face_corners(surface, face)
    carriers = wp.vec4i(corners[0], corners[1], corners[2], corners[2])
    weights = wp.vec4(u[0], u[1], u[2], 0.0)
    offset = wp.vec3(0.0)
    entries = int(3)
    if surface.carried == 1:
        carriers = surface.carriers[face]
        weights = u[0] * surface.weights[face, 0] + u[1] * surface.weights[face, 1] + u[2] * surface.weights[face, 2]
        offset = corner_point(points, corners, u, w) - carried(x, carriers, weights, w)
        entries = 4
    records.corners[slot] = carriers
    records.bary[slot] = weights
    records.offset[slot] = offset
    for c in range(entries):
        records.vertex_next[4 * slot + c] = wp.atomic_exch(records.vertex_head, carriers[c], w, 4 * slot + c)
    records.ring[slot] = surface.ring[face]
    edges = edge_proximity(u[0]) + edge_proximity(u[1]) + edge_proximity(u[2])
    records.weight[slot] = softness(law, moduli[w]) * wp.pow(EDGE_WEIGHT, edges)
    records.normal[slot] = side_normal(point, records.distance[slot], nearest[w, link], links.radius[link])
    records.slide[slot] = past_slide(past, face, link, w, records.capacity)


@wp.kernel(module="unique", module_options=FAST)
def locate_contacts(
    x: wp.array2d[wp.vec3],
    points: wp.array2d[wp.vec3],
    body_q: wp.array[wp.transform],
    links: LinkShapes,
    surface: LumenSurface,
    nearest: wp.array2d[float],
    past: PastContacts,
    law: ContactLaw,
    moduli: wp.array[wp.vec3],
    records: ContactRecords,
):
    """Find point, weight and normal of each record, and what friction holds there. Launch (W, T).

    A link whose axis is clear of the wall has not gone through and will not in this step. Its contacts push along the
    directions to them, so that the far side of a fold, whose normal points away from the link, pushes it back, too.

    Args:
        x: Wall positions [m], shape (V, W).
        points: Vertices of the surface that links touch: the wall's, or those of a fine surface [m], shape (M, W).
        body_q: Link poses, shape (W*L,).
        links: Capsules of one world.
        surface: Inner faces of one world.
        nearest: Distance of each link's axis from the wall [m], shape (W, L).
        past: Contacts of the last step, from which friction goes on.
        law: Contact law.
        moduli: Elastic moduli of each world's wall, shape (W,).
        records: Contacts; all but ``start``, ``link``, ``face`` and ``distance`` is written.
            The lists by vertex, emptied before, get entries in any order.
    """
    w, thread = wp.tid()
    slot = w * records.capacity + thread
    end = w * records.capacity + records.start[w, links.radius.shape[0]]
    while slot < end:
        locate_contact(slot, w, x, points, body_q, links, surface, nearest, past, law, moduli, records)
        slot += records.threads
