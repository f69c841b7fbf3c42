# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""An environment made of managers for reinforcement learning."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import torch
from gymnasium.vector import AutoresetMode

from arcgym.envs.manager_based_env import ManagerBasedEnv
from arcgym.envs.manager_based_rl_env_cfg import ManagerBasedRLEnvCfg
from arcgym.managers import CostManager, CurriculumManager, MetricsManager, RewardManager, TerminationManager
from arcgym.managers.observation_manager import Observation
from arcgym.utils.threads import one_thread
from arcgym.utils.transfer import HostCopy, send
from arcgym.utils.worlds import fill_worlds, finite

StepReturn = tuple[dict[str, Observation], torch.Tensor, torch.Tensor, torch.Tensor, dict[str, Any]]
"""Observations, reward (N,), terminated (N,), truncated (N,), extras."""


class ManagerBasedRLEnv(ManagerBasedEnv):
    """Adds rewards, costs, terminations, metrics and a curriculum; a world that is done starts again by itself.

    A world whose state is not finite is terminated, reset and counted in :attr:`world_failures`; its reward is finite,
    and the other worlds go on.

    A step waits for the device once: for the indices of the worlds to reset. Where no termination looks at a sensor it
    does not wait for the pictures, which are drawn while the host prepares the resets.
    """

    cfg: ManagerBasedRLEnvCfg

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "autoreset_mode": AutoresetMode.SAME_STEP}

    num_done: int = 0
    """Worlds whose episode the last step ended, and which it reset."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        """Build scene and managers; arguments as of :class:`ManagerBasedEnv`."""
        super().__init__(*args, **kwargs)
        if not self.cfg.autoreset:
            self.metadata["autoreset_mode"] = AutoresetMode.DISABLED

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

    @property
    def failed(self) -> torch.Tensor:
        """Worlds whose state was not finite in the last step, bool, shape (N,)."""
        return self._failed

    @property
    def succeeded(self) -> torch.Tensor:
        """Worlds whose episode the last step ended as a success, bool, shape (N,); none of those that failed."""
        return self.termination_manager.success & ~self._failed

    def load_managers(self) -> None:
        """Build the managers; terms may look at the managers built before them."""
        super().load_managers()
        self.termination_manager = TerminationManager(self.cfg.terminations, self)
        self.reward_manager = RewardManager(self.cfg.rewards, self)
        self.cost_manager = CostManager(self.cfg.costs, self)
        self.metrics_manager = MetricsManager(self.cfg.metrics, self)
        self.curriculum_manager = CurriculumManager(self.cfg.curriculum, self)

    @one_thread()
    @torch.inference_mode(False)
    @torch.no_grad()
    def step(self, action: torch.Tensor | np.ndarray) -> StepReturn:  # type: ignore[override]
        """Advance every world by one control step and reset those that are done.

        Rewards belong to the state before the reset, observations to the state after it.

        Args:
            action: Action of every world, shape (N, A). A world whose action is NaN ends as one whose state is not
                finite, ``Episode_Termination/non_finite``, with a reward of zero; the others go on.

        Returns:
            Observation of each group; reward, shape (N,); terminated and truncated, bool, shape (N,); and extras with
            ``log`` (of the episodes that ended), ``time_outs`` (N,), ``cost`` (N,), ``costs`` (each term's part of it)
            and, with ``cfg.compute_final_obs`` and if a world is done, ``final_obs`` and ``final_info`` (see
            :meth:`_final`), valid in the worlds that ``_final_obs`` and ``_final_info`` mark, bool, shape (N,).
        """
        self.extras = {"log": {}}
        self._move(action)
        self.episode_length_buf += 1
        self._update_sensors_and_terminations()
        self._compute_rewards_and_metrics()
        self.recorder_manager.record_post_step()
        self.event_manager.apply("interval", dt=self.step_dt)
        if self.cfg.autoreset:
            self._reset_done()
        self.obs_buf = self.observation_manager.compute()
        return self.obs_buf, self.reward_buf, self.reset_terminated, self.reset_time_outs, self.extras

    def _init_buffers(self) -> None:
        num_envs, device = self.num_envs, self.device
        self.episode_length_buf = torch.zeros(num_envs, dtype=torch.long, device=device)
        self.reward_buf = torch.zeros(num_envs, device=device)
        self.reset_terminated = torch.zeros(num_envs, dtype=torch.bool, device=device)
        self.reset_time_outs = torch.zeros_like(self.reset_terminated)
        self.reset_buf = torch.zeros_like(self.reset_terminated)
        self._done_on_host = HostCopy(self.reset_buf)
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

    def _update_sensors_and_terminations(self) -> None:
        """Read the sensors, and find the worlds that are done: first if no termination looks at a sensor."""
        if self.termination_manager.reads_sensors:
            self.scene.update(self.step_dt)
            self._compute_terminations()
        else:
            self._compute_terminations()
            self.scene.update(self.step_dt)

    def _compute_terminations(self) -> None:
        """Compute the terminations, and ask for the worlds to reset."""
        self.termination_manager.compute()
        self._failed = self.sim.non_finite.clone()
        self._world_failures += self._failed.sum()
        self.reset_terminated = self.termination_manager.terminated | self._failed
        self.reset_time_outs = self.termination_manager.time_outs & ~self._failed
        self.reset_buf = self.reset_terminated | self.reset_time_outs
        if self.cfg.autoreset:
            self._done_on_host.ask(self.reset_buf)

    def _compute_rewards_and_metrics(self) -> None:
        """Compute reward, costs and metrics of the step."""
        dt = self.step_dt if self.cfg.scale_rewards_by_dt else 1.0
        self.reward_buf = self.reward_manager.compute(dt)
        self.extras["cost"] = self.cost_manager.compute(dt)
        self.extras["costs"] = self.cost_manager.step_parts
        self.extras["time_outs"] = self.reset_time_outs
        self.metrics_manager.compute()

    def _reset_done(self) -> None:
        """Start a new episode in every world that is done, after a last look at the old one where it is asked for."""
        host_ids = self._done_on_host.wait().nonzero().flatten()
        self.num_done = len(host_ids)
        if len(host_ids) > 0:
            if self.cfg.compute_final_obs:
                self.extras |= self._final()
            env_ids = send(host_ids, self.device)
            self._known_ids = (env_ids, host_ids)
            self._start(env_ids, self.reset_buf)

    def _final(self) -> dict[str, Any]:
        """Return Gymnasium's ``final_obs`` and ``final_info`` of the worlds that are done, with their masks.

        ``final_obs`` has the observation of each group before the reset. ``final_info`` has ``success``, bool,
        ``episode_length`` [control steps] and ``metrics``, each term's value of the episode; all shape (N,).
        """
        info = {
            "success": self.succeeded,
            "episode_length": self.episode_length_buf.clone(),
            "metrics": {name: self.metrics_manager.get_value(name) for name in self.metrics_manager.active_terms},
        }
        obs = _finite(self.observation_manager.compute(update_history=False))
        return {"final_obs": obs, "_final_obs": self.reset_buf, "final_info": info, "_final_info": self.reset_buf}

    def _reset_idx(self, env_ids: torch.Tensor) -> None:
        self.curriculum_manager.compute(env_ids)
        super()._reset_idx(env_ids)
        fill_worlds(self.episode_length_buf, env_ids, 0)
        self.extras["log"]["Episode_Termination/non_finite"] = self._failed[env_ids].sum(dtype=torch.float32)


def _finite(obs: dict[str, Any]) -> dict[str, Any]:
    """Replace what is not finite by zero, whatever the groups' policies: the observed world has failed."""
    return {name: _finite(value) if isinstance(value, dict) else finite(value) for name, value in obs.items()}
