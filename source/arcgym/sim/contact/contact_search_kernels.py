# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Contact search between capsule links and the inner wall, by distance: rings, then patches, then faces.

W worlds, L links a world, R rings (centerline bins), P patches of faces, Q pairs of a link and a patch a world, F faces
a patch, V wall vertices.
"""

import warp as wp

from arcgym.sim.contact.contact_kernels import ContactLaw, LinkShapes
from arcgym.sim.contact.lumen_kernels import FAR, Bounds, LumenSurface, sphere_reached
from arcgym.sim.geometry_kernels import segment_parameter, segment_triangle, triangle_point
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.block_queue_kernels import clear_queue, queue_entry, queue_length, queued, wait_for_block
from arcgym.utils.block_store_kernels import store_points, stored_point
from arcgym.utils.on_cpu_kernels import on_cpu


@wp.struct
class Candidates:
    """Pairs of a link and a patch near it, by link, up to Q a world, and the distances of the patches' faces."""

    capacity: int  # pairs of a world, Q
    patch_faces: int  # faces of a patch, F
    rings: wp.array2d[wp.vec2i]  # first ring that comes near each link, and the one after the last, shape (W, L)
    patches: wp.array2d[int]  # patches near each link, also those that found no room, shape (W, L)
    start: wp.array2d[int]  # first pair of each link, and of none after the last, shape (W, L + 1)
    link: wp.array2d[int]  # shape (W, Q)
    patch: wp.array2d[int]  # twice the patch, and 1 more where its faces count from either side, shape (W, Q)
    distance: wp.array3d[float]  # of the patch's faces from the link's axis, FAR for none [m], shape (W, Q, F)
    faces: wp.array2d[int]  # faces of each pair that are near; then those of the link's pairs before it, shape (W, Q)
    count: wp.array2d[int]  # faces near each link, shape (W, L)
    nearest: wp.array2d[float]  # least distance of them, FAR for none [m], shape (W, L)


@wp.func
def plane_reached(a: wp.vec3, normal: wp.vec3, axis: wp.vec3, limit: float) -> bool:
    """Return whether the plane through ``a`` comes within ``limit`` of the segment from ``-axis`` to ``axis``."""
    gap = wp.abs(wp.dot(normal, a)) - wp.abs(wp.dot(normal, axis))
    return gap <= 0.0 or gap * gap <= limit * limit * wp.length_sq(normal)


@wp.func
def inside_triangle(p: wp.vec3, a: wp.vec3, b: wp.vec3, c: wp.vec3, normal: wp.vec3) -> bool:
    """Return whether a point in the plane of triangle ``abc`` lies inside it."""
    return (
        wp.dot(wp.cross(b - a, p - a), normal) >= 0.0
        and wp.dot(wp.cross(c - b, p - b), normal) >= 0.0
        and wp.dot(wp.cross(a - c, p - c), normal) >= 0.0
    )


@wp.func
def on_lumen_side(a: wp.vec3, b: wp.vec3, c: wp.vec3, normal: wp.vec3, near: wp.vec3, axis: wp.vec3) -> bool:
    """Return whether triangle ``abc`` has the segment from ``-axis`` to ``axis`` on its lumen's side.

    The point of the segment that is nearest to ``near``, the nearest point of the triangle, decides; where the segment
    goes through the triangle, its middle does.
    """
    one = wp.dot(normal, a + axis)
    other = wp.dot(normal, a - axis)
    if one > 0.0 and other > 0.0:
        return True
    if one * other < 0.0:
        crossing = ((one + other) / (one - other)) * axis
        if inside_triangle(crossing, a, b, c, normal):
            return wp.dot(normal, a) > 0.0
    t = segment_parameter(near, -axis, axis)
    return wp.dot(normal, a - (2.0 * t - 1.0) * axis) > 0.0


@wp.func
def slab_reached(a: wp.vec3, b: wp.vec3, c: wp.vec3, axis: wp.vec3, limit: float) -> bool:
    """Return whether triangle ``abc`` is within ``limit`` of the segment from ``-axis`` to ``axis`` along that axis.

    A thousandth more, so that rounding rejects nothing that is near.
    """
    reach = wp.length_sq(axis) + 1.001 * limit * wp.length(axis)
    one = wp.dot(a, axis)
    two = wp.dot(b, axis)
    three = wp.dot(c, axis)
    return wp.min(one, wp.min(two, three)) <= reach and wp.max(one, wp.max(two, three)) >= -reach


