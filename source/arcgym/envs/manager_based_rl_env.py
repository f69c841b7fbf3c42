# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""An environment made of managers for reinforcement learning."""

from __future__ import annotations

import math
from typing import Any

import torch

from arcgym.envs.manager_based_env import ManagerBasedEnv
from arcgym.envs.manager_based_rl_env_cfg import ManagerBasedRLEnvCfg
from arcgym.managers import CostManager, CurriculumManager, MetricsManager, RewardManager, TerminationManager
from arcgym.managers.observation_manager import Observation
from arcgym.utils.registry import load_cfg
from arcgym.utils.threads import one_thread
from arcgym.utils.worlds import fill_worlds, finite

StepReturn = tuple[dict[str, Observation], torch.Tensor, torch.Tensor, torch.Tensor, dict[str, Any]]
"""Observations, reward (N,), terminated (N,), truncated (N,), extras."""


class ManagerBasedRLEnv(ManagerBasedEnv):
    """Adds rewards, costs, terminations, metrics and a curriculum; a world that is done starts again by itself.

    A world whose state is not finite is terminated, reset and counted in :attr:`world_failures`; its reward is finite,
    and the other worlds go on.

    A step waits for the device once: for the indices of the worlds to reset.
    """

    cfg: ManagerBasedRLEnvCfg

    def __init__(
        self,
        cfg: ManagerBasedRLEnvCfg | None = None,
        render_mode: str | None = None,
        *,
        env_cfg_entry_point: str | None = None,
        **other_entry_points: str,
    ) -> None:
        """Builds scene and managers; see :class:`ManagerBasedEnv`.

        Args:
            cfg: Configuration; None takes the one that the task was registered with.
            render_mode: ``"rgb_array"`` for :meth:`render`, or None.
            env_cfg_entry_point: The registered configuration, given by ``gymnasium.make``.
            other_entry_points: Configurations of learners; not used here.

        Raises:
            TypeError: If there is no configuration.
        """
        if cfg is None and env_cfg_entry_point is None:
            raise TypeError("ManagerBasedRLEnv needs a cfg, or gymnasium.make with the name of a registered task.")
        cfg = load_cfg(env_cfg_entry_point) if cfg is None else cfg
        super().__init__(cfg, render_mode)

    @property
    def max_episode_length_s(self) -> float:
        """Longest episode [s]."""
        return self.cfg.max_episode_length_s

    @property
    def max_episode_length(self) -> int:
        """Longest episode [control steps]."""
        return math.ceil(round(self.max_episode_length_s / self.step_dt, 6))

    @property
    def world_failures(self) -> int:
        """How often a world was reset because its state was not finite. Reading it waits for the device."""
        return int(self._world_failures)

    def load_managers(self) -> None:
        """Builds the managers; terms may look at the managers built before them."""
        super().load_managers()
        self.termination_manager = TerminationManager(self.cfg.terminations, self)
        self.reward_manager = RewardManager(self.cfg.rewards, self)
        self.cost_manager = CostManager(self.cfg.costs, self)
        self.metrics_manager = MetricsManager(self.cfg.metrics, self)
        self.curriculum_manager = CurriculumManager(self.cfg.curriculum, self)

    @one_thread()
    @torch.inference_mode(False)
    @torch.no_grad()
    def step(self, action: torch.Tensor) -> StepReturn:  # type: ignore[override]
        """Advances every world by one control step and resets those that are done.

        Rewards belong to the state before the reset, observations to the state after it.

        Args:
            action: Action of every world, shape (N, A).

        Returns:
            Observation of each group; reward, shape (N,); terminated and truncated, bool, shape (N,); and extras with
            ``log`` (of the episodes that ended), ``time_outs`` (N,), ``cost`` (N,), ``costs`` (each term's part of it)
            and, on request and if a world is done, ``final_obs``.
        """
        self.extras = {"log": {}}
        self._advance(action)
        self.episode_length_buf += 1
        self._judge()
        self.recorder_manager.record_post_step()
        self.event_manager.apply("interval", dt=self.step_dt)
        env_ids = self.reset_buf.nonzero().flatten()
        if len(env_ids) > 0:
            if self.cfg.compute_final_obs:
                self.extras["final_obs"] = _finite(self.observation_manager.compute(update_history=False))
            self._reset_idx(env_ids)
            self.sim.forward()
            self.scene.update(0.0, env_mask=self.reset_buf)
            self.recorder_manager.record_post_reset(env_ids)
        self.obs_buf = self.observation_manager.compute()
        return self.obs_buf, self.reward_buf, self.reset_terminated, self.reset_time_outs, self.extras

    def _init_buffers(self) -> None:
        num_envs, device = self.num_envs, self.device
        self.episode_length_buf = torch.zeros(num_envs, dtype=torch.long, device=device)
        self.reward_buf = torch.zeros(num_envs, device=device)
        self.reset_terminated = torch.zeros(num_envs, dtype=torch.bool, device=device)
        self.reset_time_outs = torch.zeros_like(self.reset_terminated)
        self.reset_buf = torch.zeros_like(self.reset_terminated)
        self._failed = torch.zeros_like(self.reset_terminated)
        self._world_failures = torch.zeros((), dtype=torch.long, device=device)

    def _managers(self) -> list[Any]:
        return [
            *super()._managers(),
            self.termination_manager,
            self.reward_manager,
            self.cost_manager,
            self.metrics_manager,
            self.curriculum_manager,
        ]

    def _judge(self) -> None:
        """Computes terminations, reward, costs and metrics of the step."""
        self.termination_manager.compute()
        self._failed = self.sim.non_finite.clone()
        self._world_failures += self._failed.sum()
        self.reset_terminated = self.termination_manager.terminated | self._failed
        self.reset_time_outs = self.termination_manager.time_outs & ~self._failed
        self.reset_buf = self.reset_terminated | self.reset_time_outs
        dt = self.step_dt if self.cfg.scale_rewards_by_dt else 1.0
        self.reward_buf = self.reward_manager.compute(dt)
        self.extras["cost"] = self.cost_manager.compute(dt)
        self.extras["costs"] = self.cost_manager.step_parts
        self.extras["time_outs"] = self.reset_time_outs
        self.metrics_manager.compute()

    def _reset_idx(self, env_ids: torch.Tensor) -> None:
        self.curriculum_manager.compute(env_ids)
        super()._reset_idx(env_ids)
        fill_worlds(self.episode_length_buf, env_ids, 0)
        self.extras["log"]["Episode_Termination/non_finite"] = self._failed[env_ids].sum().float()


def _finite(obs: dict[str, Any]) -> dict[str, Any]:
    """Replaces what is not finite by zero, whatever the groups' policies: the observed world has failed."""
    return {name: _finite(value) if isinstance(value, dict) else finite(value) for name, value in obs.items()}
