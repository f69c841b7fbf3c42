# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Runner that teaches a student what a privileged teacher would do (DAgger; Ross et al. 2011)."""

from __future__ import annotations

from arcgym.rl.runner import OnPolicyRunner
from arcgym.rl.teacher import load_teacher


class DistillationRunner(OnPolicyRunner):
    """The on-policy runner around rsl_rl's ``Distillation``: the student acts, the teacher names the better action.

    The teacher is the actor of a PPO checkpoint, ``cfg["teacher_checkpoint"]``; a resumed run brings its own. The
    student may begin as another run's policy, ``cfg["init_policy"]``.
    """

    policy_name = "student"
    """Name of the policy among the algorithm's models and in its checkpoints."""

    def learn(self, num_learning_iterations: int, init_at_random_ep_len: bool = False) -> None:
        """Load the teacher unless a checkpoint brought it, and learn.

        Raises:
            UsageError: If there is no teacher.
        """
        load_teacher(self.alg, self.cfg.get("teacher_checkpoint"), self.device)
        super().learn(num_learning_iterations, init_at_random_ep_len)

    def load(
        self, path: str, load_cfg: dict | None = None, strict: bool = True, map_location: str | None = None
    ) -> dict:
        """Load a checkpoint; ``{"actor": True}``, as for playing, means the student."""
        wanted = {self.policy_name: True} if load_cfg == {"actor": True} else load_cfg
        return super().load(path, wanted, strict, map_location)
