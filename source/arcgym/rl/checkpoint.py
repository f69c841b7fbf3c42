# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Checkpoint files: read as weights only, written whole or not at all."""

from __future__ import annotations

import hashlib
import io
import shutil
from pathlib import Path
from typing import Any

import torch

from arcgym.rl.small_weights import restore
from arcgym.utils.errors import UsageError
from arcgym.utils.files import write_whole


def read_checkpoint(path: str | Path, device: str = "cpu") -> dict[str, Any]:
    """Return the contents of a checkpoint. It may hold tensors, numbers and texts: nothing in it is executed.

    Args:
        path: File that the runner has saved.
        device: Device for the tensors.

    Raises:
        UsageError: The file is damaged, holds other objects, or is no checkpoint of a runner.
    """
    try:
        contents = torch.load(path, weights_only=True, map_location=device)
    except Exception as error:
        reason = str(error).partition(". ")[0].splitlines()[0] if str(error) else type(error).__name__
        raise UsageError(
            f"{path} cannot be loaded as weights; it is damaged, or holds objects that would run code: {reason}"
        ) from error
    if not isinstance(contents, dict) or "infos" not in contents:
        raise UsageError(f"{path} is no checkpoint of a training run; expected a file such as model_100.pt.")
    return restore(contents)


def write_checkpoint(path: str | Path, contents: dict[str, Any]) -> bool:
    """Write a checkpoint and return whether it was written; a full disk is reported and stops nothing.

    The file is complete whenever it exists under its name: an older one stays until the new one is whole.
    """
    buffer = io.BytesIO()
    torch.save(contents, buffer)
    try:
        write_whole(Path(path), buffer.getvalue())
    except OSError as error:
        print(f"checkpoint {path} not written: {disk_trouble(error, Path(path))}; training goes on", flush=True)
        return False
    return True


def file_sha256(path: Path) -> str:
    """Return the SHA-256 of a file, by which results name a checkpoint."""
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


def disk_trouble(error: OSError, path: Path) -> str:
    """Return what went wrong with a file in words, with the room that is left in its folder."""
    free = shutil.disk_usage(path.parent).free / 2**20 if path.parent.is_dir() else 0.0
    return f"{error.strerror or error} ({free:.1f} MiB free in {path.parent})"
