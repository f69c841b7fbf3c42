# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Patches near each link on a GPU: what ``list_patches`` does, by a warp a link.

One thread a link leaves most of a GPU idle, and each waits for the spheres of all rings, one after the other. The
threads of a warp test as many spheres at a time; their votes tell where each has to write.
"""

import warp as wp

from arcgym.sim.contact.contact_kernels import ContactLaw, LinkShapes
from arcgym.sim.contact.contact_search_kernels import Candidates, LinkReach, link_axis
from arcgym.sim.contact.lumen_kernels import FAR, Bounds, LumenSurface, sphere_reached
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.block_queue_kernels import wait_for_block
from arcgym.utils.warp_setup import FAST
from arcgym.utils.warp_vote_kernels import first_vote, last_vote, vote_count, votes, votes_before, warp_sum


@wp.func
def link_reach(link: int, w: int, body_q: wp.array[wp.transform], links: LinkShapes, law: ContactLaw) -> LinkReach:
    """Return how far the contacts of a link reach."""
    row = w * links.radius.shape[0] + link
    out = LinkReach()
    out.center = wp.transform_get_translation(body_q[row])
    out.axis = link_axis(body_q, row, links.half_length[link])
    out.limit = links.radius[link] + law.wall_radius + law.search_gap
    return out


@wp.func
def near_patch(bounds: Bounds, p: int, end: int, w: int, reach: LinkReach) -> bool:
    """Return whether patch ``p``, if it is before ``end``, is within a link's reach."""
    if p < end:
        return sphere_reached(bounds.patch_of_world[w, p], reach.center, reach.axis, reach.limit)
    return False


@wp.func
def near_rings(bounds: Bounds, w: int, lane: int, lanes: int, reach: LinkReach) -> wp.vec2i:
    """Return the first ring within a link's reach, and the one after the last; twice 0 for none."""
    out = wp.vec2i(0, 0)
    r = int(0)
    while r < bounds.ring_of_world.shape[1]:
        near = bool(False)
        if r + lane < bounds.ring_of_world.shape[1]:
            near = sphere_reached(bounds.ring_of_world[w, r + lane], reach.center, reach.axis, reach.limit)
        found = votes(near)
        if found != 0:
            out = wp.vec2i(wp.where(out[1] == 0, r + first_vote(found), out[0]), r + last_vote(found) + 1)
        r += lanes
    return out


@wp.func
def count_near(
    link: int,
    w: int,
    lane: int,
    lanes: int,
    reach: LinkReach,
    surface: LumenSurface,
    bounds: Bounds,
    inside: bool,
    candidates: Candidates,
):
    """Count the patches near a link; none where it is not ``inside`` the colon."""
    rings = wp.vec2i(0, 0)
    n = int(0)
    if inside:
        rings = near_rings(bounds, w, lane, lanes, reach)
        end = surface.ring_patch[rings[1]]
        p = surface.ring_patch[rings[0]]
        while p < end:
            n += vote_count(votes(near_patch(bounds, p + lane, end, w, reach)))
            p += lanes
    if lane == 0:
        candidates.rings[w, link] = rings
        candidates.patches[w, link] = n


@wp.func
def list_near(
    link: int,
    w: int,
    lane: int,
    lanes: int,
    reach: LinkReach,
    ring: int,
    surface: LumenSurface,
    bounds: Bounds,
    candidates: Candidates,
    dropped: wp.array[int],
):
    """List the patches near a link, whose own ring is ``ring``, after those of the links before."""
    before = int(0)
    k = int(lane)
    while k < link:
        before += candidates.patches[w, k]
        k += lanes
    before = warp_sum(before)
    wanted = before + candidates.patches[w, link]
    at = wp.min(before, candidates.capacity)
    room = wp.min(wanted, candidates.capacity)
    if lane == 0:
        candidates.start[w, link] = at
        if link == candidates.patches.shape[1] - 1:
            candidates.start[w, link + 1] = room
            if wanted > room:
                wp.atomic_add(dropped, w, (wanted - room) * candidates.patch_faces)
    rings = candidates.rings[w, link]
    end = surface.ring_patch[rings[1]]
    p = surface.ring_patch[rings[0]]
    while p < end and at < room:
        near = near_patch(bounds, p + lane, end, w, reach)
        found = votes(near)
        own = at + votes_before(found, lane)
        if near and own < room:
            of_patch = surface.ring[surface.patch_start[p + lane]]
            candidates.link[w, own] = link
            candidates.patch[w, own] = 2 * (p + lane) + int(wp.abs(of_patch - ring) <= surface.reach)
        at += vote_count(found)
        p += lanes


@wp.kernel(module="unique", module_options=FAST)
def find_patches(
    body_q: wp.array[wp.transform],
    links: LinkShapes,
    surface: LumenSurface,
    bounds: Bounds,
    law: ContactLaw,
    ring: wp.array2d[int],
    ring_distance: wp.array2d[float],
    threads: int,
    lanes: int,
    candidates: Candidates,
    dropped: wp.array[int],
):
    """List the patches near each link, wherever along the colon they are, in ascending order. Launch (W, T).

    Args:
        body_q: Link poses, shape (W*L,).
        links: Capsules of one world.
        surface: Inner faces of one world.
        bounds: Spheres around rings and patches.
        law: Contact law.
        ring: Ring of each link, shape (W, L).
        ring_distance: Distance from the center of the link's ring, FAR for links outside the anus [m], shape (W, L).
        threads: Threads of a world, T; one block.
        lanes: Those of a warp, ``LANES``; on a CPU 1.
        candidates: ``patches``, ``rings``, ``start``, ``link`` and ``patch`` are written.
        dropped: Contacts that found no room, shape (W,); the faces of patches that found none are added to it.
    """
    w, thread = wp.tid()
    lane = thread % lanes
    link = int(thread / lanes)
    while link < ring.shape[1]:
        reach = link_reach(link, w, body_q, links, law)
        count_near(link, w, lane, lanes, reach, surface, bounds, ring_distance[w, link] < FAR, candidates)
        link += threads / lanes
    wait_for_block()
    link = int(thread / lanes)
    while link < ring.shape[1]:
        reach = link_reach(link, w, body_q, links, law)
        list_near(link, w, lane, lanes, reach, ring[w, link], surface, bounds, candidates, dropped)
        link += threads / lanes
