# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Narrow phase between capsule links and the inner wall, binned along the centreline, and the contact law.

Launch dimensions: W worlds, L links a world, R rings (centreline bins), M candidate faces a link, V wall vertices.
"""

import warp as wp

from arcgym.sim.geometry_kernels import segment_parameter, segment_triangle
from arcgym.utils import warp_setup  # noqa: F401

FAR = wp.constant(1.0e9)
EDGE = wp.constant(1.0e-4)
"""Barycentric coordinate under which a point counts as on the opposite edge."""
CLEAR = wp.constant(0.5)
"""Share of its radius by which a link's axis must stay off the wall to count as inside."""


@wp.struct
class LinkShapes:
    """Capsules of one world's links, axis along the link's local Z."""

    half_length: wp.array(dtype=float)  # [m], shape (L,)
    radius: wp.array(dtype=float)  # [m], shape (L,)


@wp.struct
class LumenSurface:
    """Inner faces of one world's wall, sorted by ring; normals point from the lumen into the wall."""

    rings: wp.array2d(dtype=int)  # inner vertices of each ring, padded with the first, shape (R, S)
    faces: wp.array2d(dtype=int)  # shape (F, 3)
    neighbors: wp.array2d(dtype=int)  # face across the edge opposite to each corner or -1, shape (F, 3)
    vertex_owner: wp.array(dtype=int)  # lowest face around each wall vertex, shape (V,)
    ring_start: wp.array(dtype=int)  # first face of each ring, shape (R + 1,)
    reach: int  # rings searched on either side of a link's own


@wp.struct
class ContactRecords:
    """Contacts of every link: up to ``capacity`` slots a link, in ascending face order."""

    capacity: int
    count: wp.array(dtype=int)  # shape (W*L,)
    face: wp.array(dtype=wp.vec3i)  # the three wall vertices, shape (W*L*capacity,)
    bary: wp.array(dtype=wp.vec3)
    normal: wp.array(dtype=wp.vec3)  # outward normal of the wall there at detection
    vertex_head: wp.array2d(dtype=int)  # first entry of each vertex's list, shape (V, W); entry e = 3 * record + corner
    vertex_next: wp.array(dtype=int)  # shape (3*W*L*capacity,)
    ring_head: wp.array2d(dtype=int)  # first record whose lowest ring is this one, shape (R, W)
    ring_next: wp.array(dtype=int)  # shape (W*L*capacity,)


@wp.struct
class ContactLaw:
    """Penalty contact with regularised Coulomb friction."""

    stiffness: float  # [N/m]
    damping: float  # [N s/m], approach only
    slip_velocity: float  # speed under which friction is viscous [m/s]
    wall_radius: float  # half the skin that the wall adds to each link [m]
    search_gap: float  # distance up to which records are kept [m]
    widest: float  # links farther than this from the centre of their ring touch nothing [m]


@wp.kernel
def ring_centres(x: wp.array2d(dtype=wp.vec3), surface: LumenSurface, centres: wp.array2d(dtype=wp.vec3)):
    """Mean of each ring's inner vertices. Launch (W, R)."""
    w, r = wp.tid()
    n = surface.rings.shape[1]
    total = wp.vec3(0.0)
    for k in range(n):
        total += x[surface.rings[r, k], w]
    centres[w, r] = total / float(n)


@wp.kernel
def track_rings(
    centres: wp.array2d(dtype=wp.vec3),
    body_q: wp.array(dtype=wp.transform),
    span: int,
    ring: wp.array2d(dtype=int),
    away: wp.array2d(dtype=float),
):
    """Ring nearest to each link among ``span`` on either side of the last one, all of them where it is -1; and how far.

    Launch (W, L).
    """
    w, link = wp.tid()
    p = wp.transform_get_translation(body_q[w * ring.shape[1] + link])
    last = ring[w, link]
    lo = int(0)
    hi = centres.shape[1]
    if last >= 0:
        lo = wp.max(0, last - span)
        hi = wp.min(hi, last + span + 1)
    best = float(FAR)
    found = last
    for r in range(lo, hi):
        d = wp.length_sq(p - centres[w, r])
        if d < best:
            best = d
            found = r
    ring[w, link] = found
    away[w, link] = wp.sqrt(best)


