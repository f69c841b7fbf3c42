# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Configurations of a task as the command line wants them."""

from __future__ import annotations

from typing import Any

from arcgym.cli.arguments import TaskArguments
from arcgym.utils.errors import UsageError

AGENT_FIELDS = ("seed", "max_iterations", "experiment_name", "run_name", "load_run", "logger", "log_project_name")
"""Arguments that are fields of the agent's configuration."""


def load_cfgs(args: TaskArguments) -> tuple[Any, Any]:
    """Return the task's environment and agent configurations with overrides and arguments written into them.

    Raises:
        UsageError: The task, the agent or an override is wrong.
    """
    from arcgym.utils.hydra import apply_overrides
    from arcgym.utils.registry import load_cfg_from_registry

    try:
        env_cfg = load_cfg_from_registry(args.task, "env_cfg_entry_point")
        agent_cfg = load_cfg_from_registry(args.task, args.agent)
        apply_overrides({"env": env_cfg, "agent": agent_cfg}, args.overrides)
    except (TypeError, ValueError) as error:
        raise UsageError(str(error)) from error
    for name in AGENT_FIELDS:
        if getattr(args, name, None) is not None:
            setattr(agent_cfg, name, getattr(args, name))
    agent_cfg.load_checkpoint = getattr(args, "checkpoint", None) or agent_cfg.load_checkpoint
    agent_cfg.resume = agent_cfg.resume or getattr(args, "resume", False)
    if args.num_envs is not None:
        env_cfg.scene.num_envs = args.num_envs
    return env_cfg, agent_cfg
