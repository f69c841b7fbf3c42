#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Trials of a policy of a magnetic scope or a capsule that is told where the lumen goes on where it makes no way.

    python scripts/tools/tell_direction.py --agent logs/model_422.pt --suite population_clinical \
        --patients 20008,20056,20058 --tell all --out logs/told.csv

Where for 2.5 s no new 5 mm are reached, a steering that sees the centerline takes over until they are. It shows whether
what holds a policy is that it does not know the direction. ``mirrored`` tells the opposite side, as a control.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any

import torch

from arcgym.cli.evaluate import load_trial_cfgs
from arcgym.envs.mdp.centerline import points_ahead
from arcgym.evaluation.evaluate import opened, patients_of
from arcgym.evaluation.options import EvaluationOptions
from arcgym.evaluation.run_trials import run_trials
from arcgym.evaluation.suites import read_suites
from arcgym.evaluation.trials import read_conditions

KINDS = ("none", "turn", "all", "mirrored")
"""``none``: nothing takes over. ``turn``: pitch, yaw and roll. ``all``: the pull as well. ``mirrored``: all, to the
opposite side."""
WAIT = 25
"""Control steps without new way after which it is told: 2.5 s."""
NEW_WAY = 0.005
"""Advance beyond the farthest place that counts as new way [m]."""
AHEAD = 0.03
"""Arc length ahead of the tip to which is steered [m]."""
FULL_TURN = 0.5
"""Angle from which on it turns with the whole range [rad]."""
FORWARD, NOT_BACK = 0.6, 0.2
"""Cosines of the angle to the way above which the tip goes forward, and below which it goes back."""


class Told:
    """A policy, and the steering that takes over where no way is made."""

    def __init__(self, env: Any, policy: Any, kind: str) -> None:
        """Begin with no way made.

        Args:
            env: The environment, whose actions are those of :class:`arcgym.envs.mdp.TipVelocityAction`.
            policy: Gives actions for observations, shape (N, 6).
            kind: One of :data:`KINDS`.
        """
        self._env, self._policy, self._kind = env.unwrapped, policy, kind
        self._farthest = torch.full((env.num_envs,), -torch.inf, device=env.device)
        self._since = torch.zeros(env.num_envs, device=env.device)

    def __call__(self, obs: Any) -> torch.Tensor:
        """Return the actions, shape (N, 6)."""
        actions = self._policy(obs)
        if self._kind == "none":
            return actions
        arc = self._env.scene["endoscope"].data.tip_arc_length
        won = arc > self._farthest + NEW_WAY
        self._farthest = torch.where(won, arc, self._farthest)
        self._since = torch.where(won, 0.0, self._since + 1.0)
        return torch.where((self._since > WAIT)[:, None], self._steered(actions), actions)

    def reset(self, dones: torch.Tensor) -> None:
        """Forget the way of the worlds that are done."""
        self._farthest = torch.where(dones.bool(), -torch.inf, self._farthest)
        self._since = torch.where(dones.bool(), 0.0, self._since)
        if hasattr(self._policy, "reset"):
            self._policy.reset(dones)

    def _steered(self, actions: torch.Tensor) -> torch.Tensor:
        """Return the actions that lead along the centerline, those that are not told as they are."""
        x, y, z = torch.nn.functional.normalize(points_ahead(self._env, AHEAD)[:, 0], dim=-1).unbind(dim=-1)
        if self._kind == "mirrored":
            x, y = -x, -y
        aside = torch.hypot(x, y).clamp(min=0.05)
        turn = (torch.atan2(aside, z) / FULL_TURN).clamp(0.0, 1.0) / aside
        right, up, forward = actions[:, :3].unbind(dim=-1)
        if self._kind != "turn":
            right, up = x, y
            forward = torch.where(z > FORWARD, 0.8, torch.where(z > NOT_BACK, 0.0, -0.6))
        return torch.stack([right, up, forward, -y * turn, x * turn, torch.zeros_like(x)], dim=-1)


def arguments(doc: str | None) -> argparse.ArgumentParser:
    """Return the arguments of a script that runs trials of a policy which it changes."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--agent", required=True, help="checkpoint")
    parser.add_argument("--suite", default="population_clinical", help="suite whose trials are run")
    parser.add_argument("--task", default="ARC-LeftColon-Magnetic", help="task of the suite")
    parser.add_argument("--patients", help="numbers of patients, separated by commas; all without")
    parser.add_argument("--device", default="cpu", help="device")
    parser.add_argument("--out", type=Path, required=True, help="CSV file")
    return parser


def run(args: argparse.Namespace, change: Callable[[Any, Any], Any]) -> None:
    """Run the trials, and write a row for each as it ends.

    Args:
        args: Those of :func:`arguments`.
        change: Returns what drives, for the environment and its policy.
    """
    suite = read_suites()[args.suite]
    trials = read_conditions(suite.conditions_path).trials
    if args.patients:
        trials = [trial for trial in trials if trial.patient.split(":")[-1] in args.patients.split(",")]
    overrides = tuple(suite.overrides_of(args.task))
    cfgs = load_trial_cfgs(args.task, Path(args.agent), overrides)
    options = EvaluationOptions((args.agent,), args.suite, overrides, len(trials), 64, args.device)
    args.out.parent.mkdir(parents=True, exist_ok=True)
    with args.out.open("w", buffering=1) as file, opened(args.task, args.agent, trials, cfgs, options) as (env, make):
        table = csv.DictWriter(file, ("patient", "success", "end", "seconds", "progress"), extrasaction="ignore")
        table.writeheader()

        def on_row(row: dict[str, Any]) -> None:
            table.writerow(row)
            print(", ".join(f"{name} {row[name]}" for name in table.fieldnames), flush=True)

        run_trials(env, lambda env: change(env, make(env)), trials, on_row, patients_of(trials))


def main() -> None:
    """Run the trials with the steering."""
    parser = arguments(__doc__)
    parser.add_argument("--tell", choices=KINDS, default="all", help="what takes over where no way is made")
    args = parser.parse_args()
    run(args, lambda env, policy: Told(env, policy, args.tell))


if __name__ == "__main__":
    main()
