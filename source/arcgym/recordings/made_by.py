# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""What made a data set, so that a later command adds nothing else to it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from arcgym.managers.recorder_files import SUFFIX
from arcgym.rl.run_folder import write_whole
from arcgym.utils.errors import UsageError

MADE_BY = "made_by.json"
"""File of a data set that says what made it."""


def hold_to(folder: Path, made_by: dict[str, Any]) -> None:
    """Write what makes a data set, or compare it with what made the episodes that are there.

    Args:
        folder: Folder of the data set; made if it is not there.
        made_by: Plain values by name.

    Raises:
        UsageError: The folder holds episodes of something else.
    """
    path = folder / MADE_BY
    now = json.loads(json.dumps(made_by))
    if path.is_file() and any(folder.glob(f"*/*{SUFFIX}")):
        then = json.loads(path.read_text())
        name = next((name for name in now if then.get(name) != now[name]), None)
        if name is not None:
            raise UsageError(
                f"{folder} was made with {name} {then.get(name)}, and now it is {now[name]}: episodes of both would be "
                "one data set. Give another --out."
            )
        return
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(path, json.dumps(now, indent=1).encode())
