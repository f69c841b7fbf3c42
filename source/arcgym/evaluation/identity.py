# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Identity of an evaluation: what is run, and with what settings that are not as registered."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import torch

from arcgym.envs.provenance import versions
from arcgym.evaluation.options import EvaluationOptions
from arcgym.evaluation.resolved_cfg import resolved
from arcgym.evaluation.set_by_trials import is_set_by_trials
from arcgym.evaluation.suites import split_task
from arcgym.evaluation.trained_on import trained_on
from arcgym.evaluation.trials import Conditions
from arcgym.rl.checkpoint import file_sha256, read_checkpoint
from arcgym.rl.device import choose_device
from arcgym.rl.params import differences, read_params
from arcgym.rl.rollout import UNTRAINED_POLICIES
from arcgym.utils.coerce import to_plain
from arcgym.utils.errors import UsageError
from arcgym.utils.registry import load_cfg_from_registry


def run_record(tasks: Sequence[str], conditions: Conditions, options: EvaluationOptions) -> dict[str, Any]:
    """Return what identifies an evaluation, and the versions and the machine it is made with.

    Checkpoints are listed in the order of the tasks that have some of their own, then of the groups.

    Raises:
        UsageError: A checkpoint is missing or would run no trial, or of several agents one is no checkpoint.
    """
    untrained = [agent for agent in options.agents if agent in UNTRAINED_POLICIES]
    if untrained and len(options.agents) > 1:
        raise UsageError(
            f"--agent is {','.join(options.agents)}; expected checkpoints, which are training seeds, or {untrained[0]} "
            "alone: other agents are evaluations of their own."
        )
    if len(options.agents) > conditions.groups:
        raise UsageError(
            f"--agent has {len(options.agents)} checkpoints, and trials of {conditions.name} have {conditions.groups} "
            "group(s), one for each training seed: the others would run nothing. Evaluate each in a folder of its own, "
            "or take a suite with more groups, such as paper or population."
        )
    agents = dict.fromkeys(agent for task in tasks for agent in options.agents_for(task))
    checkpoints = [] if options.agents[0] in UNTRAINED_POLICIES else [Path(agent) for agent in agents]
    missing = [str(path) for path in checkpoints if not path.is_file()]
    if missing:
        raise UsageError(
            f"No checkpoint {', '.join(missing)}; expected files, or one of {', '.join(UNTRAINED_POLICIES)}."
        )
    return {
        "agent": ",".join(options.agents) if not checkpoints else "checkpoint",
        "checkpoint": [str(path) for path in checkpoints],
        "checkpoint_sha256": [file_sha256(path) for path in checkpoints],
        "trained_on": [trained_on(path) for path in checkpoints],
        "training": [training_of(path) for path in checkpoints],
        "suite": options.suite,
        "conditions": conditions.name,
        "conditions_sha256": conditions.sha256,
        "overrides": list(options.overrides),
        "versions": versions(),
        "machine": f"{platform.processor() or platform.machine()}, {_accelerator(options.device)}",
    }


def training_of(checkpoint: Path) -> dict[str, Any]:
    """Return agent, task, limits, transitions and seconds that a checkpoint was trained with, as far as it says so."""
    saved, infos = read_params(checkpoint.parent), read_checkpoint(checkpoint)["infos"] or {}
    found = {name: infos[name] for name in ("transitions", "seconds") if name in infos}
    if saved is None:
        return found
    limits = saved.agent.get("algorithm", {}).get("limits")
    return {"agent": saved.agent_key, "task": saved.task, **found} | ({"limits": limits} if limits else {})


def changes_of(task: str, env_cfg: Any) -> dict[str, list[Any]]:
    """Return registered and used value of every field of the environment, by path, where they differ.

    A policy runs with the settings that it was trained with: what was made easier in training is easier here, too.
    Fields of an effect that is off in both change nothing and are left out: a policy is not another task's because
    the default of such a field has changed since it was trained.
    """
    registered = load_cfg_from_registry(split_task(task)[0], "env_cfg_entry_point")
    found = differences(to_plain(registered), to_plain(env_cfg))
    run = [resolved(cfg) for cfg in (registered, env_cfg)]
    kept = [path for path in found if not is_set_by_trials(path)]
    return {path: list(found[path]) for path in kept if not all(_is_off(path, cfg) for cfg in run)}


def _is_off(path: str, cfg: Any) -> bool:
    """Return whether a field, by its dotted path, is one of an effect that is switched off."""
    for name in path.split(".")[:-1]:
        cfg = cfg.get(name) if isinstance(cfg, dict) else getattr(cfg, name, None)
        if getattr(cfg, "active", True) is False:
            return True
    return False


def _accelerator(device: str | None) -> str:
    """Return the GPU that runs the trials: none where they run on the CPU of a machine that has one."""
    chosen = choose_device(device)
    return torch.cuda.get_device_name(chosen) if chosen.startswith("cuda") else "no GPU"
