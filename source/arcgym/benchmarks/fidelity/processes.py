# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Parts of a check in processes of their own, as many at a time as there are cores."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from typing import Any


def in_processes(function: Callable[..., Any], tasks: Sequence[tuple[Any, ...]]) -> list[Any]:
    """Return the function's results for each tuple of arguments, in their order.

    Args:
        function: A function of a module; it, its arguments and its results are sent from process to process.
        tasks: Arguments of each call; a single call is made in this process.
    """
    if len(tasks) < 2:
        return [function(*task) for task in tasks]
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1
    with ProcessPoolExecutor(min(len(tasks), cores), multiprocessing.get_context("spawn")) as pool:
        return [task.result() for task in [pool.submit(function, *arguments) for arguments in tasks]]
