# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Checks of an agent against its environment before either is built."""

from __future__ import annotations

import importlib.util
import inspect
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import torch
from rsl_rl.modules import CNN
from rsl_rl.utils import resolve_callable as resolve_in_rsl_rl

from arcgym.rl.params import BEGUN_FROM
from arcgym.utils.configclass import copy
from arcgym.utils.errors import UsageError
from arcgym.utils.string import did_you_mean

LOGGER_PACKAGES = {"tensorboard": "tensorboard", "wandb": "wandb", "neptune": "neptune"}
"""Package that each logger needs."""


def check_agent(env_cfg: Any, agent_cfg: Any, trains: bool) -> None:
    """Raise unless the agent fits the environment and all that it needs is installed.

    Args:
        env_cfg: Configuration of the environment, checked; looked at as the environment will resolve it.
        agent_cfg: Configuration of the agent.
        trains: Whether there will be updates, and curves to log.

    Raises:
        UsageError: The first thing that does not fit, or is missing.
    """
    _check_classes(agent_cfg)
    env_cfg = copy(env_cfg)
    env_cfg.resolve()
    _check_groups(env_cfg, agent_cfg)
    for name in agent_cfg.obs_groups:
        _check_images(env_cfg, agent_cfg, name)
    if trains:
        if not agent_cfg.resume:
            _check_begun_from(agent_cfg)
        num_mini_batches = getattr(agent_cfg.algorithm, "num_mini_batches", 1)
        check_batches(env_cfg.scene.num_envs, agent_cfg.num_steps_per_env, num_mini_batches)
        if hasattr(getattr(agent_cfg, "actor", None), "rnn_type"):
            check_batches_of_worlds(env_cfg.scene.num_envs, num_mini_batches)
        check_installed(LOGGER_PACKAGES.get(agent_cfg.logger, "tensorboard"), f"agent.logger={agent_cfg.logger}")


def check_batches(num_envs: int, num_steps: int, num_mini_batches: int) -> None:
    """Raise if a mini-batch would be empty, which makes every loss NaN."""
    if num_envs * num_steps < num_mini_batches:
        raise UsageError(
            f"agent.algorithm.num_mini_batches is {num_mini_batches}, but {num_envs} worlds x {num_steps} steps make "
            f"only {num_envs * num_steps} transitions; lower it, or raise --num_envs or agent.num_steps_per_env."
        )


def check_batches_of_worlds(num_envs: int, num_mini_batches: int) -> None:
    """Raise if a mini-batch of a policy with memory, which is of whole worlds, would have fewer than two.

    With one, rsl_rl's ``squeeze`` drops its axis, and each step's probability is set against those of all others.
    """
    if num_envs < 2 * num_mini_batches:
        raise UsageError(
            f"agent.algorithm.num_mini_batches is {num_mini_batches}, but there are {num_envs} worlds, and a policy "
            "with memory learns on mini-batches of two whole worlds or more; lower it, or raise --num_envs."
        )


def check_installed(package: str, reason: str, extra: str | None = None) -> None:
    """Raise if a package is missing.

    Args:
        package: Name to import.
        reason: What needs it, as it was asked for.
        extra: Extra of ARCGym that brings it, or None for a package of its own.
    """
    if importlib.util.find_spec(package) is None:
        install = f"arcgym[{extra}]" if extra else package
        raise UsageError(f"{reason} needs the package '{package}', which is not installed: pip install '{install}'.")


def _check_begun_from(agent_cfg: Any) -> None:
    """Raise if a checkpoint that a new run begins from is missing, or a teacher is not given."""
    for name in BEGUN_FROM:
        path = getattr(agent_cfg, name, None)
        if path and not Path(path).is_file():
            raise UsageError(f"agent.{name} is '{path}', and there is no such file; expected a checkpoint.")
        if path == "":
            raise UsageError(f"agent.{name} is not set; expected a checkpoint, such as one of --agent ppo_teacher.")


def _check_classes(agent_cfg: Any) -> None:
    parts = {f"agent.{name}": value for name, value in vars(agent_cfg).items() if hasattr(value, "class_name")}
    owners = {"agent": agent_cfg, **parts}
    for path, owner in owners.items():
        try:
            resolve_in_rsl_rl(owner.class_name)
        except (ImportError, AttributeError, ValueError, TypeError) as error:
            raise UsageError(f"{path}.class_name is '{owner.class_name}', which cannot be loaded: {error}") from error


def _check_groups(env_cfg: Any, agent_cfg: Any) -> None:
    groups = _entries(env_cfg.observations)
    for name, wanted in agent_cfg.obs_groups.items():
        if getattr(agent_cfg, name, None) is None:
            raise UsageError(f"agent.obs_groups has '{name}', and {type(agent_cfg).__name__} has no such model.")
        for group in wanted:
            if groups.get(group) is None:
                raise UsageError(
                    f"agent.obs_groups.{name} reads '{group}', which is no observation group of the environment. "
                    f"{did_you_mean(group, [key for key, value in groups.items() if value is not None])}"
                )


def _check_images(env_cfg: Any, agent_cfg: Any, name: str) -> None:
    """Raise if the images that a model reads are too small for its encoder."""
    model = getattr(agent_cfg, name, None)
    cnn_cfg, shrink = getattr(model, "cnn_cfg", None), getattr(model, "shrink", 1)
    if cnn_cfg is None:
        return
    for group in agent_cfg.obs_groups.get(name, ()):
        for camera, full_height, full_width in _images(env_cfg, group):
            if full_height % shrink or full_width % shrink:
                raise UsageError(
                    f"agent.{name}.shrink is {shrink}, which does not divide the {full_height}x{full_width} px images "
                    f"of env.scene.{camera}."
                )
            height, width = full_height // shrink, full_width // shrink
            try:
                with torch.device("meta"):
                    CNN((height, width), 1, **cnn_cfg.to_dict())(torch.empty(1, 1, height, width))
            except (RuntimeError, IndexError, TypeError, ValueError) as error:
                raise UsageError(
                    f"agent.{name}.cnn_cfg does not fit the {height}x{width} px images of env.scene.{camera}: "
                    f"kernel_size={cnn_cfg.kernel_size}, stride={cnn_cfg.stride}. Enlarge the camera's height and "
                    f"width, or lower kernels and strides. ({str(error).splitlines()[0]})"
                ) from error


def _images(env_cfg: Any, group: str) -> Iterator[tuple[str, int, int]]:
    """Yield name, height and width [px] of each camera whose images a group observes."""
    own = _entries(_entries(env_cfg.observations)[group])
    for term in (*own.values(), *(own.get("terms") or {}).values()):
        func = getattr(term, "func", None)
        if not callable(func):
            continue
        defaults = {name: value.default for name, value in inspect.signature(func).parameters.items()}
        sensor = {**defaults, **term.params}.get("sensor_cfg")
        camera = getattr(env_cfg.scene, getattr(sensor, "name", ""), None)
        if hasattr(camera, "width") and hasattr(camera, "height"):
            yield sensor.name, camera.height, camera.width  # type: ignore[union-attr]


def _entries(cfg: Any) -> dict[str, Any]:
    """Return the fields of a configuration class or the items of a dict."""
    return dict(cfg) if isinstance(cfg, dict) else dict(vars(cfg))
