# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Policies from checkpoints, to be evaluated."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from arcgym.evaluation.batched_policy import BatchedPolicy
from arcgym.managers import ObservationGroupCfg, ObservationTermCfg
from arcgym.rl.constrained_runner import ConstrainedPolicy
from arcgym.rl.rollout import Policy
from arcgym.rl.trained_policy import trained_policy
from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper


def trained_agent(env: RslRlVecEnvWrapper, agent_cfg: Any, checkpoint: Path) -> Policy:
    """Return the policy of a checkpoint, whose answer for a world does not depend on the number of worlds."""
    policy = trained_policy(env, agent_cfg, checkpoint)
    if isinstance(policy, ConstrainedPolicy):
        return ConstrainedPolicy(BatchedPolicy(policy.policy, env.num_envs), policy.constraint)
    return BatchedPolicy(policy, env.num_envs)


def inputs_of(env_cfg: Any, agent_cfg: Any) -> dict[str, Any]:
    """Return what a trained agent acts by, and whether rules on its actions read true depth.

    It acts by observation groups, and by what was added to them: a group with further images is what it was, one with
    the centerline in it is named with that term's function, ``policy`` and ``centerline_ahead``.
    """
    groups = getattr(agent_cfg, "obs_groups", None) or {}
    rules = getattr(agent_cfg, "action_constraint", None)
    simulated = rules is not None and rules.in_evaluation and _reads_truth(rules.depth)
    names = list(groups.get("student") or groups.get("actor", ()))
    added = {function for name in names for function in _added(getattr(env_cfg.observations, name, None))}
    return {"sees": [*names, *sorted(added)], "simulator_depth": simulated}


def _added(group: Any) -> set[str]:
    """Return the names of the functions of a group's terms that its class does not have itself."""
    return _functions(group) - _functions(type(group)()) if isinstance(group, ObservationGroupCfg) else set()


def _functions(group: ObservationGroupCfg) -> set[str]:
    terms = [*vars(group).values(), *group.terms.values()]
    functions = [term.func for term in terms if isinstance(term, ObservationTermCfg)]
    return {
        re.split(r"[:.]", function)[-1] if isinstance(function, str) else function.__name__ for function in functions
    }


def _reads_truth(depth: Any) -> bool:
    return depth.weights is None or depth.align_to_simulator
