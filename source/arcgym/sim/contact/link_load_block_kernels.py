# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Contact loads on the links on a GPU: what :mod:`.link_load_kernels` does, by a block a world.

Of 121 links 35 touch the wall, at up to 42 faces each and at 620 in all. A thread or a few for each link leave most of
a warp waiting for the link with the most contacts. Here every thread measures a contact, whichever link it is of, and
leaves in shared memory the 11 numbers that its load takes; then eight threads a link add those up. W worlds, L links, V
wall vertices a world.
"""

import warp as wp

from arcgym.sim.contact.contact_kernels import ContactLaw, ContactRecords, LinkShapes
from arcgym.sim.contact.link_load_kernels import ContactPush, MovingLink, link_motion, push_at
from arcgym.sim.scope.load_row_kernels import LoadRows, LoadSum, with_push, write_row
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.block_queue_kernels import wait_for_block
from arcgym.utils.four_store_kernels import joined, leading
from arcgym.utils.warp_setup import FAST
from arcgym.utils.warp_vote_kernels import votes

THREADS = 256
"""Threads a world on a GPU, T: a block."""


@wp.func_native(
    """
#if defined(__CUDA_ARCH__)
    __shared__ float4 room[3 * THREADS];
    float4& four = room[part * THREADS + at];
    if (write) four = make_float4(value[0], value[1], value[2], value[3]);
    return wp::vec_t<4, float>(four.x, four.y, four.z, four.w);
#else
    static float room[12];
    float* const four = room + 4 * part;
    for (int i = 0; i < 4; ++i)
        if (write) four[i] = value[i];
    return wp::vec_t<4, float>(four[0], four[1], four[2], four[3]);
#endif
""".replace("THREADS", str(THREADS))
)
def shared_four(write: bool, part: int, at: int, value: wp.vec4) -> wp.vec4:
    """Write, or just return, one of the three fours of the contact ``at`` in the shared memory of a block.

    On a CPU, where a block is one thread, there is one contact.
    """
    ...


@wp.func
def leave_push(at: int, push: ContactPush):
    """Leave a contact for all threads of the block."""
    shared_four(True, 0, at, joined(push.force, push.along - push.across))
    shared_four(True, 1, at, joined(push.normal, push.across))
    shared_four(True, 2, at, joined(push.lever, 0.0))


@wp.func
def with_left(total: LoadSum, at: int) -> LoadSum:
    """Return a load and that of the contact that was left ``at``."""
    none = wp.vec4(0.0)
    first = shared_four(False, 0, at, none)
    second = shared_four(False, 1, at, none)
    third = shared_four(False, 2, at, none)
    return with_push(total, leading(first), leading(second), first[3], second[3], leading(third))


@wp.func
def add_up(
    base: int,
    end: int,
    w: int,
    links: int,
    thread: int,
    threads: int,
    group: int,
    records: ContactRecords,
    rows: LoadRows,
):
    """Add the contacts ``base`` to ``end`` of a world, which were left in this order, to the rows of their links."""
    first = w * records.capacity
    last_link = records.link[first + end - 1]
    link = records.link[first + base] + thread / group
    lane = thread % group
    while votes(link <= last_link) != 0:
        total = LoadSum()
        start = int(0)
        stop = int(0)
        if link <= last_link:
            start = records.start[w, link]
            stop = wp.min(records.start[w, link + 1], end)
        k = wp.max(start, base) + lane
        while k < stop:
            total = with_left(total, k - base)
            k += group
        write_row(total, w * links + link, lane, wp.max(start, base) < stop, start < base, rows)
        link += threads / group


@wp.kernel(launch_bounds=(THREADS, 4), module="unique", module_options=FAST)
def load_contacts_by_block(
    body_q: wp.array[wp.transform],
    body_qd: wp.array[wp.spatial_vector],
    com: wp.array[wp.vec3],
    x: wp.array2d[wp.vec3],
    v: wp.array2d[wp.vec3],
    links: LinkShapes,
    records: ContactRecords,
    law: ContactLaw,
    friction: wp.array[float],
    body_q_prev: wp.array[wp.transform],
    elapsed: float,
    dt: float,
    threads: int,
    group: int,
    motions: wp.array[MovingLink],
    rows: LoadRows,
    penetrated: wp.array[int],
):
    """Sum up the contacts of each link with the wall at its present place. Launch (W, T) in blocks of T.

    The sums are the same in every run, and whatever the number of worlds.

    Args:
        body_q: Link poses, shape (W*L,).
        body_qd: Link velocities [m/s, rad/s], shape (W*L,).
        com: Centers of mass in the links' frames [m], shape (W*L,).
        x: Wall positions [m], shape (V, W).
        v: Wall velocities [m/s], shape (V, W).
        links: Capsules of one world.
        records: Contacts; ``point`` and ``point_vel`` are written where ``elapsed`` is 0, and read in later substeps.
        law: Contact law.
        friction: Coulomb coefficient of each world, shape (W,).
        body_q_prev: Link poses at the start of the physics step, shape (W*L,).
        elapsed: Time since then [s].
        dt: Substep [s].
        threads: ``THREADS``; on a CPU 1.
        group: Threads that add up a link's contacts, ``GROUP``; on a CPU 1.
        motions: Scratch, shape (W*L,).
        rows: Loads of the links; written.
        penetrated: Set to 1 where a link's axis is so close to the wall that it may get behind it, or is, shape (W,).
    """
    w, thread = wp.tid()
    count = links.radius.shape[0]
    link = int(thread)
    while link < count:
        row = w * count + link
        touches = records.start[w, link] < records.start[w, link + 1]
        rows.loaded[row] = int(touches)
        if touches:
            motions[row] = link_motion(row, link, body_q, body_qd, com, body_q_prev)
        link += threads
    wait_for_block()
    contacts = records.start[w, count]
    base = int(0)
    while base < contacts:
        end = wp.min(base + threads, contacts)
        if base + thread < end:
            slot = w * records.capacity + base + thread
            touching = records.link[slot]
            motion = motions[w * count + touching]
            push = push_at(slot, touching, w, motion, x, v, links, records, law, friction, elapsed, dt, penetrated)
            leave_push(thread, push)
        wait_for_block()
        add_up(base, end, w, count, thread, threads, group, records, rows)
        wait_for_block()
        base = end
