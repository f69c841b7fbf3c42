# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Runner whose actions obey rules, in training, in evaluation or in both."""

from __future__ import annotations

from typing import Any

import torch
from rsl_rl.env import VecEnv
from tensordict import TensorDict
from torch import nn

from arcgym.rl.action_constraints import ActionConstraint, ConstraintRules, action_axes
from arcgym.rl.runner import OnPolicyRunner
from arcgym.sensors.depth_estimators import DepthSource, EstimatedDepth, SimulatorDepth, TransformersDepth


class ConstrainedVecEnv(VecEnv):
    """An environment that carries out what the rules make of an action; the learner does not see the difference."""

    def __init__(self, env: VecEnv, constraint: ActionConstraint):
        """Put the rules in front of ``env``."""
        self.env, self.constraint = env, constraint

    def __getattr__(self, name: str) -> Any:
        """Everything else is the environment's."""
        return getattr(self.__dict__["env"], name)

    @property
    def episode_length_buf(self) -> torch.Tensor:  # type: ignore[override]
        """Control steps since each world's reset, shape (N,), int64."""
        return self.env.episode_length_buf

    @episode_length_buf.setter
    def episode_length_buf(self, value: torch.Tensor) -> None:
        self.env.episode_length_buf = value

    def get_observations(self) -> TensorDict:
        """Return the latest observations."""
        return self.env.get_observations()

    def step(self, actions: torch.Tensor) -> tuple[TensorDict, torch.Tensor, torch.Tensor, dict]:
        """Constrain the actions, shape (N, A), and step."""
        result = self.env.step(self.constraint(actions))
        self.constraint.reset(result[2])
        return result


class ConstrainedPolicy(nn.Module):
    """A policy and the rules, to be called like the policy. Exported files hold the policy alone."""

    def __init__(self, policy: Any, constraint: ActionConstraint):
        """Put the rules behind ``policy``, a network or what is called like one."""
        super().__init__()
        self.policy, self.constraint = policy, constraint

    def forward(self, obs: TensorDict) -> torch.Tensor:
        """Return the mean actions that the rules allow, shape (N, A)."""
        return self.constraint(self.policy(obs))

    def reset(self, dones: torch.Tensor | None = None) -> None:
        """Clear the memory of the worlds that are done."""
        self.policy.reset(dones)
        self.constraint.reset(dones)

    def as_jit(self) -> nn.Module:
        """Return the policy for TorchScript, without the rules."""
        return self.policy.as_jit()

    def as_onnx(self, verbose: bool = False) -> nn.Module:
        """Return the policy for ONNX, without the rules."""
        return self.policy.as_onnx(verbose)


class ConstrainedRunner(OnPolicyRunner):
    """On-policy runner with ``cfg["action_constraint"]`` between policy and environment."""

    def __init__(self, env: VecEnv, train_cfg: dict, log_dir: str | None = None, device: str = "cpu"):
        """Build rules, algorithm and logger; arguments as in rsl_rl."""
        cfg = train_cfg["action_constraint"]
        self.constraint = ActionConstraint(action_axes(env), make_depth(env, cfg["depth"]), make_rules(cfg["rules"]))
        self.constrains_evaluation = bool(cfg["in_evaluation"])
        learning_env = ConstrainedVecEnv(env, self.constraint) if cfg["in_training"] else env
        super().__init__(learning_env, train_cfg, log_dir, device)

    def get_inference_policy(self, device: str | None = None) -> Any:
        """Return the policy, with the rules behind it if the configuration asks for them in evaluation."""
        policy = super().get_inference_policy(device)
        return ConstrainedPolicy(policy, self.constraint) if self.constrains_evaluation else policy


def make_rules(cfg: dict[str, Any]) -> ConstraintRules:
    """Return the constants that a configuration holds."""
    return ConstraintRules(**cfg)


def make_depth(env: VecEnv, cfg: dict[str, Any]) -> DepthSource:
    """Return the depth that a configuration names: the simulator's, or a network's where ``weights`` are given."""
    weights = cfg.get("weights")
    if weights is None:
        return SimulatorDepth(env)
    network = TransformersDepth(weights, device=str(env.device), gives_depth=cfg["gives_depth"])
    return EstimatedDepth(env, network, cfg["near"], cfg["far"], cfg["align_to_simulator"])