@wp.func
def beyond_reach(a: wp.vec3, b: wp.vec3, c: wp.vec3, axis: wp.vec3, limit: float) -> bool:
    """Return whether triangle ``abc`` is all farther than ``limit`` from the segment from ``-axis`` to ``axis``.

    Told by the plane across the way from the segment to the triangle's middle, if it lies between them; a two
    thousandth farther, so that rounding rejects nothing that is near.
    """
    middle = (a + b + c) / 3.0
    t = wp.clamp(wp.dot(middle, axis) / wp.max(wp.length_sq(axis), 1.0e-12), -1.0, 1.0)
    away = middle - t * axis
    nearest = wp.min(wp.dot(away, a), wp.min(wp.dot(away, b), wp.dot(away, c)))
    gap = nearest - wp.abs(wp.dot(away, axis))
    return gap > 0.0 and gap * gap > 1.001 * limit * limit * wp.length_sq(away)


@wp.struct
class LinkReach:
    """Axis of a link and how far its contacts reach."""

    center: wp.vec3  # [m]
    axis: wp.vec3  # half of it [m]
    limit: float  # distance from the axis up to which contacts are kept [m]


@wp.func
def face_corner(surface: LumenSurface, face: int, k: int, x: wp.array2d[wp.vec3], w: int, center: wp.vec3) -> wp.vec3:
    """Return corner ``k`` of a face from ``center`` [m]."""
    return stored_point(x, surface.faces[face, k], w) - center


@wp.func
def face_may_be_near(
    surface: LumenSurface, face: int, x: wp.array2d[wp.vec3], w: int, link: LinkReach, both_sides: bool
) -> bool:
    """Return whether a face may have a :func:`face_distance` from the link, by quick tests of its plane and extent.

    On a CPU one test more spares distances that would be measured in vain.
    """
    a = face_corner(surface, face, 0, x, w, link.center)
    b = face_corner(surface, face, 1, x, w, link.center)
    c = face_corner(surface, face, 2, x, w, link.center)
    normal = wp.cross(b - a, c - a)
    behind = wp.dot(normal, a) + wp.abs(wp.dot(normal, link.axis)) <= 0.0
    if behind and not both_sides:
        return False
    if not plane_reached(a, normal, link.axis, link.limit) or not slab_reached(a, b, c, link.axis, link.limit):
        return False
    return not (on_cpu() and beyond_reach(a, b, c, link.axis, link.limit))


@wp.func
def face_distance(
    surface: LumenSurface, face: int, x: wp.array2d[wp.vec3], w: int, link: LinkReach, both_sides: bool
) -> float:
    """Return the distance of a face from the link's axis [m].

    FAR beyond the link's reach, and where the axis is not on the lumen's side unless ``both_sides``.
    """
    a = face_corner(surface, face, 0, x, w, link.center)
    b = face_corner(surface, face, 1, x, w, link.center)
    c = face_corner(surface, face, 2, x, w, link.center)
    u = segment_triangle(-link.axis, link.axis, a, b, c)
    if u[3] < link.limit:
        near = triangle_point(a, b, c, wp.vec3(u[0], u[1], u[2]))
        if both_sides or on_lumen_side(a, b, c, wp.cross(b - a, c - a), near, link.axis):
            return u[3]
    return FAR


@wp.func
def link_axis(body_q: wp.array[wp.transform], row: int, half_length: float) -> wp.vec3:
    """Half the axis of the link in ``row`` [m]."""
    return wp.transform_vector(body_q[row], wp.vec3(0.0, 0.0, half_length))


@wp.func
def sum_before(counts: wp.array2d[int], w: int, link: int) -> int:
    """Return the sum of a world's ``counts``, shape (W, L), over the links before ``link``."""
    total = int(0)
    for k in range(link):
        total += counts[w, k]
    return total


@wp.func
def surely_beyond(sphere: wp.vec4, center: wp.vec3, half_length: float, limit: float) -> bool:
    """Return whether a sphere is so far from ``center`` that it is not :func:`sphere_reached`, whatever the axis."""
    reach = half_length + limit + sphere[3]
    return wp.length_sq(wp.vec3(sphere[0], sphere[1], sphere[2]) - center) > 1.001 * reach * reach


