# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""PPO whose policy is also drawn to what a teacher would do."""

from __future__ import annotations

from typing import Any

import torch
from rsl_rl.algorithms import PPO
from rsl_rl.env import VecEnv
from rsl_rl.models import MLPModel
from rsl_rl.storage import RolloutStorage
from rsl_rl.utils import resolve_class, resolve_obs_groups, unpad_trajectories
from tensordict import TensorDict

from arcgym.rl.algorithms.further_loss import FurtherLoss
from arcgym.rl.algorithms.ppo_bounded import BOUND, PPOBounded, bounds_loss

LESSON = "lesson"
"""Group of the stored observations that holds the teacher's actions; no network reads it."""


class PPOTaught(PPOBounded):
    """PPO with means within bounds and one more loss, which draws them to the actions of a teacher.

    The policy drives, and a teacher that sees more says what it would have done (DAgger, Ross et al. 2011,
    arXiv:1011.0686), beside what reward teaches, as in kickstarting (Schmitt et al. 2018, arXiv:1803.03835). A policy
    of images cannot do all that a teacher does: with a weight that falls to zero, reward has the last word.
    """

    teacher_loaded = False
    """Whether the teacher has the weights of a checkpoint."""

    def __init__(
        self,
        actor: MLPModel,
        critic: MLPModel,
        storage: RolloutStorage,
        teacher: MLPModel,
        bounds_loss_coef: float = 1.0,
        lesson_coef: float = 1.0,
        final_lesson_coef: float = 0.0,
        **kwargs: Any,
    ):
        """Build PPO; the storage gets room for the teacher's actions.

        Args:
            actor: Policy with a normal distribution of A actions, with or without memory.
            critic: Value function.
            storage: Rollout storage.
            teacher: Policy without memory that gives A actions.
            bounds_loss_coef: Weight of the squared difference to the means that acted, within bounds.
            lesson_coef: Weight of the squared difference to the teacher's actions.
            final_lesson_coef: That at the end of a run; its runner sets what is between.
            kwargs: Further arguments of PPO.
        """
        super().__init__(actor, critic, storage, bounds_loss_coef, **kwargs)
        self.teacher = teacher.requires_grad_(False).eval()
        self.lesson_coef = lesson_coef
        self._taught = _TaughtLoss(self, bounds_loss_coef)
        self.symmetry = self._taught  # type: ignore[assignment]
        storage.observations[LESSON] = torch.zeros_like(storage.actions)

    def act(self, obs: TensorDict) -> torch.Tensor:
        """Return actions for a step, shape (N, A), and keep what the teacher would have done, within bounds."""
        lesson = self.teacher(obs).clamp(-BOUND, BOUND)
        return super().act(TensorDict({**dict(obs.items()), LESSON: lesson}, batch_size=obs.batch_size))

    def update(self) -> dict[str, float]:
        """Make the gradient steps of an iteration and return the mean losses, ``bounds`` and ``lesson`` unweighted."""
        self._taught.parts.clear()
        losses = super().update()
        bounds, lesson = torch.stack(self._taught.parts).mean(dim=0).tolist()
        return {**losses, "bounds": bounds, "lesson": lesson}

    def save(self) -> dict:
        """Return PPO's state and the teacher's weights."""
        return {**super().save(), "teacher_state_dict": self.teacher.state_dict()}

    def load(self, loaded_dict: dict, load_cfg: dict | None, strict: bool) -> bool:
        """Load a checkpoint; with ``{"teacher": True}`` the actor of another run as the teacher."""
        if load_cfg == {"teacher": True}:
            self.teacher.load_state_dict(loaded_dict["actor_state_dict"], strict=strict)
            self.teacher_loaded = True
            return False
        if load_cfg is None:
            self.teacher.load_state_dict(loaded_dict["teacher_state_dict"], strict=strict)
            self.teacher_loaded = True
        return super().load(loaded_dict, load_cfg, strict)

    @staticmethod
    def construct_algorithm(obs: TensorDict, env: VecEnv, cfg: dict, device: str) -> PPO:
        """Construct the algorithm, its networks and its storage, as rsl_rl's runner asks for."""
        cfg["obs_groups"] = resolve_obs_groups(obs, cfg["obs_groups"], ["actor", "critic", "teacher"])
        model, settings = resolve_class(cfg["teacher"])
        teacher = model(obs, cfg["obs_groups"], "teacher", env.num_actions, **settings).to(device)
        return PPO.construct_algorithm(obs, env, {**cfg, "algorithm": {**cfg["algorithm"], "teacher": teacher}}, device)


class _TaughtLoss(FurtherLoss):
    """Draws the means of a mini-batch back within bounds, and to the lesson."""

    def __init__(self, alg: PPOTaught, bounds_coef: float):
        super().__init__(1.0)
        self._alg, self._bounds_coef = alg, bounds_coef
        self.parts: list[torch.Tensor] = []
        """Both losses of each mini-batch, shape (2,)."""

    def compute_loss(self, actor: MLPModel, batch: Any, size: int) -> torch.Tensor:
        """Return the weighted sum of both; the policy has just seen this mini-batch."""
        mean, lesson = actor.output_distribution_params[0], batch.observations[LESSON]
        if batch.masks is not None:  # of a policy with memory, which learns on padded pieces of episodes
            lesson = unpad_trajectories(lesson, batch.masks)
        bounds, taught = bounds_loss(mean, batch.old_distribution_params[0]), lesson_loss(mean, lesson)
        self.parts.append(torch.stack((bounds, taught)).detach())
        return self._bounds_coef * bounds + self._alg.lesson_coef * taught


def lesson_loss(mean: torch.Tensor, lesson: torch.Tensor) -> torch.Tensor:
    """Return the squared difference to a teacher's actions, summed over the actions; mean over the rest.

    Args:
        mean: Mean actions, shape (..., A).
        lesson: The teacher's, same shape.
    """
    return (mean - lesson).square().sum(dim=-1).mean()
