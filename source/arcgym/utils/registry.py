# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Tasks by name: registration with Gymnasium, discovery, and loading of their configurations.

Entry points are texts, so that listing tasks imports neither torch nor Newton. Packages elsewhere add tasks through the
entry-point group ``arcgym.tasks`` in their ``pyproject.toml``; the module it names registers them when imported::

    [project.entry-points."arcgym.tasks"]
    my_tasks = "my_package.tasks"
"""

from __future__ import annotations

import copy
import functools
import importlib
import importlib.metadata
import re
from typing import Any

import gymnasium

from arcgym.utils.errors import UsageError
from arcgym.utils.garbage import importing
from arcgym.utils.string import did_you_mean, nearest, resolve_callable

ENTRY_POINT_GROUP = "arcgym.tasks"
"""Entry-point group that is searched for task packages."""

BUILTIN_PACKAGES = ("arcgym_tasks",)
"""Packages that are searched whether or not they declare an entry point."""

CFG_SUFFIX = "_cfg_entry_point"
"""How the names of all configurations of a task end."""

VECTOR_ENTRY_POINT = "arcgym.envs.numpy_vector_env:make_vec"
"""Function that builds the environments of ``gymnasium.make_vec`` from the entry point of their class."""

PLAY = "-Play"
"""In the names of tasks that are made for watching: at the end, or before a version, ``My-Task-Play-v0``."""

_loaded: set[str] = set()


class TaskPackageError(UsageError, ImportError):
    """A package that registers tasks cannot be imported."""


def plain_task(task: str) -> str:
    """Return the task that a variant for watching is of: ``My-Task-v0`` for ``My-Task-Play-v0``; others as they are."""
    return re.sub(rf"{PLAY}(?=$|-v\d+$)", "", task)


def play_task(task: str) -> str:
    """Return the name that the variant of a task for watching has: ``My-Task-Play-v0`` for ``My-Task-v0``."""
    name, version = re.fullmatch(r"(.*?)(-v\d+)?", plain_task(task)).groups("")  # type: ignore[union-attr]
    return f"{name}{PLAY}{version}"


def register_task(
    task: str, *, env_cfg_entry_point: str, entry_point: str = "arcgym.envs:ManagerBasedRLEnv", **cfg_entry_points: str
) -> None:
    """Register a task with Gymnasium.

    Args:
        task: Name, e.g. ``"ARC-Splenic-Proximal"``.
        env_cfg_entry_point: ``"module:Class"`` of the environment's configuration.
        entry_point: ``"module:Class"`` of the environment.
        cfg_entry_points: Further configurations, e.g. ``rsl_rl_cfg_entry_point="module:Class"``.

    Raises:
        ValueError: If the name is taken, or that of a configuration does not end in :data:`CFG_SUFFIX`.
    """
    for key in cfg_entry_points:
        if not key.endswith(CFG_SUFFIX):
            raise ValueError(f"Task '{task}' names a configuration '{key}', expected a name that ends in {CFG_SUFFIX}.")
    if task in gymnasium.registry:
        owner = gymnasium.registry[task].kwargs.get("env_cfg_entry_point")
        raise ValueError(f"Task '{task}' is registered already, with the configuration {owner}.")
    kwargs = {"env_cfg_entry_point": env_cfg_entry_point, **cfg_entry_points}
    gymnasium.register(
        id=task,
        entry_point=entry_point,
        vector_entry_point=functools.partial(_make_vec, entry_point),
        disable_env_checker=True,
        order_enforce=False,
        kwargs=kwargs,
    )


def load_task_packages() -> None:
    """Import every package that registers tasks, each once.

    Raises:
        TaskPackageError: If a package cannot be imported, with its name and where it was declared.
    """
    found = {name: "built in" for name in BUILTIN_PACKAGES}
    for entry in importlib.metadata.entry_points(group=ENTRY_POINT_GROUP):
        found.setdefault(entry.value, f"entry point '{entry.name}' of {entry.dist.name if entry.dist else 'unknown'}")
    for module, origin in found.items():
        if module in _loaded:
            continue
        try:
            importlib.import_module(module)
        except ImportError as error:
            raise TaskPackageError(f"Cannot import the task package '{module}' ({origin}): {error}") from error
        _loaded.add(module)


def list_tasks(prefix: str = "ARC-") -> list[str]:
    """Return the names of all registered tasks that start with ``prefix``, sorted; other packages choose their own."""
    load_task_packages()
    specs = gymnasium.registry.items()
    return sorted(name for name, spec in specs if name.startswith(prefix) and "env_cfg_entry_point" in spec.kwargs)


def load_cfg_from_registry(task: str, key: str) -> Any:
    """Return a fresh configuration of a task.

    Args:
        task: Registered name.
        key: Which one: ``"env_cfg_entry_point"``, ``"rsl_rl_cfg_entry_point"``, ...

    Raises:
        ValueError: If the task or the key is unknown, with what there is.
    """
    load_task_packages()
    if task not in gymnasium.registry:
        known = list_tasks(prefix="")
        raise ValueError(f"Unknown task '{task}'. {nearest(task, known)}'arcgym list' shows all {len(known)}.")
    kwargs = gymnasium.registry[task].kwargs
    if key not in kwargs:
        raise ValueError(f"Task '{task}' has no '{key}'. {did_you_mean(key, kwargs)}")
    return load_cfg(kwargs[key])


def cfg_keys(task: str) -> list[str]:
    """Return the keys of a task's configurations, sorted; none where the task is unknown."""
    load_task_packages()
    spec = gymnasium.registry.get(task)
    return sorted(key for key in spec.kwargs if key.endswith(CFG_SUFFIX)) if spec else []


@importing()
def load_cfg(entry_point: Any) -> Any:
    """Return a fresh configuration; the first of a task imports torch and Newton for the terms that it names.

    Args:
        entry_point: Text ``"module:Class"``, a class, or an instance to copy.
    """
    value = resolve_callable(entry_point) if isinstance(entry_point, str) else entry_point
    return value() if callable(value) else copy.deepcopy(value)


def _make_vec(entry_point: str, **arguments: Any) -> Any:
    """Build a task's environment for ``gymnasium.make_vec``; the module that does it is loaded when it is called."""
    return resolve_callable(VECTOR_ENTRY_POINT)(entry_point, **arguments)