@wp.kernel
def face_distances(
    x: wp.array2d(dtype=wp.vec3),
    body_q: wp.array(dtype=wp.transform),
    links: LinkShapes,
    surface: LumenSurface,
    law: ContactLaw,
    ring: wp.array2d(dtype=int),
    away: wp.array2d(dtype=float),
    distance: wp.array3d(dtype=float),
):
    """Distance from each link's axis to each candidate face, or FAR. Launch (W, L, M)."""
    w, link, m = wp.tid()
    if away[w, link] > law.widest + links.half_length[link] + links.radius[link]:
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
        centre = wp.transform_get_translation(pose)
        axis = wp.transform_vector(pose, wp.vec3(0.0, 0.0, links.half_length[link]))
        limit = links.radius[link] + law.wall_radius + law.search_gap
        g = (a + b + c) / 3.0
        size = wp.sqrt(wp.max(wp.length_sq(a - g), wp.max(wp.length_sq(b - g), wp.length_sq(c - g))))
        t = segment_parameter(g, centre - axis, centre + axis)
        if wp.length(g - centre - (2.0 * t - 1.0) * axis) < limit + size:
            u = segment_triangle(centre - axis, centre + axis, a, b, c)
            if u[3] < limit:
                d = u[3]
    distance[w, link, m] = d


@wp.func
def owns_contact(surface: LumenSurface, face: int, u: wp.vec3) -> bool:
    """Whether ``face`` reports a touch at barycentric ``u``; shared vertices and edges belong to the lowest face."""
    zeros = int(0)
    for k in range(3):
        if u[k] < EDGE:
            zeros += 1
    if zeros == 2:
        corner = int(0)
        if u[1] > 0.5:
            corner = 1
        if u[2] > 0.5:
            corner = 2
        return surface.vertex_owner[surface.faces[face, corner]] == face
    if zeros == 1:
        opposite = int(0)
        if u[1] < EDGE:
            opposite = 1
        if u[2] < EDGE:
            opposite = 2
        other = surface.neighbors[face, opposite]
        return other < 0 or other > face
    return True


@wp.func
def lowest_around(
    surface: LumenSurface, distance: wp.array3d(dtype=float), w: int, link: int, m: int, first: int
) -> bool:
    """Whether no neighbour of candidate face ``m`` is nearer to the link."""
    for k in range(3):
        other = surface.neighbors[first + m, k] - first
        if surface.neighbors[first + m, k] >= 0 and other >= 0 and other < distance.shape[2]:
            if distance[w, link, other] < distance[w, link, m] - 1.0e-6:
                return False
    return True


@wp.func
def side(
    x: wp.array2d(dtype=wp.vec3), surface: LumenSurface, face: int, w: int, centre: wp.vec3, axis: wp.vec3
) -> float:
    """Distance of the link's axis from the face [m], negative on the outer side of the wall."""
    a = x[surface.faces[face, 0], w]
    b = x[surface.faces[face, 1], w]
    c = x[surface.faces[face, 2], w]
    u = segment_triangle(centre - axis, centre + axis, a, b, c)
    p = u[0] * a + u[1] * b + u[2] * c
    t = segment_parameter(p, centre - axis, centre + axis)
    if wp.dot(p - centre - (2.0 * t - 1.0) * axis, wp.cross(b - a, c - a)) < 0.0:
        return -u[3]
    return u[3]


@wp.func
def face_normal(surface: LumenSurface, face: int, x: wp.array2d(dtype=wp.vec3), w: int) -> wp.vec3:
    """Unit normal of a face, from the lumen into the wall."""
    a = x[surface.faces[face, 0], w]
    return wp.normalize(wp.cross(x[surface.faces[face, 1], w] - a, x[surface.faces[face, 2], w] - a))


@wp.func
def surface_normal(surface: LumenSurface, face: int, u: wp.vec3, x: wp.array2d(dtype=wp.vec3), w: int) -> wp.vec3:
    """Normal at barycentric ``u`` of ``face``; on an edge or a corner, the mean with the faces across the edges there.

    The face's own normal may be at more than a right angle to the way off a sharp fold, and then tells the wrong side
    (Baerentzen and Aanaes 2005, "Signed distance computation using the angle weighted pseudonormal").
    """
    normal = face_normal(surface, face, x, w)
    for k in range(3):
        other = surface.neighbors[face, k]
        if u[k] < EDGE and other >= 0:
            normal += face_normal(surface, other, x, w)
    return wp.normalize(normal)


