# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Policies that come with ARCGym: ``policies/<robot>/`` beside the USD assets, each with the parameters of its run.

There is none yet; ``scripts/tools/ship_policy.py`` puts a run's policy there.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import torch

from arcgym.rl.checkpoint import read_checkpoint, write_checkpoint
from arcgym.utils.errors import UsageError
from arcgym.utils.paths import assets_dir

FILE = "model.pt"
"""Name of the checkpoint in a policy's folder."""


def policies_dir() -> Path:
    """Return the folder of the shipped policies, which lies beside :func:`arcgym.utils.paths.assets_dir`."""
    return assets_dir().parent / "policies"


def robot_of(task: str) -> str:
    """Return the robot that a task is named after: ``magnetic`` for ``ARC-Sigmoid-Magnetic-Play``."""
    return task.removesuffix("-Play").rpartition("-")[2].lower()


def pretrained_checkpoint(task: str) -> Path:
    """Return the checkpoint of the policy that is shipped for a task's robot.

    Raises:
        UsageError: There is none, with the robots that have one.
    """
    path = policies_dir() / robot_of(task) / FILE
    if path.is_file():
        return path
    plain = task.removesuffix("-Play")
    there = sorted(found.parent.name for found in policies_dir().glob(f"*/{FILE}"))
    raise UsageError(
        f"No policy is shipped for '{robot_of(task)}', the robot of {plain}; there are some for: "
        f"{', '.join(there) or 'none'}. Train one with 'arcgym train --task {plain}'."
    )


def is_pretrained(checkpoint: Path) -> bool:
    """Return whether a checkpoint is one of the shipped ones, beside which nothing may be written."""
    return checkpoint.resolve().is_relative_to(policies_dir().resolve())


def write_small(checkpoint: Path, out: Path) -> None:
    """Write the actor of a checkpoint alone, in half precision: what playing needs, in a fifth to a half of its size.

    Weights are rounded to 11 bits, so that actions change in their fourth digit: evaluate the file that is written.

    Args:
        checkpoint: File that a runner has saved.
        out: File to write.

    Raises:
        UsageError: The checkpoint is damaged or has no actor.
    """
    contents = read_checkpoint(checkpoint)
    if "actor_state_dict" not in contents:
        raise UsageError(
            f"{checkpoint} has no actor_state_dict; expected a checkpoint of rsl-rl's PPO or a runner here."
        )
    actor = {name: _halved(value) for name, value in contents["actor_state_dict"].items()}
    out.parent.mkdir(parents=True, exist_ok=True)
    write_checkpoint(out, {"actor_state_dict": actor, "iter": contents.get("iter", 0), "infos": {}})


def _halved(value: Any) -> Any:
    """Return floating numbers in half precision, and anything else as it is."""
    return value.half() if torch.is_tensor(value) and value.is_floating_point() else value
