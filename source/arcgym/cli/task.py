# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Configurations of a task as the command line wants them, on top of a run's where there is one."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from arcgym.cli.arguments import DEFAULT_AGENT, RunArguments, TaskArguments
from arcgym.utils.errors import UsageError
from arcgym.utils.string import did_you_mean

if TYPE_CHECKING:
    from arcgym.rl.params import RunParams

A = TypeVar("A", bound=RunArguments)

AGENT_FIELDS = (
    "seed",
    "max_iterations",
    "max_minutes",
    "experiment_name",
    "run_name",
    "load_run",
    "logger",
    "log_project_name",
)
"""Arguments that are fields of the agent's configuration."""

POLICY_ACTION_FIELDS = ("roll_amplitude", "roll_period", "back_off_velocity", "back_off_after", "back_off_time")
"""Fields of an action term that are a policy's own in every task."""


def load_cfgs(args: TaskArguments) -> tuple[Any, Any]:
    """Return the task's environment and agent configurations with overrides and arguments written into them.

    Raises:
        UsageError: The task, the agent or an override is wrong.
    """
    env_cfg, agent_cfg = _registered(args.task, args.agent)
    _write(args, env_cfg, agent_cfg)
    return env_cfg, agent_cfg


def agent_key(name: str) -> str:
    """Return the registry key of an agent: ``sac`` is ``rsl_rl_sac_cfg_entry_point``, ``ppo`` the default agent's."""
    if name.endswith("cfg_entry_point"):
        return name
    return DEFAULT_AGENT if name == "ppo" else f"rsl_rl_{name}_cfg_entry_point"


def agent_names(task: str) -> list[str]:
    """Return the agents of a task as ``--agent`` takes them: ``sac`` for ``rsl_rl_sac_cfg_entry_point``."""
    from arcgym.utils.registry import cfg_keys

    keys = [key for key in cfg_keys(task) if key not in (DEFAULT_AGENT, "env_cfg_entry_point")]
    names = [re.sub(r"^rsl_rl_(.+)_cfg_entry_point$", r"\1", key) for key in keys]
    return sorted([*names, "ppo"] if DEFAULT_AGENT in cfg_keys(task) else names)


def load_run_cfgs(args: RunArguments, as_registered: Sequence[str] = ()) -> tuple[Any, Any, Path]:
    """Return configurations as a run had them, changed by overrides and arguments, and the checkpoint of that run.

    Prints where they come from and what the command line changes. A run of another task gives the agent alone. With the
    path of a checkpoint and no agent named, the agent is the one that its run was trained with.

    Args:
        args: Task, checkpoint and overrides.
        as_registered: Paths of the environment's configuration that stay as the task is registered, such as ``events``.

    Raises:
        UsageError: The task, an override, the checkpoint or the run's parameters are wrong.
    """
    from arcgym.rl.params import read_params
    from arcgym.rl.run_folder import find_checkpoint
    from arcgym.utils.coerce import to_plain

    args = with_trained_agent(args)
    _, asked = load_cfgs(args)
    checkpoint = find_checkpoint(asked.experiment_name, asked.load_run, asked.load_checkpoint)
    env_cfg, agent_cfg = _registered(args.task, args.agent)
    saved = None if args.no_params else read_params(checkpoint.parent)
    if saved is None:
        print(f"params: the registered ones; none of {checkpoint.parent / 'params'} are used")
    else:
        _restore_agent(agent_cfg, saved, args, checkpoint)
        print(_restore_env(env_cfg, agent_cfg, saved, args, as_registered))
    before = {"env": to_plain(env_cfg), "agent": to_plain(agent_cfg)}
    _write(args, env_cfg, agent_cfg)
    _print_changes(before, {"env": to_plain(env_cfg), "agent": to_plain(agent_cfg)})
    _print_other_settings(args, env_cfg)
    return env_cfg, agent_cfg, checkpoint


def _restore_agent(agent_cfg: Any, saved: RunParams, args: RunArguments, checkpoint: Path) -> None:
    """Write a run's agent into ``agent_cfg``.

    Raises:
        UsageError: The agent asked for is not the one that the run was trained with.
    """
    from arcgym.rl.params import restore

    try:
        restore(agent_cfg, saved.agent, "agent")
    except UsageError as error:
        if saved.agent_key in (None, agent_key(args.agent)):
            raise
        trained = f"{checkpoint.parent} was trained with {saved.agent_key}; leave --agent out, or name that."
        raise UsageError(f"--agent is '{args.agent}', but {trained}") from error


def _restore_env(
    env_cfg: Any, agent_cfg: Any, saved: RunParams, args: RunArguments, as_registered: Sequence[str]
) -> str:
    """Write a run's environment into ``env_cfg``, or of another task what is the policy's own; return what was done."""
    from arcgym.rl.params import differences, restore
    from arcgym.utils.coerce import to_plain
    from arcgym.utils.registry import plain_task

    task, trained = plain_task(args.task), plain_task(saved.task)
    if task == trained:
        plain, _ = _registered(task, args.agent)
        kept = [*differences(to_plain(plain), to_plain(env_cfg)), *as_registered]
        restore(env_cfg, saved.env, "env", keep=kept)
        return f"params: {saved.folder}"
    restore(env_cfg, _further_inputs(saved.env, agent_cfg) | _own_fields(saved.env, env_cfg), "env")
    own = "as registered, but for what is the policy's own"
    return f"params: agent of {saved.folder}; it was trained in {trained}, and {task} is {own}"


