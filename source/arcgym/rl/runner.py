# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""rsl_rl's on-policy runner with checkpoints that survive a kill."""

from __future__ import annotations

import os
import statistics
from pathlib import Path
from typing import Any

import torch
from rsl_rl.env import VecEnv
from rsl_rl.runners import OnPolicyRunner as RslRlOnPolicyRunner

from arcgym.rl.interrupt import InterruptGuard, TrainingInterrupted


class OnPolicyRunner(RslRlOnPolicyRunner):
    """On-policy runner that

    * writes checkpoints whole or not at all, and one more on Ctrl-C or SIGTERM,
    * resumes with the next iteration and with the environment's step counter, so that curricula go on,
    * keeps ``model_best.pt``, the checkpoint with the highest mean episode reward.
    """

    def __init__(self, env: VecEnv, train_cfg: dict, log_dir: str | None = None, device: str = "cpu"):
        """Build algorithm and logger; arguments as in rsl_rl."""
        super().__init__(env, train_cfg, log_dir, device)
        self.completed_iterations = 0
        self.best_reward = float("-inf")
        if not train_cfg.get("store_git_diff", False):
            self.logger.git_status_repos.clear()

    def learn(self, num_learning_iterations: int, init_at_random_ep_len: bool = False) -> None:
        """Run updates; on a signal save a checkpoint and raise :class:`TrainingInterrupted`.

        Args:
            num_learning_iterations: Updates to run, on top of those already done.
            init_at_random_ep_len: Whether the worlds start at random places of their time limit.
        """
        update = self.alg.update
        with InterruptGuard() as guard:
            self.alg.update = lambda: self._update(update, guard)  # type: ignore[method-assign]
            try:
                super().learn(num_learning_iterations, init_at_random_ep_len)
            except TrainingInterrupted:
                self._save_interrupted()
                raise
            finally:
                self.alg.update = update  # type: ignore[method-assign]

    def save(self, path: str, infos: dict | None = None) -> None:
        """Write a checkpoint through a temporary file, so that ``path`` is complete whenever it exists."""
        counters = {
            "completed_iterations": self.completed_iterations,
            "common_step_counter": int(self.env.unwrapped.common_step_counter),  # type: ignore[attr-defined]
            "best_reward": self._update_best(path),
        }
        checkpoint = {
            **self.alg.save(),
            "iter": self.current_learning_iteration,
            "infos": {**counters, **(infos or {})},
        }
        temporary = f"{path}.tmp"
        torch.save(checkpoint, temporary)
        os.replace(temporary, path)
        self.logger.save_model(path, self.current_learning_iteration)

    def load(
        self, path: str, load_cfg: dict | None = None, strict: bool = True, map_location: str | None = None
    ) -> dict:
        """Load a checkpoint and go on from the iteration after it.

        Returns:
            The ``infos`` saved with it.
        """
        infos = super().load(path, load_cfg, strict, map_location or self.device) or {}
        self.completed_iterations = int(infos.get("completed_iterations", 0))
        self.current_learning_iteration = self.completed_iterations
        self.best_reward = infos.get("best_reward", self.best_reward)
        self.env.unwrapped.common_step_counter = infos.get("common_step_counter", 0)  # type: ignore[attr-defined]
        return infos

    def _update(self, update: Any, guard: InterruptGuard) -> dict[str, float]:
        with guard.hold():
            losses = update()
            self.completed_iterations += 1
        return losses

    def _save_interrupted(self) -> None:
        if self.logger.log_dir is not None and not self.logger.disable_logs:
            self.save(str(Path(self.logger.log_dir) / f"model_{max(self.completed_iterations - 1, 0)}.pt"))
            self.logger.stop_logging_writer()

    def _update_best(self, path: str) -> float:
        """Write ``model_best.pt`` beside ``path`` when the mean episode reward is a new best; return the best."""
        reward = statistics.mean(self.logger.rewbuffer) if self.logger.rewbuffer else float("-inf")
        best = Path(path).with_name("model_best.pt")
        if reward > self.best_reward and Path(path) != best:
            self.best_reward = reward
            self.save(str(best))
        return self.best_reward
