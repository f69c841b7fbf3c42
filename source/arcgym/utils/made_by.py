# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""What made a folder of results, so that a later command adds nothing else to it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from arcgym.utils.errors import UsageError
from arcgym.utils.files import write_whole

MADE_BY = "made_by.json"
"""File that says what made what is beside it."""


def check_made_by(folder: Path, made_by: dict[str, Any], contents: str) -> None:
    """Write what makes the contents of a folder, or compare it with what made those that are there.

    Args:
        folder: Folder; made if it is not there.
        made_by: Plain values by name.
        contents: Pattern of the files that are made, such as ``*/*.hdf5``.

    Raises:
        UsageError: The folder holds some that something else made.
    """
    path = folder / MADE_BY
    now = json.loads(json.dumps(made_by))
    if path.is_file() and any(folder.glob(contents)):
        then = json.loads(path.read_text())
        name = next((name for name in now if then.get(name) != now[name]), None)
        if name is not None:
            raise UsageError(
                f"{folder} was made with {name} {then.get(name)}, and now it is {now[name]}: both would count as one. "
                "Give another --out."
            )
        return
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(path, json.dumps(now, indent=1).encode())