def _print_changes(before: dict[str, Any], after: dict[str, Any]) -> None:
    """Print what the command line changes in a run's configurations."""
    from arcgym.rl.params import NOT_RESTORED, differences

    passing = {f"{kind}.{path}" for kind, paths in NOT_RESTORED.items() for path in paths}
    for path, (old, new) in differences(before, after).items():
        if path not in passing:
            print(f"changed: {path}: {old} -> {new}")


def _print_other_settings(args: RunArguments, env_cfg: Any) -> None:
    """Print where scope or patience of a run are not those of the task now, unless an override gives them."""
    from arcgym.evaluation.task_settings import PATIENCE, SCOPE_LENGTH

    sentences = {
        SCOPE_LENGTH: "a scope of {used}, as the run had; {task} has one of {own} now",
        PATIENCE: "an episode is stuck after {used}, as in the run; in {task} it is after {own} now",
    }
    for setting, sentence in sentences.items():
        used, own = setting.of(env_cfg), setting.registered(args.task)
        if used == own or any(text.startswith(f"env.{setting.field}=") for text in args.overrides):
            continue
        if setting is PATIENCE and None in (used, own):  # one of them never ends an episode as stuck
            continue
        told = sentence.format(used=setting.as_text(used), task=args.task, own=setting.as_text(own))
        value = "null" if own is None else f"{own:g}"
        print(f"note: {told}, which env.{setting.field}={value} gives it")


def _further_inputs(env: dict[str, Any], agent_cfg: Any) -> dict[str, Any]:
    """Return the further groups that a policy reads and what its groups have in ``terms``: else no other task fits."""
    groups = agent_cfg.obs_groups.get("actor") or agent_cfg.obs_groups.get("student", [])
    saved = env.get("observations", {})
    terms = {group: (saved.get(group) or {}).get("terms") for group in groups}
    found: dict[str, Any] = {"observations": {group: {"terms": added} for group, added in terms.items() if added}}
    extra = [name for name in env.get("extra_observations") or () if name in groups]
    return {**found, "extra_observations": extra} if extra else found


def _own_fields(env: dict[str, Any], env_cfg: Any) -> dict[str, Any]:
    """Return what a policy has beside its actions, a roll or going back, and brings to other tasks of its robot."""
    found: dict[str, Any] = {}
    for name, saved in (env.get("actions") or {}).items():
        term = getattr(getattr(env_cfg, "actions", None), name, None)
        fields = [field for field in POLICY_ACTION_FIELDS if saved and field in saved and hasattr(term, field)]
        own = {field: saved[field] for field in fields}
        found |= {name: own} if own else {}
    return {"actions": found} if found else {}


def with_trained_agent(args: A) -> A:
    """Return the arguments with the agent of the run that a checkpoint's path names, where none was asked for."""
    from arcgym.rl.params import read_params

    path = Path(args.checkpoint or "")
    if args.no_params or args.agent != DEFAULT_AGENT or not path.is_file():
        return args
    saved = read_params(path.parent)
    return replace(args, agent=saved.agent_key) if saved is not None and saved.agent_key else args


def refuse_run(args: RunArguments, why: str) -> None:
    """Raise if arguments choose a run or its checkpoint where none is read.

    Args:
        args: Arguments.
        why: What follows ``--checkpoint is given``.
    """
    for name in ("checkpoint", "load_run", "no_params"):
        if getattr(args, name):
            raise UsageError(f"--{name} is given {why}.")


def _registered(task: str, agent: str) -> tuple[Any, Any]:
    """Return the environment's and the agent's configuration as they are registered."""
    from arcgym.utils.registry import cfg_keys, load_cfg_from_registry

    known = cfg_keys(task)
    if known and agent_key(agent) not in known:
        raise UsageError(f"--agent is '{agent}', which {task} does not have. {did_you_mean(agent, agent_names(task))}")
    try:
        env_cfg = load_cfg_from_registry(task, "env_cfg_entry_point")
        return env_cfg, load_cfg_from_registry(task, agent_key(agent))
    except (TypeError, ValueError) as error:
        raise UsageError(str(error)) from error


def _write(args: TaskArguments, env_cfg: Any, agent_cfg: Any) -> None:
    """Write overrides, then arguments, into the configurations."""
    from arcgym.utils.hydra import apply_overrides

    try:
        apply_overrides({"env": env_cfg, "agent": agent_cfg}, args.overrides)
    except (TypeError, ValueError) as error:
        raise UsageError(str(error)) from error
    if any(text.lstrip("+").startswith("env.seed=") for text in args.overrides):
        agent_cfg.seed = env_cfg.seed  # runs give their environment the agent's
    for name in AGENT_FIELDS:
        if getattr(args, name, None) is not None:
            setattr(agent_cfg, name, getattr(args, name))
    agent_cfg.load_checkpoint = getattr(args, "checkpoint", None) or agent_cfg.load_checkpoint
    agent_cfg.resume = agent_cfg.resume or getattr(args, "resume", False)
    if args.num_envs is not None:
        env_cfg.scene.num_envs = args.num_envs
