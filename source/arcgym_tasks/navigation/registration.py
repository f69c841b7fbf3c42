# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Registers the tasks of a robot: each segment and the longer ways, with a ``-Play`` variant.

Imports neither torch nor Newton.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from arcgym.utils.registry import register_task
from arcgym.utils.string import did_you_mean, resolve_callable
from arcgym_tasks.navigation.agents import AGENTS
from arcgym_tasks.navigation.segments import JOURNEYS, TIME_LIMIT_S, ConfigClass


@dataclass(frozen=True)
class CfgEntry:
    """Entry point of a configuration: a class, and the fields that a task sets in its instance."""

    target: str | Callable[[], Any]
    """Class, or its name ``"module:Class"``, which is imported when the configuration is asked for."""
    fields: tuple[tuple[str, Any], ...] = ()
    """Names and values of the fields that the task sets."""
    play: bool = False
    """Whether to call the configuration's ``play()`` last."""

    def __call__(self) -> Any:
        """Return a fresh configuration."""
        cfg = (resolve_callable(self.target) if isinstance(self.target, str) else self.target)()
        for name, value in self.fields:
            setattr(cfg, name, resolve_callable(value.target)() if isinstance(value, ConfigClass) else value)
        if self.play:
            cfg.play()
        return cfg

    def __str__(self) -> str:
        """Return the class and the fields, as ``arcgym list --cfgs`` shows them."""
        fields = ", ".join(f"{name}={value!r}" for name, value in self.fields)
        target = self.target if isinstance(self.target, str) else getattr(self.target, "__name__", repr(self.target))
        return f"{target}({fields}){'.play()' if self.play else ''}"


def register_robot(
    robot: str,
    env_cfg: str | Callable[[], Any],
    *,
    segments: Sequence[str] = tuple(TIME_LIMIT_S),
    journeys: Mapping[str, Mapping[str, Any]] = JOURNEYS,
    agents: Mapping[str, str | Callable[[], Any]] | None = None,
) -> list[str]:
    """Register ``ARC-<Segment>-<Robot>`` and ``ARC-<Segment>-<Robot>-Play`` for every segment and every journey.

    Segment, time limit and experiment name follow from the names.

    Args:
        robot: Name as written in task names, such as ``Proximal``.
        env_cfg: Subclass of :class:`arcgym_tasks.navigation.navigation_env_cfg.NavigationEnvCfg` with the robot and its
            actions, or its name ``"module:Class"``.
        segments: Segments to pass, lower case.
        journeys: Longer ways by their name in the task, with the fields of the configuration that they set. A
            ``scope_length`` among them is for the scopes that come in several lengths; others keep theirs.
        agents: Agent configurations by registry key, added to
            :data:`arcgym_tasks.navigation.agents.AGENTS` or in their place.

    Returns:
        Names of the tasks.

    Raises:
        ValueError: If a task is registered already, or there is no such segment.
    """
    tasks = []
    _check_segments(robot, segments)
    ways = {**{name.capitalize(): {"segment": name} for name in segments}, **journeys}
    for name, fields in ways.items():
        tasks += register_navigation_task(f"ARC-{name}-{robot}", env_cfg, agents=agents, **fields)
    return tasks


def _check_segments(robot: str, names: Sequence[str]) -> None:
    """Raise if there is no such segment."""
    for name in names:
        if name not in TIME_LIMIT_S:
            from arcgym.anatomy.segments import SEGMENTS  # brings USD, which a list of tasks can do without

            if name not in SEGMENTS:
                hint = did_you_mean(name, dict.fromkeys((*SEGMENTS, *TIME_LIMIT_S)))
                raise ValueError(f"register_robot('{robot}', …) names the segment '{name}'. {hint}")


def register_navigation_task(
    task: str,
    env_cfg: str | Callable[[], Any],
    *,
    agents: Mapping[str, str | Callable[[], Any]] | None = None,
    **fields: Any,
) -> list[str]:
    """Register a task and its variant ``-Play``, with every agent, each of which logs to a folder of its own.

    Args:
        task: Name, such as ``My-Rectum``.
        env_cfg: Subclass of :class:`arcgym_tasks.navigation.navigation_env_cfg.NavigationEnvCfg`, or its name
            ``"module:Class"``.
        agents: Agent configurations by registry key, added to
            :data:`arcgym_tasks.navigation.agents.AGENTS` or in their place.
        fields: Fields of the configuration that the task sets, such as ``segment="rectum"``.

    Returns:
        Names of the two.

    Raises:
        ValueError: If a task is registered already.
    """
    entries: dict[str, Any] = {
        key: CfgEntry(cfg, (("experiment_name", _experiment(task, key)),))
        for key, cfg in {**AGENTS, **(agents or {})}.items()
    }
    for variant, play in (("", False), ("-Play", True)):
        entry: Any = CfgEntry(env_cfg, tuple(fields.items()), play)
        register_task(task + variant, env_cfg_entry_point=entry, **entries)
    return [task, f"{task}-Play"]


def _experiment(task: str, key: str) -> str:
    """Folder of an agent's runs: ``arc_splenic_magnetic``, and ``arc_splenic_magnetic_sac`` for another than PPO."""
    agent = key.removesuffix("cfg_entry_point").removeprefix("rsl_rl_").strip("_")
    return "_".join(filter(None, (task.lower().replace("-", "_"), agent)))
