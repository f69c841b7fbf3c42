# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Runs trials in the worlds of one environment, each world taking the next trial when its episode ends."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import torch

from arcgym.evaluation.drawn_values import drawn_values
from arcgym.evaluation.trial_queue import TrialQueue
from arcgym.evaluation.trials import Trial
from arcgym.rl.episode_sums import EpisodeRow, EpisodeSums
from arcgym.rl.rollout import Policy
from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper

OF_THE_BATCH = "patient_index"
"""Metric that depends on what other patients there are; a trial names its patient itself."""

TrialRow = EpisodeRow
"""One trial's results by column: the trial's fields, what was drawn for it, then the episode's."""


def run_trials(
    env: RslRlVecEnvWrapper,
    make_policy: Callable[[RslRlVecEnvWrapper], Policy],
    trials: Sequence[Trial],
    on_row: Callable[[TrialRow], None],
    patients: Sequence[str] = (),
    on_step: Callable[[], None] = lambda: None,
) -> None:
    """Run every trial once.

    The result of a trial is the same whatever the number of worlds and the order of the trials: its random numbers
    follow from its seed, and no world sees another.

    Args:
        env: Environment; its worlds start anew.
        make_policy: Makes the policy, once the first trials have begun.
        trials: The trials, of patients in ``env``.
        on_row: Called with the row of each trial that ends: the fields of the trial, those of
            :func:`arcgym.evaluation.drawn_values.drawn_values`, and those of
            :meth:`arcgym.rl.episode_sums.EpisodeSums.take`.
        patients: Patients in ``env``, as the trials name them, where there are several. Its event ``patient`` is
            :func:`arcgym.evaluation.trial_queue.give_patient_of_trial`.
        on_step: Called before every step.
    """
    queue = TrialQueue(trials, env.num_envs, patients)
    env.unwrapped.random.seed_source = queue
    try:
        env.reset()
        _run(env, make_policy(env), queue, on_row, on_step)
    finally:
        env.unwrapped.random.seed_source = None


def _run(
    env: RslRlVecEnvWrapper,
    policy: Policy,
    queue: TrialQueue,
    on_row: Callable[[TrialRow], None],
    on_step: Callable[[], None],
) -> None:
    obs, sums, drawn = env.get_observations(), EpisodeSums(env), drawn_values(env.unwrapped)
    with torch.inference_mode():
        while queue.left:
            on_step()
            running = queue.running
            obs, rewards, dones, extras = env.step(policy(obs))
            if hasattr(policy, "reset"):
                policy.reset(dones)
            sums.add(rewards, extras.get("costs", {}))
            ended = dones.nonzero().flatten().tolist()
            for world, row in zip(ended, sums.take(ended), strict=True):
                trial = running[world]
                if trial is not None:
                    row.pop(OF_THE_BATCH, None)
                    on_row({**vars(trial), **drawn[world], **row})
            if ended:
                drawn = drawn_values(env.unwrapped)
