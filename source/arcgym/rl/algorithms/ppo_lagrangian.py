# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""PPO under limits on the cost of an episode."""

from __future__ import annotations

from typing import Any

import torch
from rsl_rl.algorithms import PPO
from rsl_rl.env import VecEnv
from rsl_rl.models import MLPModel
from rsl_rl.storage import RolloutStorage
from rsl_rl.utils import reduce_gradients_in_buckets, resolve_class, resolve_optimizer
from tensordict import TensorDict
from torch import nn

from arcgym.rl.cost_advantages import discounted_advantages
from arcgym.rl.episode_costs import EpisodeCosts
from arcgym.rl.lagrange import Multiplier, make_multiplier
from arcgym.utils.errors import UsageError

TOTAL = "total"
"""Name of the sum of all cost terms."""


class PPOLagrangian(PPO):
    """PPO on the Lagrangian of a constrained Markov decision process (Ray, Achiam and Amodei 2019).

    Maximizes the return under ``mean episode cost k <= limit k``. Every cost has a critic and a multiplier. The
    advantages are those of ``(reward - sum_k multiplier_k cost_k) / (1 + sum_k multiplier_k)``, estimated with
    separate critics and then scaled as PPO scales its own: with fixed multipliers and equal discounts this is PPO on
    the penalised reward. Multipliers follow the undiscounted cost of the episodes that ended, not the
    discounted advantages.
    """

    cost_critics: nn.ModuleDict
    """Value function of each cost."""

    def __init__(
        self,
        actor: MLPModel,
        critic: MLPModel,
        storage: RolloutStorage,
        limits: dict[str, float],
        multiplier: dict[str, Any] | None = None,
        cost_gamma: float = 0.99,
        cost_lam: float = 0.95,
        min_episodes: int = 1,
        **kwargs: Any,
    ):
        """Build PPO and the multipliers; :meth:`construct_algorithm` adds the critics of the costs.

        Args:
            actor: Policy.
            critic: Value function of the reward.
            storage: Rollout storage.
            limits: Largest mean episode cost of each constrained cost term; ``total`` is the sum of all terms.
            multiplier: ``kind`` (``ascent``, ``pid``, ``fixed``) and settings of the multipliers.
            cost_gamma: Discount of the costs' advantages.
            cost_lam: Trace decay of the costs' advantages.
            min_episodes: Episodes that must have ended before the multipliers move again.
            kwargs: Further arguments of PPO.

        Raises:
            UsageError: If there is no limit.
        """
        if not limits:
            raise UsageError("agent.algorithm.limits is empty, expected a limit for at least one cost term.")
        super().__init__(actor, critic, storage, **kwargs)
        self.cost_names = list(limits)
        settings = {"kind": "pid"} | (multiplier or {})
        self.multipliers: dict[str, Multiplier] = {
            name: make_multiplier(limit=limit, **settings) for name, limit in limits.items()
        }
        self.cost_gamma, self.cost_lam, self.min_episodes = cost_gamma, cost_lam, min_episodes
        shape = (len(limits), *storage.rewards.shape)
        self.costs, self.cost_values, self.cost_returns = (torch.zeros(shape, device=self.device) for _ in range(3))
        self.episode_costs = EpisodeCosts(len(limits), storage.num_envs, self.device)
        self.mean_episode_costs: dict[str, float] = {}
        self._step_values = torch.zeros(shape[0], *shape[2:], device=self.device)

    @staticmethod
    def construct_algorithm(obs: TensorDict, env: VecEnv, cfg: dict, device: str) -> PPOLagrangian:
        """Build the algorithm from rsl_rl's training dictionary.

        ``cfg["cost_critic"]`` describes the critics of the costs and ``cfg["obs_groups"]["cost_critic"]`` what they
        read; without them they are like the critic.
        """
        alg: PPOLagrangian = PPO.construct_algorithm(obs, env, cfg, device)  # type: ignore[assignment]
        groups = {"cost_critic": cfg["obs_groups"]["critic"], **cfg["obs_groups"]}
        model_class, model_cfg = resolve_class(cfg.get("cost_critic") or cfg["critic"])
        alg.set_cost_critics(
            {name: model_class(obs, groups, "cost_critic", 1, **model_cfg) for name in alg.cost_names},
            cfg["algorithm"].get("optimizer", "adam"),
        )
        return alg

    def set_cost_critics(self, critics: dict[str, nn.Module], optimizer: str = "adam") -> None:
        """Give every cost its value function.

        Raises:
            UsageError: If one is recurrent; they are fitted on single steps.
        """
        if any(getattr(model, "is_recurrent", False) for model in critics.values()):
            raise UsageError("agent.cost_critic is recurrent, expected a model without memory, such as MLPModel.")
        self.cost_critics = nn.ModuleDict(critics).to(self.device)
        self.cost_optimizer = resolve_optimizer(optimizer)(self.cost_critics.parameters(), lr=self.learning_rate)

    def act(self, obs: TensorDict) -> torch.Tensor:
        """Sample actions, and remember the costs' values of the observations."""
        self._step_values = self._values(obs).detach()
        return super().act(obs)

    def process_env_step(
        self, obs: TensorDict, rewards: torch.Tensor, dones: torch.Tensor, extras: dict[str, Any]
    ) -> None:
        """Record rewards and costs of one step; costs go on after a time-out as rewards do.

        Raises:
            UsageError: If a limited cost is not among the environment's.
        """
        step = self.storage.step
        costs = torch.stack([self._cost(name, extras) for name in self.cost_names])
        self.episode_costs.add(costs, dones)
        self.cost_values[:, step] = self._step_values
        self.costs[:, step] = costs.unsqueeze(-1)
        if "time_outs" in extras:
            time_outs = extras["time_outs"].to(self.device).view(1, -1, 1)
            self.costs[:, step] += self.cost_gamma * self._step_values * time_outs
        super().process_env_step(obs, rewards, dones, extras)

    def compute_returns(self, obs: TensorDict) -> None:
        """Move the multipliers by the episodes that ended, then compute returns and the Lagrangian's advantages."""
        super().compute_returns(obs)
        self._move_multipliers()
        st, last = self.storage, self._values(obs).detach()
        mixed, total = st.returns - st.values, 1.0
        for k, name in enumerate(self.cost_names):
            values, price = self.cost_values[k], self.multipliers[name].value
            advantages = discounted_advantages(self.costs[k], values, last[k], st.dones, self.cost_gamma, self.cost_lam)
            self.cost_returns[k] = advantages + values
            mixed = mixed - price * advantages
            total += price
        st.advantages = mixed / total
        if not self.normalize_advantage_per_mini_batch:
            st.advantages = (st.advantages - st.advantages.mean()) / (st.advantages.std() + 1e-8)

    def update(self) -> dict[str, float]:
        """Fit the costs' critics, update the policy, and return what to log."""
        losses = self._fit_cost_critics()
        losses |= super().update()
        for name in self.cost_names:
            losses[f"multiplier/{name}"] = self.multipliers[name].value
            if name in self.mean_episode_costs:
                losses[f"episode_cost/{name}"] = self.mean_episode_costs[name]
        return losses

    def train_mode(self) -> None:
        """Set train mode for all models."""
        super().train_mode()
        self.cost_critics.train()

    def eval_mode(self) -> None:
        """Set evaluation mode for all models."""
        super().eval_mode()
        self.cost_critics.eval()

    def save(self) -> dict:
        """Return everything that a resumed run needs."""
        return super().save() | {
            "cost_critics_state_dict": self.cost_critics.state_dict(),
            "cost_optimizer_state_dict": self.cost_optimizer.state_dict(),
            "multipliers": {name: multiplier.state_dict() for name, multiplier in self.multipliers.items()},
            "mean_episode_costs": self.mean_episode_costs,
        }

    def load(self, loaded_dict: dict, load_cfg: dict | None, strict: bool) -> bool:
        """Load a checkpoint; with ``load_cfg`` the costs' critics come with the critic, multipliers on request.

        Raises:
            KeyError: If the checkpoint has no such parts, as one of plain PPO.
        """
        wanted = load_cfg or {"critic": True, "optimizer": True, "multipliers": True}
        needed = any(wanted.get(part) for part in ("critic", "optimizer", "multipliers"))
        if needed and "multipliers" not in loaded_dict:
            raise KeyError("The checkpoint has no cost critics and multipliers: it is not one of PPOLagrangian.")
        if wanted.get("critic"):
            self.cost_critics.load_state_dict(loaded_dict["cost_critics_state_dict"], strict=strict)
        if wanted.get("optimizer"):
            self.cost_optimizer.load_state_dict(loaded_dict["cost_optimizer_state_dict"])
        if wanted.get("multipliers"):
            self.mean_episode_costs |= loaded_dict["mean_episode_costs"]
            for name, multiplier in self.multipliers.items():
                multiplier.load_state_dict(loaded_dict["multipliers"][name])
        return super().load(loaded_dict, load_cfg, strict)

    def broadcast_parameters(self) -> None:
        """Send the models of the first process to all."""
        super().broadcast_parameters()
        for tensor in self.cost_critics.state_dict().values():
            torch.distributed.broadcast(tensor, src=0)

    def _move_multipliers(self) -> None:
        means = self.episode_costs.take_means(self.min_episodes)
        for name, mean in zip(self.cost_names, means or (), strict=False):
            self.mean_episode_costs[name] = mean
            self.multipliers[name].update(mean)

    def _values(self, obs: TensorDict) -> torch.Tensor:
        """Value of each cost, shape (K, N, 1)."""
        return torch.stack([self.cost_critics[name](obs) for name in self.cost_names])

    def _cost(self, name: str, extras: dict[str, Any]) -> torch.Tensor:
        """One cost of the step, shape (N,)."""
        terms = {**extras.get("costs", {}), **({TOTAL: extras["cost"]} if "cost" in extras else {})}
        if name not in terms:
            raise UsageError(f"agent.algorithm.limits names the cost '{name}'; the task's are: {', '.join(terms)}.")
        return terms[name].to(self.device)

    def _fit_cost_critics(self) -> dict[str, float]:
        """Regress the critics on the returns in the mini-batches of an update; return the mean losses."""
        obs, targets = self.storage.observations.flatten(0, 1), self.cost_returns.flatten(1, 2)
        size = targets.shape[1] // self.num_mini_batches
        sums, count = torch.zeros(len(self.cost_names), device=self.device), 0
        for _ in range(self.num_learning_epochs):
            order = torch.randperm(targets.shape[1], device=self.device)
            for batch in order[: size * self.num_mini_batches].split(size):
                losses = (self._values(obs[batch]) - targets[:, batch]).square().mean(dim=(1, 2))
                self._step_cost_critics(losses.sum())
                sums += losses.detach()
                count += 1
        for model in self.cost_critics.values():
            model.update_normalization(obs)  # type: ignore[operator]
        return {f"cost_value/{name}": float(total) / count for name, total in zip(self.cost_names, sums, strict=True)}

    def _step_cost_critics(self, loss: torch.Tensor) -> None:
        self.cost_optimizer.zero_grad()
        loss.backward()
        if self.is_multi_gpu:
            parameters = self.cost_critics.parameters()
            reduce_gradients_in_buckets(parameters, self.gpu_world_size, self.grad_reduce_bucket_mb)
        for model in self.cost_critics.values():
            nn.utils.clip_grad_norm_(model.parameters(), self.max_grad_norm)
        self.cost_optimizer.step()
