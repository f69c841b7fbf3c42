# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Files that grow line by line, by processes that may be killed."""

from __future__ import annotations

import os
from pathlib import Path


def append_line(path: Path, text: str) -> None:
    """Append a line; its folder is made.

    What a process that was killed left of a line stays on a line of its own, which readers have to leave out.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("ab+") as file:
        before = b""
        if file.seek(0, os.SEEK_END):
            file.seek(-1, os.SEEK_END)
            before = b"" if file.read(1) == b"\n" else b"\n"
        file.write(before + text.encode() + b"\n")
