# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Soft actor-critic."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Iterator
from functools import partial
from itertools import chain
from typing import Any

import torch
from rsl_rl.env import VecEnv
from rsl_rl.models import MLPModel
from rsl_rl.utils import reduce_gradients_in_buckets, resolve_class, resolve_obs_groups
from tensordict import TensorDict
from torch import nn

from arcgym.rl.algorithms.graphed_step import GraphedStep
from arcgym.rl.networks.q_models import with_action
from arcgym.rl.replay import ReplayBatch, ReplayBuffer
from arcgym.utils.errors import UsageError

DRAWN_TOGETHER = 8
"""Batches that are drawn from the memory at a time: drawing waits for the device."""


class SAC:
    """Soft actor-critic (Haarnoja et al. 2018, arXiv:1812.05905) with two critics and a learned temperature.

    The shape is that of rsl_rl's PPO, so that the same runner drives it: an iteration is ``num_steps_per_env`` steps of
    all worlds and then ``updates_per_transition`` gradient steps for each of their transitions. With the target's

        y = r + gamma (1 - terminated) (min_i Q'_i(s', a') - alpha log p(a' | s')),  a' ~ p(. | s')

    where r, gamma and s' may lead over several steps,

    the critics minimize ``(Q_i(s, a) - y)^2``, the actor ``alpha log p(a | s) - min_i Q_i(s, a)``, the temperature
    ``-log alpha (log p(a | s) + target entropy)``. A time-out is not an end: its ``s'`` is the episode's last state.
    """

    rnd = None

    def __init__(
        self,
        actor: MLPModel,
        critics: list[MLPModel],
        replay: ReplayBuffer,
        gamma: float = 0.99,
        learning_rate: float = 3.0e-4,
        batch_size: int = 512,
        updates_per_transition: float = 0.25,
        learning_starts: int = 10_000,
        actor_interval: int = 4,
        target_step: float = 0.01,
        init_temperature: float = 0.1,
        learn_temperature: bool = True,
        target_entropy: float | None = None,
        max_grad_norm: float = 10.0,
        num_steps: int = 1,
        use_mixed_precision: bool = False,
        use_cuda_graphs: bool = False,
        device: str = "cpu",
        multi_gpu_cfg: dict | None = None,
        grad_reduce_bucket_mb: float = 25,
    ):
        """Build targets and optimizers.

        Args:
            actor: Policy with :class:`arcgym.rl.networks.squashed_gaussian.SquashedGaussianDistribution`.
            critics: Action-value networks.
            replay: Memory, filled by :meth:`process_env_step`.
            gamma: Discount of a step.
            learning_rate: Of actor, critics and temperature.
            batch_size: Transitions of one gradient step.
            updates_per_transition: Gradient steps of the critics for each new transition.
            learning_starts: Transitions with uniformly random actions, before the first gradient step.
            actor_interval: Critic steps for each step of actor and temperature.
            target_step: Fraction by which the targets follow the critics in each step.
            init_temperature: First temperature alpha; the only one with ``learn_temperature`` off.
            learn_temperature: Whether the temperature keeps the entropy at ``target_entropy``.
            target_entropy: In nats; None is minus the size of the action.
            max_grad_norm: Gradient clipping by norm.
            num_steps: Steps whose rewards a target adds up before it bootstraps.
            use_mixed_precision: Whether networks compute in bfloat16 in updates.
            use_cuda_graphs: Whether gradient steps on a GPU are CUDA graphs, where one process learns alone.
            device: Device of the networks.
            multi_gpu_cfg: Rank and number of processes, from the runner.
            grad_reduce_bucket_mb: Size of the messages that average gradients [MB].
        """
        self.device, self.replay, self.learning_rate = device, replay, learning_rate
        self.is_multi_gpu, self.grad_reduce_bucket_mb = multi_gpu_cfg is not None, grad_reduce_bucket_mb
        self.gpu_world_size = multi_gpu_cfg["world_size"] if multi_gpu_cfg else 1
        self.num_steps, self.gamma = num_steps, gamma
        self.batch_size, self.learning_starts = batch_size, learning_starts
        self.updates_per_transition, self.actor_interval = updates_per_transition, actor_interval
        self.target_step, self.max_grad_norm = target_step, max_grad_norm
        self.learn_temperature, self.use_mixed_precision = learn_temperature, use_mixed_precision
        self.actor, self.critics = actor.to(device), nn.ModuleList(critics).to(device)
        self.targets = copy.deepcopy(self.critics).requires_grad_(False)
        num_actions = actor.distribution.output_dim
        self.target_entropy = -float(num_actions) if target_entropy is None else target_entropy
        self.log_temperature = torch.tensor(math.log(init_temperature), device=device, requires_grad=learn_temperature)
        self.uses_graphs = use_cuda_graphs and torch.device(device).type == "cuda" and not self.is_multi_gpu
        adam = partial(torch.optim.Adam, lr=self._rate(learning_rate), capturable=self.uses_graphs)
        self.actor_optimizer = adam(self.actor.parameters())
        self.critic_optimizer = adam(self.critics.parameters())
        self.temperature_optimizer = adam([self.log_temperature])
        self.num_updates = 0
        self._owed = 0.0
        self._obs: TensorDict | None = None
        self._actions = torch.empty(0)
        self._fresh: list[TensorDict] = []
        self._compiled: dict[Any, Callable[[TensorDict], torch.Tensor]] = {}
        self._graphs: dict[bool, GraphedStep] = {}
        models = [self.actor, *self.critics]
        self._vector_groups = sorted(
            {group for model in models if model.obs_normalization for group in model.obs_groups}
        )

    @staticmethod
    def construct_algorithm(obs: TensorDict, env: VecEnv, cfg: dict, device: str) -> SAC:
        """Build networks, memory and algorithm from the training dictionary."""
        alg_class, alg_cfg = resolve_class(cfg["algorithm"])
        actor_class, actor_cfg = resolve_class(cfg["actor"])
        critic_class, critic_cfg = resolve_class(cfg["critic"])
        groups = cfg["obs_groups"] = resolve_obs_groups(obs, cfg["obs_groups"], ["actor", "critic"])
        actor = actor_class(obs, groups, "actor", env.num_actions, **actor_cfg)
        with_actions = with_action(obs, torch.zeros(env.num_envs, env.num_actions, device=obs.device))
        outputs = alg_class.critic_outputs(alg_cfg)
        critics = [critic_class(with_actions, groups, "critic", outputs, **critic_cfg) for _ in range(2)]
        size, stacks = alg_cfg.pop("replay_size"), alg_cfg.pop("frame_stacks", None)
        read = {group for groups_of_set in groups.values() for group in groups_of_set}
        replay = ReplayBuffer(obs.select(*read), env.num_actions, size, device, stacks, _shrink(actor, critics))
        alg = alg_class(actor, critics, replay, device=device, **alg_cfg, multi_gpu_cfg=cfg["multi_gpu"])
        if cfg.get("torch_compile_mode"):
            alg.compile(cfg["torch_compile_mode"])
        return alg

    def compile(self, mode: str) -> None:
        """Compile the networks as updates use them; acting stays as it is.

        Args:
            mode: Mode of ``torch.compile``. Those with CUDA graphs are refused: a graph's next call would overwrite the
                values of the last.

        Raises:
            UsageError: The mode uses CUDA graphs.
        """
        if mode in ("reduce-overhead", "max-autotune"):
            raise UsageError(
                f"agent.torch_compile_mode is '{mode}', which uses CUDA graphs; expected 'default' or "
                "'max-autotune-no-cudagraphs'."
            )
        self._compiled = {critic: torch.compile(critic, mode=mode) for critic in (*self.critics, *self.targets)}
        self._compiled[self.actor] = torch.compile(self._actor_output, mode=mode)

    @staticmethod
    def critic_outputs(alg_cfg: dict[str, Any]) -> int:
        """Return the number of outputs of a critic."""
        return 1

    @property
    def temperature(self) -> torch.Tensor:
        """Price of entropy alpha, scalar."""
        return self.log_temperature.exp()

    def act(self, obs: TensorDict) -> torch.Tensor:
        """Return actions to explore with, shape (N, A): uniform ones until learning starts, then the policy's."""
        self._obs, self._actions = obs, self.actor(obs, stochastic_output=True)
        if self.num_updates == 0 and self.replay.num_transitions < self.learning_starts:
            self._actions = 2.0 * torch.rand_like(self._actions) - 1.0
        return self._actions

    def process_env_step(
        self, obs: TensorDict, rewards: torch.Tensor, dones: torch.Tensor, extras: dict[str, Any]
    ) -> None:
        """Store one step; ``extras["final_obs"]`` is needed where ``extras["time_outs"]``."""
        assert self._obs is not None, "act comes before process_env_step"
        time_outs = extras.get("time_outs", torch.zeros_like(dones))
        self.replay.add(self._obs, self._actions, rewards, dones, time_outs, extras.get("final_obs"))
        self._fresh.append(self._obs.select(*self._vector_groups))
        self._owed += self.updates_per_transition * self.replay.num_envs

    def compute_returns(self, obs: TensorDict) -> None:
        """Do nothing: targets are computed batch by batch."""

    def update(self) -> dict[str, float]:
        """Make the gradient steps that the new transitions call for, and return mean losses."""
        self._update_normalization()
        if self.replay.num_transitions < self.learning_starts:
            self._owed = 0.0
            return {}
        sums: dict[str, torch.Tensor] = {}
        counts: dict[str, int] = {}
        for batch in self._batches():
            for name, value in self.step_on(batch).items():
                sums[name] = sums.get(name, torch.zeros((), device=self.device)) + value
                counts[name] = counts.get(name, 0) + 1
        return {name: float(total) / counts[name] for name, total in sums.items()}

    def step_on(self, batch: ReplayBatch) -> dict[str, torch.Tensor]:
        """Make one gradient step on ``batch`` and return the losses, which the next step may overwrite."""
        moves_actor = self.num_updates % self.actor_interval == 0
        self.num_updates += 1
        if not self.uses_graphs or self._compiled:
            return self._step(batch, moves_actor)
        if moves_actor not in self._graphs:
            self._graphs[moves_actor] = GraphedStep(partial(self._step, moves_actor=moves_actor))
        return self._graphs[moves_actor](batch)

    def _batches(self) -> Iterator[ReplayBatch]:
        """Yield the batches of the gradient steps that are owed, several drawn at a time."""
        while self._owed >= 1.0:
            count = min(int(self._owed), DRAWN_TOGETHER)
            self._owed -= count
            yield from self.replay.sample(count * self.batch_size, self.num_steps, self.gamma).split(self.batch_size)

    def _step(self, batch: ReplayBatch, moves_actor: bool) -> dict[str, torch.Tensor]:
        critic_loss = self.critic_loss(batch)
        self._descend(critic_loss, self.critic_optimizer, self.critics.parameters())
        losses = {"critic": critic_loss.detach()}
        if moves_actor:
            losses |= self._step_actor(batch.observations)
        self._follow()
        return losses

    def targets_of(self, batch: ReplayBatch) -> torch.Tensor:
        """Return the critics' targets y, shape (B,)."""
        with torch.no_grad():
            actions, log_prob = self._sample(batch.next_observations)
            following = with_action(batch.next_observations, actions)
            value = self._values(self.targets, following).amin(dim=0) - self.temperature * log_prob
            return batch.rewards + batch.discounts * (1.0 - batch.terminated) * value

    def critic_loss(self, batch: ReplayBatch) -> torch.Tensor:
        """Return the mean squared error of each critic, added up."""
        targets = self.targets_of(batch)
        values = self._values(self.critics, with_action(batch.observations, batch.actions))
        return (values - targets).square().mean(dim=1).sum()

    def train_mode(self) -> None:
        """Set train mode."""
        self.actor.train()
        self.critics.train()

    def eval_mode(self) -> None:
        """Set evaluation mode."""
        self.actor.eval()
        self.critics.eval()

    def get_policy(self) -> MLPModel:
        """Return the actor."""
        return self.actor

    def save(self) -> dict:
        """Return all state but the replay, which the runner keeps in a file of its own."""
        return {
            "actor_state_dict": self.actor.state_dict(),
            "critics_state_dict": self.critics.state_dict(),
            "targets_state_dict": self.targets.state_dict(),
            "log_temperature": self.log_temperature.detach(),
            "optimizer_state_dicts": [optimizer.state_dict() for optimizer in self._optimizers()],
            "num_updates": self.num_updates,
            "owed": self._owed,
        }

    def load(self, loaded_dict: dict, load_cfg: dict | None, strict: bool) -> bool:
        """Load a checkpoint: all of it, or only the actor when ``load_cfg`` says so."""
        self.actor.load_state_dict(loaded_dict["actor_state_dict"], strict=strict)
        if load_cfg is not None and not load_cfg.get("critic"):
            return load_cfg.get("iteration", False)
        self.critics.load_state_dict(loaded_dict["critics_state_dict"], strict=strict)
        self.targets.load_state_dict(loaded_dict["targets_state_dict"], strict=strict)
        with torch.no_grad():
            self.log_temperature.copy_(loaded_dict["log_temperature"])
        for optimizer, state in zip(self._optimizers(), loaded_dict["optimizer_state_dicts"], strict=True):
            optimizer.load_state_dict(state)
            for group in optimizer.param_groups:
                group["lr"] = self._rate(group["lr"])
        self.num_updates, self._owed = loaded_dict["num_updates"], loaded_dict["owed"]
        return True

    def broadcast_parameters(self) -> None:
        """Send the first process's networks and temperature to all."""
        tensors = chain.from_iterable(model.state_dict().values() for model in (self.actor, self.critics, self.targets))
        for tensor in chain(tensors, [self.log_temperature.data]):
            torch.distributed.broadcast(tensor, src=0)

    def _step_actor(self, obs: TensorDict) -> dict[str, torch.Tensor]:
        actions, log_prob = self._sample(obs)
        self.critics.requires_grad_(False)
        values = self._values(self.critics, with_action(obs, actions)).amin(dim=0)
        self.critics.requires_grad_(True)
        actor_loss = (self.temperature.detach() * log_prob - values).mean()
        self._descend(actor_loss, self.actor_optimizer, self.actor.parameters())
        if self.learn_temperature:
            loss = -(self.log_temperature * (log_prob.detach() + self.target_entropy)).mean()
            self._descend(loss, self.temperature_optimizer, [self.log_temperature])
        return {
            "actor": actor_loss.detach(),
            "entropy": -log_prob.detach().mean(),
            "temperature": self.temperature.detach(),
            "value": values.detach().mean(),
        }

    def _sample(self, obs: TensorDict) -> tuple[torch.Tensor, torch.Tensor]:
        """Actions with gradients, shape (B, A), and their log-probabilities, shape (B,)."""
        distribution = self.actor.distribution
        with self._precision():
            output = self._compiled.get(self.actor, self._actor_output)(obs)
        distribution.update(output.float())
        return distribution.sample_with_log_prob()

    def _actor_output(self, obs: TensorDict) -> torch.Tensor:
        """Return what the actor's distribution is made of."""
        return self.actor.mlp(self.actor.get_latent(obs))

    def _outputs(self, critics: nn.ModuleList, obs: TensorDict) -> torch.Tensor:
        """Output of each critic, shape (2, B, outputs)."""
        with self._precision():
            return torch.stack([self._compiled.get(critic, critic)(obs).float() for critic in critics])

    def _values(self, critics: nn.ModuleList, obs: TensorDict) -> torch.Tensor:
        """Value of each critic, shape (2, B)."""
        return self._outputs(critics, obs).squeeze(-1)

    def _precision(self) -> torch.autocast:
        """Return the context that networks compute in."""
        kind = torch.device(self.device).type
        return torch.autocast(
            kind, dtype=torch.bfloat16, enabled=self.use_mixed_precision, cache_enabled=not self.uses_graphs
        )

    def _descend(self, loss: torch.Tensor, optimizer: torch.optim.Optimizer, parameters: Any) -> None:
        parameters = list(parameters)
        optimizer.zero_grad()
        loss.backward()
        if self.is_multi_gpu:
            reduce_gradients_in_buckets(parameters, self.gpu_world_size, self.grad_reduce_bucket_mb)
        nn.utils.clip_grad_norm_(parameters, self.max_grad_norm)
        optimizer.step()

    def _follow(self) -> None:
        """Move the targets' weights towards the critics', and copy their normalizers."""
        with torch.no_grad():
            targets, sources = tuple(self.targets.parameters()), tuple(self.critics.parameters())
            torch._foreach_lerp_(targets, sources, self.target_step)
            for statistic, learned in zip(self.targets.buffers(), self.critics.buffers(), strict=True):
                statistic.copy_(learned)

    def _update_normalization(self) -> None:
        """Show the normalizers each new observation once."""
        if self._fresh and self._vector_groups:
            obs = torch.cat(self._fresh)  # type: ignore[arg-type]
            for model in (self.actor, *self.critics):
                model.update_normalization(obs)  # type: ignore[operator]
        self._fresh.clear()

    def _rate(self, rate: float | torch.Tensor) -> float | torch.Tensor:
        """Return a learning rate as the optimizers keep it: graphs read it from the device, where it can change."""
        return torch.tensor(float(rate), device=self.device) if self.uses_graphs else float(rate)

    def _optimizers(self) -> tuple[torch.optim.Optimizer, ...]:
        return self.actor_optimizer, self.critic_optimizer, self.temperature_optimizer


def _shrink(*models: Any) -> dict[str, int]:
    """Return by how much images of each group are made smaller, which all models that read it must agree on."""
    factors: dict[str, int] = {}
    for model in (models[0], *models[1]):
        for group in getattr(model, "obs_groups_2d", ()):
            factor = getattr(model, "shrink", 1)
            if factors.setdefault(group, factor) != factor:
                raise UsageError(
                    f"agent.actor.shrink is {factors[group]} and agent.critic.shrink {factor}; both read '{group}', "
                    "which is stored once: set them alike."
                )
    return factors
