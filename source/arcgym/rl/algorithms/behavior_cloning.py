# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Behavior cloning: supervised learning of recorded actions."""

from __future__ import annotations

from typing import Any

import torch
from rsl_rl.env import VecEnv
from rsl_rl.models import MLPModel
from rsl_rl.utils import reduce_gradients_in_buckets, resolve_class, resolve_obs_groups
from tensordict import TensorDict
from torch import nn

from arcgym.rl.demonstrations import Demonstrations, read_demonstrations
from arcgym.utils.errors import UsageError

LEAST_DEVIATION = 0.02
"""Least unit of an action: one that the demonstrations hardly use is not asked for to a thousandth of its range."""


class BehaviorCloning:
    """Fits the mean action of a policy to demonstrations by their mean squared difference.

    With ``action_units=raw`` the loss is the mean over steps and actions of ``(p - a)**2``, ``p`` the policy's mean
    action and ``a`` the recorded one. With ``action_units=deviation`` it is that of ``((p - a) / s)**2``, ``s`` the
    standard deviation of that action over all recorded steps, 0.02 at least. An action that varies over a tenth of its
    range then counts as much as one that varies over all of it.

    The shape is that of rsl_rl's PPO, so that the same runner drives it: the policy acts in the environment between
    updates, which shows how good it is and teaches it nothing, unless an expert says what it would do there. Recorded
    actions are raw ones; those beyond [-1, 1] count as the bound, which is what the action terms carry out.
    """

    rnd = None

    def __init__(
        self,
        actor: MLPModel,
        groups: list[str],
        demonstrations: str = "",
        successful_only: bool = True,
        expert_steps: int = 20_000,
        expert_noise: float = 0.2,
        expert_settings: dict[str, float] | None = None,
        learning_rate: float = 3.0e-4,
        batch_size: int = 256,
        steps_per_update: int = 100,
        max_grad_norm: float = 1.0,
        action_units: str = "raw",
        asks_on: bool = False,
        device: str = "cpu",
        multi_gpu_cfg: dict | None = None,
        grad_reduce_bucket_mb: float = 25,
    ):
        """Build the optimizer.

        Args:
            actor: Policy without memory.
            groups: Observation groups that the policy reads.
            demonstrations: Folder of the recorded episodes, see :func:`arcgym.rl.demonstrations.read_demonstrations`,
                or ``expert``: the runner asks the scripted expert.
            successful_only: Whether episodes that did not succeed are left out.
            expert_steps: Steps that the expert is asked for.
            expert_noise: Noise on its actions as they are carried out, in raw actions.
            expert_settings: Its settings, by name; None for its defaults.
            learning_rate: Learning rate.
            batch_size: Recorded steps of one gradient step.
            steps_per_update: Gradient steps of one iteration.
            max_grad_norm: Gradient clipping by norm.
            action_units: What a difference of actions is counted in: ``raw`` or ``deviation``.
            asks_on: Whether the runner gives :attr:`expert`, which is asked where the policy drives.
            device: Device of the network.
            multi_gpu_cfg: Rank and number of processes, from the runner.
            grad_reduce_bucket_mb: Size of the messages that average gradients [MB].

        Raises:
            UsageError: If the policy has a memory.
        """
        if actor.is_recurrent:
            raise UsageError("Cloning draws single steps, expected a policy without memory, such as ByteCnnModel.")
        self.device, self.learning_rate = device, learning_rate
        self.groups, self.folder, self.successful_only = groups, demonstrations, successful_only
        self.expert_steps, self.expert_noise, self.expert_settings = expert_steps, expert_noise, expert_settings or {}
        self._demonstrations: Demonstrations | None = None
        self.batch_size, self.steps_per_update, self.max_grad_norm = batch_size, steps_per_update, max_grad_norm
        self.action_units = action_units
        self._unit: torch.Tensor | float = 1.0
        self.asks_on = asks_on
        self.expert: Any = None
        """Policy that is asked what it would do where this one drives; None for none."""
        self._asked: list[tuple[TensorDict, torch.Tensor]] = []
        self.is_multi_gpu, self.grad_reduce_bucket_mb = multi_gpu_cfg is not None, grad_reduce_bucket_mb
        self.gpu_world_size = multi_gpu_cfg["world_size"] if multi_gpu_cfg else 1
        self.actor = actor.to(device)
        self.optimizer = torch.optim.Adam(self.actor.parameters(), lr=learning_rate)
        self._knows_scale = False

    @staticmethod
    def construct_algorithm(obs: TensorDict, env: VecEnv, cfg: dict, device: str) -> BehaviorCloning:
        """Build policy and algorithm from the training dictionary."""
        alg_class, alg_cfg = resolve_class(cfg["algorithm"])
        actor_class, actor_cfg = resolve_class(cfg["actor"])
        groups = cfg["obs_groups"] = resolve_obs_groups(obs, cfg["obs_groups"], ["actor"])
        actor = actor_class(obs, groups, "actor", env.num_actions, **actor_cfg)
        return alg_class(actor, groups["actor"], device=device, **alg_cfg, multi_gpu_cfg=cfg["multi_gpu"])

    def read_demonstrations(self) -> Demonstrations:
        """Return the demonstrations, which are read once; playing never needs them.

        Raises:
            UsageError: If no folder is given, it holds nothing to imitate, or other actions than the task's.
        """
        if self._demonstrations is None:
            if not self.folder:
                raise UsageError(
                    "No demonstrations to clone: set agent.algorithm.demonstrations to a folder of recorded episodes."
                )
            self.take(read_demonstrations(self.folder, self.groups, self.device, self.successful_only))
        assert self._demonstrations is not None
        return self._demonstrations

    def take(self, demonstrations: Demonstrations) -> None:
        """Clone these demonstrations.

        Raises:
            UsageError: If they have other actions than the task.
        """
        expected, have = self.actor.distribution.output_dim, demonstrations.actions.shape[1]
        if have != expected:
            raise UsageError(f"The demonstrations in '{self.folder}' have {have} actions, expected {expected}.")
        self._demonstrations = demonstrations
        if self.action_units == "deviation":
            self._unit = deviations(demonstrations.actions)

    def act(self, obs: TensorDict) -> torch.Tensor:
        """Return the mean actions, shape (N, A)."""
        self.actor(obs, stochastic_output=True)
        if self.expert is not None:
            self._asked.append((obs.select(*self.groups).clone(), self.expert(obs).clone()))
        return self.actor.output_mean

    def process_env_step(
        self, obs: TensorDict, rewards: torch.Tensor, dones: torch.Tensor, extras: dict[str, Any]
    ) -> None:
        """Let the expert forget the episodes that have ended."""
        if self.expert is not None:
            self.expert.reset(dones)

    def compute_returns(self, obs: TensorDict) -> None:
        """Do nothing."""

    def update(self) -> dict[str, float]:
        """Make the gradient steps of an iteration and return the mean loss."""
        demonstrations = self.read_demonstrations()
        if self._asked:
            seen, said = zip(*self._asked, strict=True)
            demonstrations.add(torch.cat(seen).to(self.device), torch.cat(said).to(self.device))  # type: ignore
            self._asked.clear()
        if not self._knows_scale:
            self.actor.update_normalization(demonstrations.observations)
            self._knows_scale = True
        total = torch.zeros((), device=self.device)
        for _ in range(self.steps_per_update):
            total += self.step_on(*demonstrations.sample(self.batch_size))
        return {"behavior": float(total) / self.steps_per_update}

    def step_on(self, obs: TensorDict, actions: torch.Tensor) -> torch.Tensor:
        """Make one gradient step and return the loss."""
        loss = ((self.actor(obs) - actions.clamp(-1.0, 1.0)) / self._unit).square().mean()
        self.optimizer.zero_grad()
        loss.backward()
        if self.is_multi_gpu:
            reduce_gradients_in_buckets(self.actor.parameters(), self.gpu_world_size, self.grad_reduce_bucket_mb)
        nn.utils.clip_grad_norm_(self.actor.parameters(), self.max_grad_norm)
        self.optimizer.step()
        return loss.detach()

    def train_mode(self) -> None:
        """Set train mode."""
        self.actor.train()

    def eval_mode(self) -> None:
        """Set evaluation mode."""
        self.actor.eval()

    def get_policy(self) -> MLPModel:
        """Return the actor."""
        return self.actor

    def save(self) -> dict:
        """Return the actor under the name that PPO gives its own, and the optimizer."""
        return {
            "actor_state_dict": self.actor.state_dict(),
            "optimizer_state_dict": self.optimizer.state_dict(),
            "knows_scale": self._knows_scale,
        }

    def load(self, loaded_dict: dict, load_cfg: dict | None, strict: bool) -> bool:
        """Load a checkpoint: all of it, or only the actor when ``load_cfg`` says so."""
        self.actor.load_state_dict(loaded_dict["actor_state_dict"], strict=strict)
        if load_cfg is not None and not load_cfg.get("optimizer"):
            return load_cfg.get("iteration", False)
        self.optimizer.load_state_dict(loaded_dict["optimizer_state_dict"])
        self._knows_scale = loaded_dict["knows_scale"]
        return True

    def broadcast_parameters(self) -> None:
        """Send the first process's policy to all."""
        for tensor in self.actor.state_dict().values():
            torch.distributed.broadcast(tensor, src=0)


def deviations(actions: torch.Tensor) -> torch.Tensor:
    """Return the standard deviation of each action within [-1, 1], shape (A,), :data:`LEAST_DEVIATION` at least.

    Args:
        actions: Raw actions of all steps, shape (steps, A).
    """
    return actions.clamp(-1.0, 1.0).std(dim=0, correction=0).clamp(min=LEAST_DEVIATION)
