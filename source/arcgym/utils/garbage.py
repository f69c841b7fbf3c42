# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Python's garbage collector."""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager

MANY_MODULES = 100
"""Newly imported modules from which on their objects are not looked through again."""


@contextmanager
def paused_collection() -> Iterator[None]:
    """Keep the garbage collector from running meanwhile; also for use as a decorator.

    For what makes many objects that stay, such as an environment.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


@contextmanager
def importing() -> Iterator[None]:
    """Keep the garbage collector from running during imports, and from looking through what they made soon after.

    After many imports all objects join the oldest generation, as if they had survived two collections; a full
    collection still finds those that nothing needs. Where a caller has frozen objects, they are left as they are.
    """
    loaded = len(sys.modules)
    with paused_collection():
        yield
        if len(sys.modules) - loaded >= MANY_MODULES and not gc.get_freeze_count():
            gc.freeze()
            gc.unfreeze()