@wp.kernel
def list_patches(
    body_q: wp.array[wp.transform],
    links: LinkShapes,
    surface: LumenSurface,
    bounds: Bounds,
    law: ContactLaw,
    ring: wp.array2d[int],
    ring_distance: wp.array2d[float],
    candidates: Candidates,
    dropped: wp.array[int],
):
    """List the patches near each link, wherever along the colon they are, in ascending order. Launch (W,).

    Args:
        body_q: Link poses, shape (W*L,).
        links: Capsules of one world.
        surface: Inner faces of one world.
        bounds: Spheres around rings and patches.
        law: Contact law.
        ring: Ring of each link, shape (W, L).
        ring_distance: Distance from the center of the link's ring, FAR for links outside the anus [m], shape (W, L).
        candidates: ``patches``, ``rings``, ``start``, ``link`` and ``patch`` are written.
        dropped: Contacts that found no room, shape (W,); the faces of patches that found none are added to it.
    """
    w = wp.tid()
    wanted = int(0)
    for link in range(ring.shape[1]):
        before = int(wanted)
        rings = wp.vec2i(0, 0)
        if ring_distance[w, link] < FAR:
            row = w * ring.shape[1] + link
            center = wp.transform_get_translation(body_q[row])
            axis = link_axis(body_q, row, links.half_length[link])
            limit = links.radius[link] + law.wall_radius + law.search_gap
            for r in range(bounds.ring.shape[0]):
                around = bounds.ring[r, w]
                if not surely_beyond(around, center, links.half_length[link], limit):
                    if sphere_reached(around, center, axis, limit):
                        rings = wp.vec2i(wp.where(rings[1] == 0, r, rings[0]), r + 1)
                        both_sides = int(wp.abs(r - ring[w, link]) <= surface.reach)
                        for p in range(surface.ring_patch[r], surface.ring_patch[r + 1]):
                            if sphere_reached(bounds.patch[p, w], center, axis, limit):
                                if wanted < candidates.capacity:
                                    candidates.link[w, wanted] = link
                                    candidates.patch[w, wanted] = 2 * p + both_sides
                                wanted += 1
        candidates.rings[w, link] = rings
        candidates.patches[w, link] = wanted - before
        candidates.start[w, link] = wp.min(before, candidates.capacity)
    end = wp.min(wanted, candidates.capacity)
    candidates.start[w, ring.shape[1]] = end
    dropped[w] = dropped[w] + (wanted - end) * candidates.patch_faces


@wp.func
def pair_reach(
    candidates: Candidates, k: int, w: int, body_q: wp.array[wp.transform], links: LinkShapes, law: ContactLaw
) -> LinkReach:
    """Return the reach of the link of pair ``k``."""
    link = candidates.link[w, k]
    row = w * links.radius.shape[0] + link
    out = LinkReach()
    out.center = wp.transform_get_translation(body_q[row])
    out.axis = link_axis(body_q, row, links.half_length[link])
    out.limit = links.radius[link] + law.wall_radius + law.search_gap
    return out


@wp.func
def measure_faces(
    x: wp.array2d[wp.vec3],
    body_q: wp.array[wp.transform],
    links: LinkShapes,
    surface: LumenSurface,
    law: ContactLaw,
    w: int,
    thread: int,
    threads: int,
    candidates: Candidates,
):
    """Measure the distances of the faces of a world's pairs; all threads of the world have to call it.

    Far along the colon from the link's own ring, faces count that have the link on their lumen's side: the wall
    gathered around the link, but not the outside of a neighboring loop.
    """
    pairs = candidates.start[w, links.radius.shape[0]]
    store_points(x, w, thread, threads)
    clear_queue(thread)
    k = int(thread)
    while k < pairs:
        reach = pair_reach(candidates, k, w, body_q, links, law)
        code = candidates.patch[w, k]
        first = surface.patch_start[code // 2]
        size = surface.patch_start[code // 2 + 1] - first
        for m in range(candidates.patch_faces):
            d = float(FAR)
            if m < size and face_may_be_near(surface, first + m, x, w, reach, code % 2 == 1):
                if not queued(k * candidates.patch_faces + m):
                    d = face_distance(surface, first + m, x, w, reach, code % 2 == 1)
            candidates.distance[w, k, m] = d
        k += threads
    wait_for_block()
    entry = int(thread)
    while entry < queue_length():
        k = queue_entry(entry) // candidates.patch_faces
        m = queue_entry(entry) - k * candidates.patch_faces
        reach = pair_reach(candidates, k, w, body_q, links, law)
        code = candidates.patch[w, k]
        face = surface.patch_start[code // 2] + m
        candidates.distance[w, k, m] = face_distance(surface, face, x, w, reach, code % 2 == 1)
        entry += threads
    wait_for_block()


@wp.func
def count_pair(k: int, w: int, candidates: Candidates):
    """Count the faces of a pair that are near."""
    n = int(0)
    for m in range(candidates.patch_faces):
        n += int(candidates.distance[w, k, m] < FAR)
    candidates.faces[w, k] = n


@wp.func
def count_link(link: int, w: int, candidates: Candidates):
    """Count the faces near a link, also those before each of its pairs, and find the nearest."""
    n = int(0)
    nearest = float(FAR)
    for k in range(candidates.start[w, link], candidates.start[w, link + 1]):
        faces = candidates.faces[w, k]
        candidates.faces[w, k] = n
        n += faces
        if faces > 0:
            for m in range(candidates.patch_faces):
                nearest = wp.min(nearest, candidates.distance[w, k, m])
    candidates.count[w, link] = n
    candidates.nearest[w, link] = nearest
