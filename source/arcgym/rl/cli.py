# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Command-line arguments that the scripts share. Importing this loads neither torch nor Newton."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from typing import Any

from arcgym.utils.hydra import apply_overrides
from arcgym.utils.registry import load_cfg_from_registry

_OVERRIDES = "Any other argument is an override: env.scene.num_envs=64 agent.algorithm.learning_rate=1e-4"


def make_parser(description: str) -> argparse.ArgumentParser:
    """Return a parser with the arguments of every script that runs a task."""
    parser = argparse.ArgumentParser(description=description, epilog=_OVERRIDES)
    parser.add_argument("--task", required=True, help="task name; scripts/list_envs.py lists them")
    parser.add_argument("--num_envs", type=int, help="number of worlds (default: the task's)")
    parser.add_argument("--seed", type=int, help="seed of environment and networks (default: the agent's)")
    parser.add_argument("--device", help="cpu, cuda or cuda:<n> (default: cuda:0 where there is one, else cpu)")
    parser.add_argument("--agent", default="rsl_rl_cfg_entry_point", help="registry key of the agent's configuration")
    parser.add_argument("--headless", action="store_true", help="accepted for Isaac Lab's sake: there is no window")
    return parser


def add_run_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments that choose a training run and its checkpoint."""
    group = parser.add_argument_group("run")
    group.add_argument("--experiment_name", help="folder below logs/rsl_rl (default: the agent's)")
    group.add_argument("--load_run", help="run folder, or a regular expression for it (default: the newest)")
    group.add_argument("--checkpoint", help="path, file name, 'latest' or 'best' (default: latest)")


def add_video_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments that switch videos on."""
    group = parser.add_argument_group("video")
    group.add_argument("--video", action="store_true", help="record MP4 videos")
    group.add_argument("--video_length", type=int, default=200, help="control steps of a video (default: 200)")


def parse(parser: argparse.ArgumentParser, argv: Sequence[str] | None = None) -> tuple[argparse.Namespace, list[str]]:
    """Return the known arguments and the overrides; anything else ends the script with a usage message."""
    args, overrides = parser.parse_known_args(argv)
    unknown = [text for text in overrides if text.startswith("-") or "=" not in text]
    if unknown:
        parser.error(f"unknown argument: {' '.join(unknown)} (an override is written env.…=value or agent.…=value)")
    return args, overrides


def load_cfgs(parser: argparse.ArgumentParser, args: argparse.Namespace, overrides: Sequence[str]) -> tuple[Any, Any]:
    """Return the task's environment and agent configurations with overrides and arguments written into them.

    A mistake ends the script with the message of the registry or the override, before anything is simulated.
    """
    try:
        env_cfg = load_cfg_from_registry(args.task, "env_cfg_entry_point")
        agent_cfg = load_cfg_from_registry(args.task, args.agent)
        apply_overrides({"env": env_cfg, "agent": agent_cfg}, overrides)
    except (TypeError, ValueError) as error:
        parser.error(str(error))
    names = {"seed", "max_iterations", "experiment_name", "run_name", "load_run", "logger", "log_project_name"}
    for name in names & vars(args).keys():
        if getattr(args, name) is not None:
            setattr(agent_cfg, name, getattr(args, name))
    agent_cfg.load_checkpoint = getattr(args, "checkpoint", None) or agent_cfg.load_checkpoint
    agent_cfg.resume = agent_cfg.resume or getattr(args, "resume", False)
    if args.num_envs is not None:
        env_cfg.scene.num_envs = args.num_envs
    return env_cfg, agent_cfg


def place(env_cfg: Any, agent_cfg: Any, device: str | None, distributed: bool = False) -> str:
    """Choose the device, write it and the seed into ``env_cfg``, seed torch, and return the device.

    With ``distributed`` each process of ``torchrun`` takes the GPU of its local rank and its own seed.
    """
    import torch

    if distributed:
        device = f"cuda:{os.environ.get('LOCAL_RANK', '0')}"
        agent_cfg.seed += int(os.environ.get("RANK", "0"))
    device = device or ("cuda:0" if torch.cuda.is_available() else "cpu")
    device = "cuda:0" if device == "cuda" else device
    env_cfg.sim.device = device
    env_cfg.seed = agent_cfg.seed
    torch.manual_seed(agent_cfg.seed)
    return device


def run_untrained(description: str, policy: str) -> None:
    """Parse the command line of a script that runs a policy without training, run it and print its figures.

    Args:
        description: What ``--help`` says.
        policy: Function of :mod:`arcgym.rl.rollout` that makes the policy: ``zero_policy`` or ``random_policy``.
    """
    parser = make_parser(description)
    parser.add_argument("--steps", type=int, default=100, help="control steps (default: 100)")
    parser.add_argument("--json", action="store_true", help="print the figures as JSON on the last line")
    args, overrides = parse(parser)
    env_cfg, agent_cfg = load_cfgs(parser, args, overrides)
    place(env_cfg, agent_cfg, args.device)

    import gymnasium as gym

    from arcgym.rl import RslRlVecEnvWrapper, rollout

    env = RslRlVecEnvWrapper(gym.make(args.task, cfg=env_cfg))
    result = rollout.run_policy(env, getattr(rollout, policy)(env), args.steps)
    print(result)
    if args.json:
        print(result.to_json())
    env.close()
