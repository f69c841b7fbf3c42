# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Policies that come with ARCGym: ``policies/<segment>-<robot>/`` beside the USD assets, each with what it is.

A folder has ``model.pt``, the parameters of its run in ``params/``, its curve in ``curves.csv``, and in ``evaluation/``
the trials that this very file has run. ``scripts/tools/ship_policy.py`` makes it of a run.
"""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import torch

from arcgym.rl.checkpoint import read_checkpoint
from arcgym.rl.small_weights import LEVELS, SCALES, shrink
from arcgym.utils.errors import UsageError
from arcgym.utils.files import write_whole
from arcgym.utils.paths import assets_dir
from arcgym.utils.registry import plain_task

FILE = "model.pt"
"""Name of the checkpoint in a policy's folder."""

ABOUT = "about.json"
"""Description of a policy in its folder: its task, its agent, what it was trained on and for how long."""

JOURNEYS = ("leftcolon", "cecum")
"""Whose policies play the robot's other tasks, where these have none of their own: the first that there is."""


def policies_dir() -> Path:
    """Return the folder of the shipped policies, which lies beside :func:`arcgym.utils.paths.assets_dir`."""
    return assets_dir().parent / "policies"


def folder_of(task: str) -> str:
    """Return the name of a task's folder: ``sigmoid-magnetic`` for ``ARC-Sigmoid-Magnetic-Play``."""
    return plain_task(task).removeprefix("ARC-").lower()


def robot_of(task: str) -> str:
    """Return the robot that a task is named after: ``magnetic`` for ``ARC-Sigmoid-Magnetic-Play``."""
    return folder_of(task).rpartition("-")[2]


def pretrained_checkpoint(task: str, agent: str | None = None, goes_in: bool = True) -> Path:
    """Return the checkpoint of the policy that is shipped for a task: its own, or that of a journey of its robot.

    Args:
        task: Name of the task.
        agent: Agent that was asked for, for the hint how to train one; None is the task's first.
        goes_in: Whether the task goes towards the cecum, as journeys do; a withdrawal has a policy of its own or none.

    Raises:
        UsageError: There is none, with the tasks that have one.
    """
    journeys = [f"{journey}-{robot_of(task)}" for journey in JOURNEYS] if goes_in else []
    for name in (folder_of(task), *journeys):
        path = policies_dir() / name / FILE
        if path.is_file():
            return path
    plain, further = plain_task(task), f" --agent {agent}" if agent else ""
    there = sorted(found.parent.name for found in policies_dir().glob(f"*/{FILE}"))
    others = f"and none for a journey of '{robot_of(task)}'" if goes_in else "and those of journeys go the other way"
    raise UsageError(
        f"No policy is shipped for {plain}, {others}; there are some for: "
        f"{', '.join(there) or 'none'}. Train one with 'arcgym train --task {plain}{further}'."
    )


def is_pretrained(checkpoint: Path) -> bool:
    """Return whether a checkpoint is one of the shipped ones, beside which nothing may be written."""
    return checkpoint.resolve().is_relative_to(policies_dir().resolve())


def write_small(checkpoint: Path, out: Path, levels: int = LEVELS) -> None:
    """Write the actor of a checkpoint alone and small, see :func:`arcgym.rl.small_weights.shrink`.

    Actions change in their third digit, with fewer levels in their second: evaluate the file that is written.

    Args:
        checkpoint: File that a runner has saved.
        out: File to write.
        levels: Largest whole number of a weight.

    Raises:
        UsageError: The checkpoint is damaged or has no actor.
    """
    contents = read_checkpoint(checkpoint)
    if "actor_state_dict" not in contents:
        raise UsageError(
            f"{checkpoint} has no actor_state_dict; expected a checkpoint of rsl-rl's PPO or a runner here."
        )
    actor, scales = shrink(contents["actor_state_dict"], levels)
    infos = contents["infos"] or {}
    kept = {name: infos[name] for name in ("transitions", "seconds") if name in infos}
    out.parent.mkdir(parents=True, exist_ok=True)
    small = {"actor_state_dict": actor, SCALES: scales, "iter": contents.get("iter", 0), "infos": kept}
    buffer = io.BytesIO()
    torch.save(small, buffer)
    write_whole(out, deflated(buffer.getvalue()))


def deflated(archive: bytes) -> bytes:
    """Return a zip archive with its files compressed, as torch, which writes them plain, reads them too."""
    packed = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(archive)) as plain, zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as out:
        for name in plain.namelist():
            out.writestr(zipfile.ZipInfo(name), plain.read(name), zipfile.ZIP_DEFLATED, compresslevel=9)
    return packed.getvalue()
