# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Threads of a CPU that replay recorded launches together, outside Python.

Every thread calls ``share_stages`` once. Whichever is free takes a task of the first stage whose needs are done, so
that a thread that the operating system holds up leaves its share to the others. Each begins with its own part of a
stage's tasks, the rows that it worked on before, which its core's cache holds. A thread with nothing to do spins for
some hundred microseconds, longer than most tasks take, then lets other programs have the core.
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
    long long* const done = (long long*)progress.data;  // of stage s at 8 s; after them a failure
    long long* const taken = (long long*)taken_by_task.data;
    for (long long round = before + 1; round <= before + rounds; ++round) {
        int low = 0;
        int idle = 0;
        while (low < count && __atomic_load_n(done + 8 * count, __ATOMIC_RELAXED) == 0) {
            if (__atomic_load_n(done + 8 * low, __ATOMIC_ACQUIRE) >= round * stages[4 * low + 1]) {
                ++low;
                continue;
            }
            long long task = -1;
            int s = low;
            for (; s < count; ++s) {
                const long long* const stage = stages + 4 * s;
                bool ready = true;
                for (int k = 2; k < 4; ++k) {
                    const long long need = stage[k];
                    if (need >= 0 && __atomic_load_n(done + 8 * need, __ATOMIC_ACQUIRE) < round * stages[4 * need + 1])
                        ready = false;
                }
                if (!ready) continue;
                for (long long k = 0; k < stage[1] && task < 0; ++k) {
                    const long long own = stage[0] + (thread * stage[1] / threads + k) % stage[1];
                    long long last = __atomic_load_n(taken + own, __ATOMIC_RELAXED);
                    if (last < round
                        && __atomic_compare_exchange_n(
                            taken + own, &last, round, false, __ATOMIC_ACQ_REL, __ATOMIC_RELAXED))
                        task = own;
                }
                if (task >= 0) break;
            }
            if (task >= 0) {
                if (!replay((void*)((const long long*)graphs.data)[task]))
                    __atomic_store_n(done + 8 * count, 1, __ATOMIC_RELAXED);
                __atomic_fetch_add(done + 8 * s, 1, __ATOMIC_RELEASE);
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
    thread: wp.int64,
    threads: wp.int64,
    before: wp.int64,
    rounds: wp.int64,
    taken_by_task: wp.array[wp.int64],
    progress: wp.array2d[wp.int64],
):
    """Do tasks until all stages are done."""
    ...


@wp.kernel
def share(
    calls: wp.array[wp.int64],
    plan: wp.array2d[wp.int64],
    graphs: wp.array[wp.int64],
    thread: wp.int64,
    threads: wp.int64,
    before: wp.int64,
    rounds: wp.int64,
    taken_by_task: wp.array[wp.int64],
    progress: wp.array2d[wp.int64],
):
    """Do tasks until all stages have been done ``rounds`` times. Launch 1 on a CPU, from each thread.

    Args:
        calls: Addresses of the function that replays a graph, and of the one that gives up the core, 0 for none.
        plan: First task of each of S stages, its number of tasks, and two stages to be done before it, -1 for none,
            shape (S, 4).
        graphs: Address of each task's graph, stage after stage.
        thread: Which thread this is.
        threads: How many there are.
        before: How many times all was done before.
        rounds: How many times to do all.
        taken_by_task: Last round in which each task was taken.
        progress: Tasks of each stage that are done since the beginning, a cache line each, shape (S + 1, 8); the last
            row begins with 1 after a failure.
    """
    share_stages(calls, plan, graphs, thread, threads, before, rounds, taken_by_task, progress)
