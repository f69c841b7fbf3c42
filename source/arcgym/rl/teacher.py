# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""The teacher of a run: a policy of an earlier run, which does not learn."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from arcgym.rl.checkpoint import read_checkpoint
from arcgym.utils.errors import UsageError


def load_teacher(alg: Any, path: str | None, device: str) -> None:
    """Give an algorithm its teacher, unless a checkpoint of its own run has brought it.

    Args:
        alg: Algorithm with ``teacher_loaded``, whose ``load`` knows ``teacher``.
        path: Checkpoint of the teacher's PPO run.
        device: Where to.

    Raises:
        UsageError: There is no such checkpoint, or it does not fit.
    """
    if alg.teacher_loaded:
        return
    if not path:
        raise UsageError("No teacher: set agent.teacher_checkpoint to a checkpoint of a privileged PPO policy.")
    if not Path(path).is_file():
        raise UsageError(f"No teacher checkpoint '{path}'.")
    try:
        alg.load(read_checkpoint(path, device), {"teacher": True}, strict=True)
    except (KeyError, RuntimeError, ValueError) as error:
        reason = " ".join(str(error).split())  # torch's has a line for each kind of mismatch
        raise UsageError(f"agent.teacher_checkpoint={path} does not fit agent.teacher: {reason}") from error
