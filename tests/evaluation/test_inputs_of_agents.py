# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What a trained agent is said to see."""

from __future__ import annotations

import pytest

from arcgym.cli.arguments import TaskArguments
from arcgym.cli.task import load_cfgs
from arcgym.evaluation.agents import inputs_of

PAST = "{rgb_20:{func:'arcgym.envs.mdp.observations:rgb',delay_min_lag:20,delay_max_lag:20}}"
"""Images of two seconds ago."""

AHEAD = "{ahead:{func:'arcgym.envs.mdp:centerline_ahead'}}"
"""The centerline, which no endoscope knows."""


@pytest.mark.parametrize(
    ("overrides", "sees"),
    [
        ([], ["policy"]),
        ([f"env.observations.policy.terms={PAST}"], ["policy"]),
        (["env.extra_observations=[force]", "agent.obs_groups.actor=[policy,force]"], ["policy", "force"]),
        ([f"env.observations.policy.terms={AHEAD}"], ["policy", "centerline_ahead"]),
        (["env.observations.policy.rgb.func=arcgym.envs.mdp:tip_progress"], ["policy", "tip_progress"]),
    ],
)
def test_what_was_added_to_a_group_is_named(overrides: list[str], sees: list[str]) -> None:
    cfgs = load_cfgs(TaskArguments(task="ARC-Rectum-Magnetic", overrides=overrides))
    assert inputs_of(*cfgs) == {"sees": sees, "simulator_depth": False}
