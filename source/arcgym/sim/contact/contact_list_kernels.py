# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Lists of the contacts' records by wall vertex and by ring.

W worlds, S contact slots a world, V wall vertices.
"""

import warp as wp

from arcgym.sim.contact.contact_kernels import ContactRecords
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.block_queue_kernels import wait_for_block

LIST_ROOM = wp.constant(16)
"""Entries of a vertex's list up to which it is sorted in a copy."""
Entries = wp.types.vector(length=16, dtype=int)
BATCH = wp.constant(8)
"""Records that are read at a time."""
Batch = wp.types.vector(length=8, dtype=int)


@wp.func
def sort_long_list(entry: int, records: ContactRecords) -> int:
    """Sort the list that begins with ``entry``, of any length, where it is; return its new first entry."""
    head = int(-1)
    while entry >= 0:
        rest = records.vertex_next[entry]
        if head < 0 or entry < head:
            records.vertex_next[entry] = head
            head = entry
        else:
            at = head
            while records.vertex_next[at] >= 0 and records.vertex_next[at] < entry:
                at = records.vertex_next[at]
            records.vertex_next[entry] = records.vertex_next[at]
            records.vertex_next[at] = entry
        entry = rest
    return head


@wp.kernel
def sort_vertex_lists(records: ContactRecords):
    """Put the entries of each vertex's list in ascending order. Launch (V, W).

    Threads append entries as they come. Sorted, every sum over contacts is the same on CPU and GPU, and in every run.
    Lists of up to ``LIST_ROOM`` entries are sorted in a copy, since a GPU waits for every step along a list.
    """
    v, w = wp.tid()
    entry = records.vertex_head[v, w]
    if entry < 0:
        return
    entries = Entries()
    count = int(0)
    rest = int(entry)
    while rest >= 0 and count < LIST_ROOM:
        at = int(count)
        while at > 0 and entries[wp.max(at - 1, 0)] > rest:
            entries[at] = entries[at - 1]
            at -= 1
        entries[at] = rest
        rest = records.vertex_next[rest]
        count += 1
    if rest >= 0:
        records.vertex_head[v, w] = sort_long_list(entry, records)
    elif count > 1:
        records.vertex_head[v, w] = entries[0]
        for k in range(count - 1):
            records.vertex_next[entries[k]] = entries[k + 1]
        records.vertex_next[entries[count - 1]] = -1


@wp.kernel
def list_rings(parts: int, records: ContactRecords):
    """Link each world's records into lists by ring, in ascending order. Launch (W, ``parts``).

    Each thread goes through all records of its world, and sees to the list of every ``parts``-th ring. It reads a batch
    of records at a time: a GPU would wait for each of them.

    Args:
        parts: Threads a world.
        records: Contacts; the lists, emptied before, are written.
    """
    w, part = wp.tid()
    first = w * records.capacity
    last = records.start[w, records.start.shape[1] - 1] - 1
    while last >= 0:
        rings = Batch()
        for k in range(BATCH):
            rings[k] = records.ring[first + wp.max(last - k, 0)]
        for k in range(BATCH):
            if k <= last and rings[k] % parts == part:
                slot = first + last - k
                records.ring_next[slot] = records.ring_head[rings[k], w]
                records.ring_head[rings[k], w] = slot
        last -= BATCH


@wp.func
def place_in_order(entry: int, head: int, following: wp.array[int]) -> int:
    """Return the next entry of a list after ``entry`` in ascending order; for its first one, less a sign, see below.

    Args:
        entry: Entry of the list.
        head: Where the list, in any order, begins.
        following: What comes after each entry there.

    Returns:
        The least entry above ``entry``, or -1; of the least entry of all, -3 less that.
    """
    least = bool(True)
    after = int(-1)
    at = int(head)
    while at >= 0:
        if at < entry:
            least = False
        elif at > entry and (after < 0 or at < after):
            after = at
        at = following[at]
    if least:
        return -3 - after
    return after


@wp.kernel
def order_lists(records: ContactRecords, vertex_order: wp.array[int], ring_order: wp.array[int]):
    """Put the entries of all lists by vertex in ascending order, and make the lists by ring. Launch (W, T).

    What :func:`sort_vertex_lists` and :func:`list_rings` do, by all threads of a block: each entry finds the one after
    it on a walk along its list. The T threads of a world have to be one block.

    Args:
        records: Contacts; the lists by vertex hold their entries in any order, those by ring are empty.
        vertex_order: Scratch, shape (4*W*S,).
        ring_order: Scratch, shape (W*S,).
    """
    w, thread = wp.tid()
    first = w * records.capacity
    end = first + records.start[w, records.start.shape[1] - 1]
    slot = first + int(thread)
    while slot < end:
        ring_order[slot] = wp.atomic_exch(records.ring_head, records.ring[slot], w, slot)
        corners = records.corners[slot]
        for c in range(4):
            if c < 3 or corners[3] != corners[2]:
                entry = 4 * slot + c
                vertex_order[entry] = place_in_order(entry, records.vertex_head[corners[c], w], records.vertex_next)
        slot += records.threads
    wait_for_block()
    slot = first + int(thread)
    while slot < end:
        corners = records.corners[slot]
        for c in range(4):
            if c < 3 or corners[3] != corners[2]:
                entry = 4 * slot + c
                after = vertex_order[entry]
                if after < -1:
                    records.vertex_head[corners[c], w] = entry
                    after = -3 - after
                records.vertex_next[entry] = after
        records.ring_next[slot] = place_in_order(slot, records.ring_head[records.ring[slot], w], ring_order)
        slot += records.threads
    wait_for_block()
    slot = first + int(thread)
    while slot < end:
        after = records.ring_next[slot]
        if after < -1:
            records.ring_head[records.ring[slot], w] = slot
            records.ring_next[slot] = -3 - after
        slot += records.threads
