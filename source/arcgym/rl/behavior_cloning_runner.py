# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Runner of behavior cloning."""

from __future__ import annotations

import time
from typing import Any, NoReturn

import torch
from rsl_rl.env import VecEnv

from arcgym.rl.expert_demonstrations import ask_expert
from arcgym.rl.expert_policy import ExpertPolicy
from arcgym.rl.interrupt import InterruptGuard
from arcgym.rl.runner import OnPolicyRunner
from arcgym.utils.errors import UsageError

EXPERT = "expert"
"""Demonstrations that mean the robot's scripted expert."""


class BehaviorCloningRunner(OnPolicyRunner):
    """The on-policy runner; a run that will be logged reads its demonstrations at once, playing needs none.

    With ``demonstrations=expert`` it asks the robot's scripted expert when learning begins; what the expert does counts
    among the run's transitions and minutes.
    """

    def __init__(self, env: VecEnv, train_cfg: dict, log_dir: str | None = None, device: str = "cpu"):
        """Build algorithm and logger; arguments as in rsl_rl.

        Raises:
            UsageError: The demonstrations are missing or do not fit the task.
        """
        super().__init__(env, train_cfg, log_dir, device)
        self._asks_expert = self.alg.folder == EXPERT  # type: ignore[attr-defined]
        if log_dir is not None and not self._asks_expert:
            self._describe()

    def learn(self, num_learning_iterations: int, init_at_random_ep_len: bool = False) -> None:
        """Ask the expert where the configuration says so, and learn; see :class:`OnPolicyRunner`.

        Raises:
            UsageError: Asking the expert took all the minutes; the checkpoint would have learnt nothing.
        """
        if self._asks_expert and not self.clock.is_over:
            self._ask_expert()
        super().learn(num_learning_iterations, init_at_random_ep_len)

    def _ask_expert(self) -> None:
        """Ask for the steps, count them and their time, and let the expert go on where it is asked on.

        Raises:
            TrainingInterrupted: A signal came.
            UsageError: The time was over before the expert was.
        """
        alg: Any = self.alg
        start, steps_before = time.perf_counter(), self.env.unwrapped.common_step_counter  # type: ignore[attr-defined]

        def check() -> None:
            took = self.clock.seconds + time.perf_counter() - start
            if self.clock.max_seconds is not None and took >= self.clock.max_seconds:
                self._end_in_vain(start)

        expert = ExpertPolicy(self.env, **alg.expert_settings)
        with InterruptGuard():
            noise, successful = alg.expert_noise, alg.successful_only
            alg.take(ask_expert(self.env, expert, alg.groups, self.device, alg.expert_steps, noise, successful, check))
        steps = self.env.unwrapped.common_step_counter - steps_before  # type: ignore[attr-defined]
        self.clock.add(time.perf_counter() - start, steps * self.env.num_envs * self.gpu_world_size)
        self._describe()
        if alg.asks_on:
            expert.reset(torch.ones(self.env.num_envs, device=self.device))
            alg.expert = expert
        if self.clock.is_over:
            self._end_in_vain(start)

    def _end_in_vain(self, start: float) -> NoReturn:
        raise UsageError(
            f"Asking the expert took {(time.perf_counter() - start) / 60.0:.1f} minutes, all of agent."
            f"{self.clock.limit}, and nothing was learnt: give more, or fewer agent.algorithm.expert_steps, which are "
            "asked for in whole episodes."
        )

    def _describe(self) -> None:
        demonstrations = self.alg.read_demonstrations()  # type: ignore[attr-defined]
        print(f"demonstrations: {demonstrations.num_episodes} episodes, {len(demonstrations)} steps")
