# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Write a generated colon into a folder that appears when it is whole."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from arcgym.anatomy.generator.generate import make_colon
from arcgym.anatomy.generator.spec import ColonSpec
from arcgym.anatomy.stage import write_colon
from arcgym.anatomy.stage.types import ColonStage


def check_folder(out: Path) -> None:
    """Check that a colon can be made there.

    Raises:
        ValueError: If it exists and is no empty folder.
    """
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise ValueError(f"{out} exists and is not an empty folder; choose another or remove it.")


def make_to_folder(spec: ColonSpec, out: Path) -> ColonStage:
    """Generate a colon beside a folder, move it there when it is whole, and return it.

    Raises:
        ValueError: If the folder exists and is not empty.
        OSError: If another process made it meanwhile.
        AnatomyError: If the spec gives no valid colon.
    """
    check_folder(out)
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out.parent, prefix=".making-") as folder:
        made = Path(folder) / "colon"
        stage = make_colon(spec, made)
        write_colon(stage, made / "colon.usda")
        if out.exists():
            out.rmdir()
        os.rename(made, out)  # fails where another process made it meanwhile
    return stage
