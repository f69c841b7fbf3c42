# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Number of threads that PyTorch works with."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import torch


@contextmanager
def one_thread() -> Iterator[None]:
    """Run PyTorch's operations on the CPU on the calling thread alone; also for use as a decorator.

    Those of an environment are too small to share out: where the cores have other work, too, waiting for the other
    threads took five times as long as the operations (13 instead of 2 ms a control step of one world).
    """
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(threads)
