# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Threads of a CPU that replay recorded launches together, outside Python.

Every thread calls ``share_stages`` once. Whichever is free takes the next task of the first stage whose needs are done,
so that a thread that the operating system holds up leaves its share to the others. A thread with nothing to do spins
for some hundred microseconds, longer than most tasks take, then lets other programs have the core.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401

_SHARE = """
#if !defined(__CUDA_ARCH__)
    typedef bool (*replay_type)(void*);
    typedef void (*rest_type)();
    const replay_type replay = (replay_type)calls[0];
    const rest_type rest = (rest_type)calls[1];
    const int count = (int)plan.shape[0];
    const long long* const stages = (const long long*)plan.data;
    long long* const state = (long long*)progress.data;
    for (long long end = before + 1; end <= before + steps; ++end) {
        int low = 0;
        int idle = 0;
        while (low < count && __atomic_load_n(state + 16 * count, __ATOMIC_RELAXED) == 0) {
            if (__atomic_load_n(state + 16 * low + 8, __ATOMIC_ACQUIRE) >= end * stages[4 * low + 1]) {
                ++low;
                continue;
            }
            bool worked = false;
            for (int s = low; s < count && !worked; ++s) {
                const long long* const stage = stages + 4 * s;
                const long long tasks = stage[1];
                long long taken = __atomic_load_n(state + 16 * s, __ATOMIC_RELAXED);
                if (taken >= end * tasks) continue;
                bool ready = true;
                for (int k = 2; k < 4; ++k) {
                    const long long need = stage[k];
                    if (need >= 0
                        && __atomic_load_n(state + 16 * need + 8, __ATOMIC_ACQUIRE) < end * stages[4 * need + 1])
                        ready = false;
                }
                if (!ready) continue;
                if (!__atomic_compare_exchange_n(
                        state + 16 * s, &taken, taken + 1, false, __ATOMIC_ACQ_REL, __ATOMIC_RELAXED))
                    break;
                const long long task = stage[0] + taken - (end - 1) * tasks;
                if (!replay((void*)((const long long*)graphs.data)[task]))
                    __atomic_store_n(state + 16 * count, 1, __ATOMIC_RELAXED);
                __atomic_fetch_add(state + 16 * s + 8, 1, __ATOMIC_RELEASE);
                worked = true;
            }
            if (worked) {
                idle = 0;
            } else if (++idle > SPINS && rest) {
                rest();
            } else {
#if defined(__x86_64__)
                __builtin_ia32_pause();
#elif defined(__aarch64__)
                __asm__ volatile("yield");
#endif
            }
        }
    }
#endif
""".replace("SPINS", "3000")


@wp.func_native(_SHARE)
def share_stages(
    calls: wp.array[wp.int64],
    plan: wp.array2d[wp.int64],
    graphs: wp.array[wp.int64],
    before: wp.int64,
    steps: wp.int64,
    progress: wp.array2d[wp.int64],
):
    """Do tasks until all stages are done."""
    ...


@wp.kernel
def share(
    calls: wp.array[wp.int64],
    plan: wp.array2d[wp.int64],
    graphs: wp.array[wp.int64],
    before: wp.int64,
    steps: wp.int64,
    progress: wp.array2d[wp.int64],
):
    """Do tasks until all stages have been done ``steps`` times. Launch 1 on a CPU, from each thread.

    Args:
        calls: Addresses of the function that replays a graph, and of the one that gives up the core, 0 for none.
        plan: First task of each of S stages, its number of tasks, and two stages to be done before it, -1 for none,
            shape (S, 4).
        graphs: Address of each task's graph, stage after stage.
        before: How many times all was done before.
        steps: How many times to do all.
        progress: Tasks of each stage that were taken since the beginning (first) and that are done (ninth, in a cache
            line of its own), shape (S + 1, 16); the last row begins with 1 after a failure.
    """
    share_stages(calls, plan, graphs, before, steps, progress)
