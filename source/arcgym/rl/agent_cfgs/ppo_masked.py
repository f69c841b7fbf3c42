# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Configuration of PPO whose actions obey the paper's rules."""

from __future__ import annotations

from arcgym.rl.runner_cfg import RslRlOnPolicyRunnerCfg
from arcgym.utils.configclass import configclass


@configclass
class ConstraintRulesCfg:
    """Constants of the rules, see :class:`arcgym.rl.action_constraints.ConstraintRules`."""

    forward: float = 0.8
    """Raw action of the constant step forward: 36 mm/s of a pulled tip, 40 mm/s of a pushed scope. The paper's is not
    given in meters; lower it where the tip outruns its steering."""

    depth_threshold: float = 0.7
    """The deep region has at least this fraction of the largest depth, as in the lumen reward."""

    far: float = 1.0
    """Depth is clipped here [m] first."""

    dead_zone: float = 0.0
    """Offset of the deep region, as a fraction of the half image, up to which no side is prescribed. 0 as in the paper;
    raise it when commands flip from side to side with the lumen in the middle."""

    blocked_depth: float = 0.005
    """Nothing in view is farther than this [m] where the tip faces the wall, and backs off."""

    back_off_steps: int = 5
    """Control steps of backing off, without steering; 0 switches it off."""


@configclass
class ConstraintDepthCfg:
    """Depth that the rules read."""

    weights: str | None = None
    """Folder of a network for monocular depth in the format of transformers, such as Depth Anything; None takes the
    simulator's depth, as the paper does."""

    gives_depth: bool = False
    """Whether the network answers with depth, as the metric variants do; the others give its inverse."""

    near: float = 0.003
    """Depth [m] of the nearest pixel of every estimated frame."""

    far: float = 0.1
    """Depth [m] of the farthest pixel of every estimated frame."""

    align_to_simulator: bool = False
    """Whether estimates are fitted to the simulator's depth instead; for studies of the network's error only."""


@configclass
class ActionConstraintCfg:
    """Rules between policy and environment."""

    in_training: bool = True
    """Whether training steps obey the rules."""

    in_evaluation: bool = True
    """Whether the policy that is played or evaluated obeys them. Report results with and without."""

    rules: ConstraintRulesCfg = ConstraintRulesCfg()
    """Their constants."""

    depth: ConstraintDepthCfg = ConstraintDepthCfg()
    """Where their depth comes from."""


@configclass
class RslRlConstrainedRunnerCfg(RslRlOnPolicyRunnerCfg):
    """On-policy runner with rules on the actions."""

    class_name: str = "arcgym.rl.constrained_runner:ConstrainedRunner"
    """Runner class."""

    action_constraint: ActionConstraintCfg = ActionConstraintCfg()
    """The rules."""
