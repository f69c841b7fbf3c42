#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Trials of a policy that sees the simulator's state, with terms of the state held at their means.

    python scripts/tools/hide_state.py --agent logs/teacher/model_539.pt --suite population_clinical \\
        --patients 20008,20023,20028 --hide centerline --out logs/hidden.csv

It shows which of the terms it lives by. ``--hide all --but centerline`` hides all others.
"""

from __future__ import annotations

from typing import Any

import torch
from tell_direction import arguments, run

from arcgym.rl.checkpoint import read_checkpoint
from arcgym.utils.errors import UsageError
from arcgym.utils.string import did_you_mean

STATE = "critic"
"""Group of observations that holds the state."""

MEANS = "obs_normalizer._mean"
"""Name of the means among a policy's weights, shape (1, D)."""


class Blinkered:
    """A policy, some of whose observed numbers are held."""

    def __init__(self, policy: Any, columns: list[int], means: torch.Tensor) -> None:
        """Keep what is held at what.

        Args:
            policy: Gives actions for observations.
            columns: Columns of the state that are held.
            means: Means of all columns, shape (1, D).
        """
        self._policy, self._columns, self._means = policy, columns, means

    def __call__(self, obs: Any) -> torch.Tensor:
        """Return the actions, shape (N, A)."""
        shown, state = obs.clone(), obs[STATE].clone()
        state[:, self._columns] = self._means[:, self._columns]
        shown[STATE] = state
        return self._policy(shown)

    def reset(self, dones: torch.Tensor) -> None:
        """Let the policy forget the worlds that are done."""
        self._policy.reset(dones)


def hidden_columns(env: Any, hide: list[str], but: list[str]) -> list[int]:
    """Return the columns of the terms to hide.

    Raises:
        UsageError: A name is none of a term.
    """
    pipelines = env.unwrapped.observation_manager.groups[STATE].pipelines
    for name in [*hide, *but]:
        if name not in pipelines and name not in ("all", "none"):
            raise UsageError(f"The state has no term '{name}'. {did_you_mean(name, list(pipelines))}")
    columns, first = [], 0
    for name, pipeline in pipelines.items():
        width = int(torch.Size(pipeline.shape).numel())
        if (name in hide or "all" in hide) and name not in but:
            columns += range(first, first + width)
        first += width
    return columns


def main() -> None:
    """Run the trials with the terms hidden."""
    parser = arguments(__doc__)
    parser.add_argument("--hide", nargs="+", default=["all"], help="terms that are held at their means; or all, none")
    parser.add_argument("--but", nargs="+", default=[], help="terms of these that are shown")
    args = parser.parse_args()
    means = read_checkpoint(args.agent, args.device)["actor_state_dict"].get(MEANS)
    if means is None:
        parser.error(f"{args.agent} sees no state; expected a checkpoint of --agent ppo_teacher or ppo_teacher_rgb")

    def change(env: Any, policy: Any) -> Blinkered:
        return Blinkered(policy, hidden_columns(env, args.hide, args.but), means)

    run(args, change)


if __name__ == "__main__":
    main()
