# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Runner of PPO whose policy is also drawn to what a teacher would do, less and less."""

from __future__ import annotations

from arcgym.rl.learning_rate import linear_rate
from arcgym.rl.runner import OnPolicyRunner
from arcgym.rl.teacher import load_teacher


class TaughtRunner(OnPolicyRunner):
    """The on-policy runner around :class:`arcgym.rl.algorithms.ppo_taught.PPOTaught`.

    The teacher is the actor of a PPO checkpoint, ``cfg["teacher_checkpoint"]``; a resumed run brings its own.
    """

    def learn(self, num_learning_iterations: int, init_at_random_ep_len: bool = False) -> None:
        """Load the teacher unless a checkpoint brought it, and learn.

        Raises:
            UsageError: If there is no teacher.
        """
        load_teacher(self.alg, self.cfg.get("teacher_checkpoint"), self.device)
        super().learn(num_learning_iterations, init_at_random_ep_len)

    def _decay(self) -> None:
        """Set this iteration's learning rate, and its weight of the lesson."""
        super()._decay()
        settings, alg = self.cfg["algorithm"], self.alg
        alg.lesson_coef = linear_rate(  # type: ignore[attr-defined]
            settings["lesson_coef"], settings["final_lesson_coef"], self.share_done
        )
