# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Terminations on numbers set by hand."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest
import torch

from arcgym.envs import mdp
from arcgym.managers import TerminationTermCfg


def make_stuck(env):
    params = {"window_s": 0.3, "min_progress": 0.01}
    return mdp.stuck(TerminationTermCfg(func=mdp.stuck, params=params), env), params


def test_time_out_at_the_last_step(env) -> None:
    env.episode_length_buf[:] = torch.tensor([99, 100])
    assert mdp.time_out(env).tolist() == [False, True]


def test_scope_out_at_the_anal_verge(env) -> None:
    env.scope.tip_arc_length = torch.tensor([-0.001, 0.001])
    assert mdp.scope_out(env).tolist() == [True, False]


def test_facing_one_end_of_the_lumen(env) -> None:
    # The tip's axis is +Z of its quaternion; turned by 30 and by 150 degrees about X from the way to the cecum.
    few, most = math.radians(15.0), math.radians(75.0)
    env.scope.tip_quat_w = torch.tensor(
        [[math.sin(few), 0.0, 0.0, math.cos(few)], [math.sin(most), 0.0, 0.0, math.cos(most)]]
    )
    env.scope.tip_lumen_direction_w = torch.tensor([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    env.episode_length_buf[:] = 11
    assert mdp.facing(env, "cecum", after_s=10 * env.step_dt).tolist() == [True, False]
    assert mdp.facing(env, "anus", after_s=10 * env.step_dt).tolist() == [False, True]
    assert mdp.facing(env, "anus", angle=math.radians(29.0), after_s=0.0).tolist() == [False, False]
    assert mdp.facing(env, "anus", after_s=11 * env.step_dt).tolist() == [False, False]


def test_episode_cost_above_its_limit(env) -> None:
    sums = {"force": torch.tensor([0.3, 0.6]), "view": torch.tensor([0.9, 0.0])}
    assert mdp.episode_cost_above(env, limit=0.5).tolist() == [False, False]
    env.cost_manager = SimpleNamespace(episode_sums=sums)
    assert mdp.episode_cost_above(env, limit=0.5, cost="force").tolist() == [False, True]
    assert mdp.episode_cost_above(env, limit=1.0).tolist() == [True, False]
    with pytest.raises(ValueError, match="'strain', expected one of: force, view"):
        mdp.episode_cost_above(env, limit=1.0, cost="strain")


def test_wall_penetrated_is_what_the_simulation_says(env) -> None:
    env.sim = SimpleNamespace(wall_penetrated=torch.tensor([False, True]))
    assert mdp.wall_penetrated(env).tolist() == [False, True]


def test_success_at_the_end_of_the_segment(env) -> None:
    env.scope.tip_arc_length[:] = torch.tensor([0.4999, 0.5])
    assert mdp.success(env).tolist() == [False, True]


def test_stuck_after_a_window_without_progress(env) -> None:
    term, params = make_stuck(env)
    for _ in range(3):
        assert term(env, **params).tolist() == [False, False]
        env.scope.tip_arc_length[1] += 0.004
    # Three steps ago both were at zero; world 1 has made 12 mm since.
    assert term(env, **params).tolist() == [True, False]


def test_stuck_forgets_at_reset(env) -> None:
    term, params = make_stuck(env)
    for _ in range(3):
        term(env, **params)
    term.reset(torch.tensor([0]))
    assert term(env, **params).tolist() == [False, True]
    assert [term(env, **params).tolist() for _ in range(3)] == [[False, True], [False, True], [True, True]]


def test_lumen_not_visible_after_steps_in_a_row(env) -> None:
    term = mdp.lumen_not_visible(TerminationTermCfg(func=mdp.lumen_not_visible), env)
    images = env.scene["camera"].data
    depth = images.output["depth"]
    results = []
    for blocked in (True, True, False, True, True):
        depth[:] = 0.003 if blocked else 0.05
        depth[:, 1, 1] += 0.02 * (not blocked)
        images.frame += 1
        results.append(term(env, threshold=-0.4, steps=2).tolist()[0])
    assert results == [False, True, False, False, True]
    term.reset(None)
    images.frame += 1
    assert not term(env, threshold=-0.4, steps=2).any()


@pytest.mark.parametrize("name", ["time_out", "success", "scope_out", "view_blocked", "visible_rate"])
def test_terms_are_boolean(env, name: str) -> None:
    value = getattr(mdp, name)(env)
    assert value.dtype == torch.bool and value.shape == (2,)
