# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Environments in NumPy arrays, as Gymnasium's vector wrappers and the libraries built on them expect."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from gymnasium.vector import AutoresetMode, VectorWrapper

from arcgym.envs.manager_based_rl_env import ManagerBasedRLEnv
from arcgym.utils.string import resolve_callable


def make_vec(entry_point: str, to_numpy: bool = True, **arguments: Any) -> ManagerBasedRLEnv | NumpyVectorEnv:
    """Build an environment for ``gymnasium.make_vec``, whose users expect NumPy arrays.

    Args:
        entry_point: ``"module:Class"`` of the environment.
        to_numpy: Whether it is shown in NumPy arrays; False returns the environment itself, with its torch tensors.
        arguments: As of :class:`arcgym.envs.ManagerBasedEnv`.
    """
    env = resolve_callable(entry_point)(**arguments)
    return NumpyVectorEnv(env) if to_numpy else env


class NumpyVectorEnv(VectorWrapper):
    """Shows an environment in NumPy arrays of their own; each step copies what it returns to the host.

    Infos are Gymnasium's: entries of worlds with masks, ``final_obs`` an array of objects, one a world. The logs of
    episodes that ended are means over worlds and stay in ``env.unwrapped.extras["log"]``.
    """

    def __init__(self, env: ManagerBasedRLEnv) -> None:
        """Wrap an environment and let it compute final observations, if it resets worlds by itself."""
        super().__init__(env)
        base: Any = env.unwrapped
        base.cfg.compute_final_obs = base.metadata["autoreset_mode"] is AutoresetMode.SAME_STEP

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Start new episodes; see :meth:`arcgym.envs.ManagerBasedEnv.reset`."""
        obs, extras = self.env.reset(seed=seed, options=options)
        return to_numpy(obs), self._infos(extras)

    def step(self, actions: Any) -> tuple[Any, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Advance every world by one control step; see :meth:`arcgym.envs.ManagerBasedRLEnv.step`."""
        obs, rewards, terminated, truncated, extras = self.env.step(actions)
        return to_numpy(obs), to_numpy(rewards), to_numpy(terminated), to_numpy(truncated), self._infos(extras)

    def render(self) -> tuple[np.ndarray, ...] | None:
        """Return a picture of every world, each as of :meth:`arcgym.envs.ManagerBasedEnv.render`: slow for many."""
        if self.render_mode is None:
            return None
        base: Any = self.unwrapped
        return tuple(base.render_world(world) for world in range(self.num_envs))

    def _infos(self, extras: dict[str, Any]) -> dict[str, Any]:
        """Return what extras say about each world."""
        infos = {name: to_numpy(value) for name, value in extras.items() if name != "log"}
        if "final_obs" in infos:
            ended = infos["_final_obs"]
            infos["final_obs"] = _one_a_world(infos["final_obs"], ended)
            infos["final_info"] = _with_masks(infos["final_info"], ended)
        return infos


def to_numpy(value: Any) -> Any:
    """Return a tensor, or a dict of them, as NumPy arrays that share no memory with it."""
    if isinstance(value, dict):
        return {name: to_numpy(child) for name, child in value.items()}
    return value.to("cpu", copy=True).numpy() if isinstance(value, torch.Tensor) else value


def _one_a_world(obs: dict[str, Any], ended: np.ndarray) -> np.ndarray:
    """Return the observations of the worlds that ended, None for the others, as an array of objects, shape (N,)."""
    entries = np.full(len(ended), None, dtype=object)
    for world in np.flatnonzero(ended):
        entries[world] = _of_world(obs, int(world))
    return entries


def _of_world(value: Any, world: int) -> Any:
    return {k: _of_world(v, world) for k, v in value.items()} if isinstance(value, dict) else value[world]


def _with_masks(info: dict[str, Any], ended: np.ndarray) -> dict[str, Any]:
    """Return nested infos with a mask beside each entry."""
    masked: dict[str, Any] = {}
    for name, value in info.items():
        masked[name] = _with_masks(value, ended) if isinstance(value, dict) else value
        masked[f"_{name}"] = ended
    return masked