@wp.kernel
def select_contacts(
    x: wp.array2d(dtype=wp.vec3),
    body_q: wp.array(dtype=wp.transform),
    links: LinkShapes,
    surface: LumenSurface,
    ring: wp.array2d(dtype=int),
    distance: wp.array3d(dtype=float),
    records: ContactRecords,
):
    """Keep one record for each place where the link comes close. Launch (W, L).

    A closest point inside a face is one, so that a link in a corner is held by both sides; a closest point on an edge
    or a corner is one if no neighbouring face is nearer. A link that is clear of the wall on the lumen's side has not
    gone through it: what it sees from behind is the far side of a fold and no contact.
    """
    w, link = wp.tid()
    row = w * ring.shape[1] + link
    first = surface.ring_start[wp.max(0, ring[w, link] - surface.reach)]
    pose = body_q[row]
    centre = wp.transform_get_translation(pose)
    axis = wp.transform_vector(pose, wp.vec3(0.0, 0.0, links.half_length[link]))
    nearest = int(0)
    for m in range(distance.shape[2]):
        if distance[w, link, m] < distance[w, link, nearest]:
            nearest = m
    clear = bool(False)
    if distance[w, link, nearest] < FAR:
        clear = side(x, surface, first + nearest, w, centre, axis) > CLEAR * links.radius[link]
    n = int(0)
    for m in range(distance.shape[2]):
        if distance[w, link, m] < FAR and n < records.capacity:
            face = first + m
            i = surface.faces[face, 0]
            j = surface.faces[face, 1]
            k = surface.faces[face, 2]
            c = segment_triangle(centre - axis, centre + axis, x[i, w], x[j, w], x[k, w])
            u = wp.vec3(c[0], c[1], c[2])
            near = wp.min(u) > EDGE
            if not near:
                near = lowest_around(surface, distance, w, link, m, first) and owns_contact(surface, face, u)
            if near and not (clear and side(x, surface, face, w, centre, axis) < 0.0):
                slot = row * records.capacity + n
                records.face[slot] = wp.vec3i(i, j, k)
                records.bary[slot] = u
                records.normal[slot] = surface_normal(surface, face, u, x, w)
                n += 1
    records.count[row] = n


@wp.kernel
def build_lists(vertex_ring: wp.array(dtype=int), links: int, records: ContactRecords):
    """Thread each world's records into lists by vertex and by ring, in ascending order. Launch (W,).

    One thread a world keeps the order, and with it every sum over contacts, the same on CPU and GPU.
    """
    w = wp.tid()
    for step in range(links):
        row = (w + 1) * links - 1 - step
        n = records.count[row]
        for back in range(n):
            slot = row * records.capacity + n - 1 - back
            face = records.face[slot]
            lowest = records.ring_head.shape[0]
            for k in range(3):
                entry = 3 * slot + k
                v = face[k]
                records.vertex_next[entry] = records.vertex_head[v, w]
                records.vertex_head[v, w] = entry
                lowest = wp.min(lowest, vertex_ring[v])
            records.ring_next[slot] = records.ring_head[lowest, w]
            records.ring_head[lowest, w] = slot


@wp.struct
class Touch:
    """Gap [m] (negative inside), unit normal from the scope into the wall, and axis point of one contact."""

    gap: float
    normal: wp.vec3


@wp.func
def touch(p: wp.vec3, wall_normal: wp.vec3, pose: wp.transform, half_length: float, radius: float) -> Touch:
    """Signed gap of wall point ``p`` to a capsule.

    A point on the lumen side of the axis, judged by the wall's own normal, counts as behind it: the gap is then
    negative however far the link has gone through, so that a link is always pushed back inside.
    """
    centre = wp.transform_get_translation(pose)
    axis = wp.transform_vector(pose, wp.vec3(0.0, 0.0, half_length))
    t = segment_parameter(p, centre - axis, centre + axis)
    r = p - centre - (2.0 * t - 1.0) * axis
    d = wp.length(r)
    out = Touch()
    out.normal = wall_normal
    if d > 1.0e-6:
        out.normal = r / d
    if wp.dot(out.normal, wall_normal) < 0.0:
        out.normal = -out.normal
        d = -d
    out.gap = d - radius
    return out


@wp.func
def slip_scale(speed: float, limit: float) -> float:
    """1/speed above ``limit``, smoothly bounded below it: friction = mu N * scale * slip (Li et al. 2020, IPC)."""
    if speed > limit:
        return 1.0 / speed
    return (2.0 - speed / limit) / limit
