# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Faces that links may touch: their surface, spheres around its rings and patches, and the ring of each link.

W worlds, L links a world, R rings (centerline bins), P patches of faces, F faces, V wall vertices.
"""

import warp as wp

from arcgym.sim.geometry_kernels import segment_parameter
from arcgym.utils import warp_setup  # noqa: F401

FAR = wp.constant(1.0e9)
"""Distance of where no wall was found [m]."""


@wp.struct
class LumenSurface:
    """Inner faces of one world's wall, or of a fine surface that it carries, sorted by ring.

    Normals point from the lumen into the wall.
    """

    rings: wp.array2d[int]  # inner vertices of each ring, padded with the first, shape (R, S)
    faces: wp.array2d[int]  # vertices of the wall or of the fine surface, shape (F, 3)
    ring: wp.array[int]  # lowest ring of each face's vertices, shape (F,)
    carried: int  # 1 for a fine surface that the wall carries, 0 for the wall's own faces
    carriers: wp.array[wp.vec4i]  # wall vertices that carry each face of a fine surface, shape (F,)
    weights: wp.array2d[wp.vec4]  # their weights in each of its corners, shape (F, 3)
    neighbors: wp.array2d[int]  # face across the edge opposite to each corner or -1, shape (F, 3)
    patch_start: wp.array[int]  # first face of each patch, shape (P + 1,)
    ring_patch: wp.array[int]  # first patch of each ring, shape (R + 1,)
    patch_vertices: wp.array2d[int]  # these vertices of each patch, padded with its first, shape (P, K)
    reach: int  # rings on either side of a link's own whose faces may touch it from outside, too


@wp.struct
class Bounds:
    """Spheres around the faces of each patch and of each ring: center [m] and radius [m]."""

    patch: wp.array2d[wp.vec4]  # shape (P, W)
    ring: wp.array2d[wp.vec4]  # shape (R, W)
    patch_of_world: wp.array2d[wp.vec4]  # the same on a GPU, whose warps read those of one world, shape (W, P)
    ring_of_world: wp.array2d[wp.vec4]  # shape (W, R)


@wp.kernel
def ring_centers(x: wp.array2d[wp.vec3], surface: LumenSurface, centers: wp.array2d[wp.vec3]):
    """Compute the mean of each ring's inner vertices. Launch (R, W).

    Args:
        x: Wall positions [m], shape (V, W).
        surface: Inner faces of one world.
        centers: Ring centers [m], shape (W, R); written.
    """
    r, w = wp.tid()
    n = surface.rings.shape[1]
    total = wp.vec3(0.0)
    for k in range(n):
        total += x[surface.rings[r, k], w]
    centers[w, r] = total / float(n)


@wp.kernel
def follow_rings(
    x: wp.array2d[wp.vec3],
    surface: LumenSurface,
    slack: float,
    centers: wp.array2d[wp.vec3],
    place: wp.array2d[wp.vec3],
    moved: wp.array2d[int],
):
    """Do as ``ring_centers``, and find the rings of which a vertex has moved on by the slack. Launch (R, W).

    Args:
        x: Wall positions [m], shape (V, W).
        surface: Inner faces of one world.
        slack: How far a vertex may have moved in a ring that counts as not moved [m].
        centers: Ring centers [m], shape (W, R); written.
        place: Where the vertices were when the ring had last moved [m], shape (V, W); updated.
        moved: 1 where the ring has moved, else 0, shape (R, W); written.
    """
    r, w = wp.tid()
    n = surface.rings.shape[1]
    total = wp.vec3(0.0)
    stays = bool(True)
    for k in range(n):
        i = surface.rings[r, k]
        here = x[i, w]
        total += here
        stays = stays and wp.length_sq(here - place[i, w]) <= slack * slack  # not of places that are no numbers
    centers[w, r] = total / float(n)
    moved[r, w] = int(not stays)
    if not stays:
        for k in range(n):
            i = surface.rings[r, k]
            place[i, w] = x[i, w]


@wp.kernel
def track_rings(
    centers: wp.array2d[wp.vec3],
    body_q: wp.array[wp.transform],
    max_shift: int,
    world_mask: wp.array[wp.bool],
    before: wp.array2d[int],
    ring: wp.array2d[int],
    ring_distance: wp.array2d[float],
):
    """Find the ring nearest to each link, and its distance [m]. Launch (W, L).

    Searches ``max_shift`` rings on either side of the last one, and all of them where it is -1. Where the next link
    towards the base was farther off than that, the rings around it are searched as well: the nearest ring within reach
    may be no nearer than the last one, though the link has long gone on through a bend, and a link would then be held
    to be there for good.

    A link whose center is outside the anus, before the first ring, is at distance FAR: the wall has no outer surface.

    Args:
        centers: Ring centers [m], shape (W, R).
        body_q: Link poses, shape (W*L,).
        max_shift: Rings that a link may cross since the last call.
        world_mask: Worlds to look at, shape (W,).
        before: Ring of each link at the last call or -1, shape (W, L).
        ring: Ring of each link, shape (W, L); written.
        ring_distance: Distance from its center [m], shape (W, L); written.
    """
    w, link = wp.tid()
    if not world_mask[w]:
        return
    p = wp.transform_get_translation(body_q[w * ring.shape[1] + link])
    last = before[w, link]
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
    neighbor = before[w, wp.max(link - 1, 0)]
    if last >= 0 and neighbor >= 0 and wp.abs(neighbor - last) > max_shift:
        for r in range(wp.max(0, neighbor - max_shift), wp.min(centers.shape[1], neighbor + max_shift + 1)):
            d = wp.length_sq(p - centers[w, r])
            if d < best:
                best = d
                found = r
    ring[w, link] = found
    ring_distance[w, link] = wp.sqrt(best)
    if found == 0 and wp.dot(p - centers[w, 0], centers[w, 1] - centers[w, 0]) < 0.0:
        ring_distance[w, link] = FAR


@wp.func
def write_ring(bounds: Bounds, r: int, w: int, sphere: wp.vec4):
    """Write the sphere around ring ``r`` of world ``w``."""
    bounds.ring[r, w] = sphere
    if bounds.ring_of_world.shape[0] > 0:
        bounds.ring_of_world[w, r] = sphere


@wp.func
def bound_ring(x: wp.array2d[wp.vec3], surface: LumenSurface, bounds: Bounds, slack: float, r: int, w: int):
    """Enclose the faces of ring ``r`` of world ``w``, patch by patch, in spheres larger by ``slack`` [m]."""
    first = surface.ring_patch[r]
    last = surface.ring_patch[r + 1]
    middle = wp.vec3(0.0)
    for p in range(first, last):
        center = wp.vec3(0.0)
        vertices = surface.patch_vertices.shape[1]
        for k in range(vertices):
            center += x[surface.patch_vertices[p, k], w]
        center = center / float(vertices)
        radius = float(0.0)
        for k in range(vertices):
            radius = wp.max(radius, wp.length_sq(x[surface.patch_vertices[p, k], w] - center))
        around = wp.vec4(center[0], center[1], center[2], wp.sqrt(radius) + slack)
        bounds.patch[p, w] = around
        if bounds.patch_of_world.shape[0] > 0:
            bounds.patch_of_world[w, p] = around
        middle += center
    middle = middle / float(wp.max(1, last - first))
    radius = float(0.0)
    for p in range(first, last):
        sphere = bounds.patch[p, w]
        radius = wp.max(radius, wp.length(wp.vec3(sphere[0], sphere[1], sphere[2]) - middle) + sphere[3])
    write_ring(bounds, r, w, wp.vec4(middle[0], middle[1], middle[2], radius))


@wp.kernel
def bound_faces(x: wp.array2d[wp.vec3], surface: LumenSurface, bounds: Bounds):
    """Enclose the faces of each ring, patch by patch. Launch (R, W)."""
    r, w = wp.tid()
    bound_ring(x, surface, bounds, 0.0, r, w)


@wp.kernel
def bound_moved_faces(
    x: wp.array2d[wp.vec3], surface: LumenSurface, moved: wp.array2d[int], slack: float, bounds: Bounds
):
    """Enclose the faces of each ring of which a vertex has ``moved``, shape (R, W), by ``slack`` [m]. Launch (R, W).

    The spheres are larger by the slack: they hold the faces until then.
    """
    r, w = wp.tid()
    if moved[r, w] == 1 or moved[wp.min(r + 1, moved.shape[0] - 1), w] == 1:
        bound_ring(x, surface, bounds, slack, r, w)


@wp.func
def sphere_reached(sphere: wp.vec4, center: wp.vec3, axis: wp.vec3, limit: float) -> bool:
    """Whether a sphere comes within ``limit`` of the segment from ``center`` - ``axis`` to ``center`` + ``axis``."""
    p = wp.vec3(sphere[0], sphere[1], sphere[2])
    t = segment_parameter(p, center - axis, center + axis)
    reach = limit + sphere[3]
    return wp.length_sq(p - center - (2.0 * t - 1.0) * axis) < reach * reach
