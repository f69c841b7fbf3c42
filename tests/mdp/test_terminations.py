# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Terminations on numbers set by hand."""

from __future__ import annotations

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


def test_withdrawn_at_the_anal_verge(env) -> None:
    env.scope.tip_arc_length = torch.tensor([-0.001, 0.001])
    assert mdp.withdrawn(env).tolist() == [True, False]


def test_pierced_is_what_the_simulation_says(env) -> None:
    env.sim = SimpleNamespace(pierced=torch.tensor([False, True]))
    assert mdp.pierced(env).tolist() == [False, True]


def test_segment_passed_at_its_end(env) -> None:
    env.scope.tip_arc_length[:] = torch.tensor([0.4999, 0.5])
    assert mdp.segment_passed(env).tolist() == [False, True]


def test_excess_force_by_any_link(env) -> None:
    env.scope.wall_force_w[0, 0] = torch.tensor([0.0, 14.5, 0.0])
    env.scope.wall_force_w[1, 2] = torch.tensor([0.0, 13.5, 0.0])
    assert mdp.excess_force(env, limit=14.0).tolist() == [True, False]


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


def test_lumen_lost_after_steps_in_a_row(env) -> None:
    term = mdp.lumen_lost(TerminationTermCfg(func=mdp.lumen_lost), env)
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


@pytest.mark.parametrize("name", ["time_out", "segment_passed", "withdrawn", "excess_force"])
def test_terms_are_boolean(env, name: str) -> None:
    value = getattr(mdp, name)(env)
    assert value.dtype == torch.bool and value.shape == (2,)
