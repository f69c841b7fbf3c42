# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Machines without an NVIDIA driver: Warp starts there without its warning that it found none.

The warning says nothing that was asked for: which device a command runs on, the command prints itself, and a GPU that
is named by ``--device`` and is not there is refused.
"""

from __future__ import annotations

import ctypes
import os
import sys
import tempfile
from collections.abc import Callable

WARNING = "Could not find or load the NVIDIA CUDA driver"
"""Part of the line that Warp's native library writes to stderr."""

_LIBRARIES = ("libcuda.so", "libcuda.so.1")
"""What Warp looks for on Linux."""


def driver_is_missing() -> bool:
    """Return whether Warp will find no NVIDIA driver; False where it is not known, as on Windows."""
    return sys.platform == "linux" and not any(map(_loads, _LIBRARIES))


def without_line(part: str, work: Callable[[], None]) -> None:
    """Do work and pass on what it, or native code that it calls, writes to stderr, but for lines that hold ``part``."""
    with tempfile.TemporaryFile() as kept:
        sys.stderr.flush()
        stderr = os.dup(2)
        os.dup2(kept.fileno(), 2)
        try:
            work()
        finally:
            os.dup2(stderr, 2)
            os.close(stderr)
            kept.seek(0)
            lines = kept.read().splitlines(keepends=True)
            os.write(2, b"".join(line for line in lines if part.encode() not in line))


def _loads(library: str) -> bool:
    """Return whether a shared library can be loaded."""
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True
