# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Reward, cost and metric terms on numbers set by hand."""

from __future__ import annotations

import math

import pytest
import torch

from arcgym.anatomy.segments import SEGMENTS
from arcgym.envs import mdp
from arcgym.managers import CostTermCfg, RewardTermCfg


def test_progress_is_the_advance_since_the_last_step(env) -> None:
    term = mdp.progress(RewardTermCfg(func=mdp.progress), env)
    env.scope.tip_arc_length[:] = torch.tensor([0.20, 0.30])
    torch.testing.assert_close(term(env), torch.zeros(2))
    env.scope.tip_arc_length[:] = torch.tensor([0.204, 0.299])
    torch.testing.assert_close(term(env), torch.tensor([0.004, -0.001]))


def test_progress_does_not_count_a_reset(env) -> None:
    term = mdp.progress(RewardTermCfg(func=mdp.progress), env)
    term(env)
    term.reset(torch.tensor([1]))
    env.scope.tip_arc_length[:] = 0.2
    torch.testing.assert_close(term(env), torch.tensor([0.2, 0.0]))


def test_success_is_by_arc_length(env) -> None:
    env.scope.tip_arc_length[:] = torch.tensor([0.499, 0.5])
    assert mdp.success(env).tolist() == [0.0, 1.0]
    assert mdp.success(env, segment="rectum").tolist() == [1.0, 1.0]


def test_a_withdrawal_goes_from_the_start_of_the_segment_back_to_the_rectum(env) -> None:
    """The sigmoid begins at 10 cm: a way of 5 cm to the end at 5 cm."""
    env.cfg.direction = "withdrawal"
    env.scope.tip_arc_length[:] = torch.tensor([0.08, 0.05])
    torch.testing.assert_close(mdp.segment_progress(env), torch.tensor([0.4, 1.0]))
    assert mdp.success(env).tolist() == [False, True]
    env.episode_length_buf[:] = 10
    torch.testing.assert_close(mdp.mean_speed(env), torch.tensor([0.02, 0.05]))


def test_the_cecum_is_reached_halfway_from_its_valve_to_its_blind_end(env, monkeypatch) -> None:
    """A cecum from 44 to 50 cm is reached at 47 cm, 94 % of the way from the anus; progress counts on to its end."""
    monkeypatch.setattr(env.scene["colon"], "require_segment", lambda name: None)
    spans = env.scene["colon"].data.segment_spans.clone()
    spans[:, SEGMENTS.index("cecum")] = torch.tensor([0.44, 0.50])
    env.scene["colon"].data.segment_spans = spans
    env.cfg.segment = "cecum"
    for env.cfg.start in ("rest", "segment"):
        env.scope.tip_arc_length[:] = torch.tensor([0.469, 0.471])
        assert mdp.success(env).tolist() == [False, True]
        assert mdp.success(env, segment="cecum").tolist() == [False, True]
    env.cfg.start = "rest"
    torch.testing.assert_close(mdp.segment_progress(env), torch.tensor([0.938, 0.942]))
    env.cfg.direction = "withdrawal"
    env.scope.tip_arc_length[:] = torch.tensor([0.471, 0.05])
    assert mdp.success(env).tolist() == [False, True]


def test_unknown_segment_lists_the_known(env) -> None:
    with pytest.raises(ValueError, match="'colon' is not in colon.usda.*rectum.*sigmoid"):
        mdp.success(env, segment="colon")


def test_shaft_force_counts_above_the_tier(env) -> None:
    env.scope.window_force_w[0, 1] = torch.tensor([3.0, 0.0, 4.0])
    env.scope.window_force_w[1, 1] = torch.tensor([1.0, 0.0, 0.0])
    torch.testing.assert_close(mdp.load_excess(env, "shaft_force", limit=2.0), torch.tensor([3.0, 0.0]))


def test_action_rate_is_squared_and_summed(env) -> None:
    env.action_manager.action = torch.tensor([[1.0, 0.5], [0.0, 0.0]])
    env.action_manager.prev_action = torch.tensor([[0.0, 0.0], [0.0, 0.0]])
    torch.testing.assert_close(mdp.action_rate_l2(env), torch.tensor([1.25, 0.0]))


def test_lumen_terms_agree_with_the_scores(env) -> None:
    env.scene["camera"].data.output["depth"][0, 1:3, 2:4] = 0.1
    scores = mdp.lumen_scores(env)
    assert torch.equal(mdp.lumen_centering(env), scores.s_c)
    assert torch.equal(mdp.lumen_visibility(env), scores.s_o)
    torch.testing.assert_close(mdp.lumen_reward(env), 0.5 * scores.s_c + 0.5 * scores.s_o)


def test_costs_are_indicators(env) -> None:
    env.scope.tip_force_w[:, 0] = torch.tensor([6.0, 0.0])
    assert mdp.load_above(env, "tip_force", limit=5.0).tolist() == [1.0, 0.0]
    env.scene["camera"].data.output["depth"][0] = 0.004
    assert mdp.view_blocked(env).tolist() == [1.0, 0.0]
    assert CostTermCfg(func=mdp.view_blocked).params == {}


def test_a_corner_is_visible_off_center_and_a_flat_wall_is_centered_and_no_lumen(env) -> None:
    """World 0: one deep pixel of 24 in the corner, s_c = 0 and s_o = 2 * 0.6 * 1 * 1 - 1 = 0.2. World 1: s_o = -1."""
    env.scene["camera"].data.output["depth"][0, 0, 0] = 0.2
    assert mdp.centered_rate(env).tolist() == [False, True]
    assert mdp.visible_rate(env).tolist() == [True, False]
    assert mdp.visible_rate(env, threshold=0.3).tolist() == [False, False]
    torch.testing.assert_close(mdp.lumen_lost(env), torch.tensor([0.0, -1.0]))


def test_looking_to_the_side_and_back_is_misaligned(env) -> None:
    """On the axis of a straight colon along +Z, looking 60 degrees to the side and, in the second world, back."""
    env.scope.tip_arc_length[:] = 0.15
    env.scope.tip_pos_w[:] = torch.tensor([0.0, 0.0, 0.15])
    env.scope.tip_quat_w[:] = torch.tensor([[0.0, 0.5, 0.0, math.sqrt(0.75)], [1.0, 0.0, 0.0, 0.0]])
    torch.testing.assert_close(mdp.lumen_misalignment(env), torch.tensor([0.5, 2.0]))


def test_misalignment_is_of_the_way_to_a_point_ahead(env) -> None:
    """A tip 3 cm beside the axis that looks along it: the point 4 cm ahead is at a slope of 3 to 4, 5 cm away."""
    env.scope.tip_arc_length[:] = 0.15
    env.scope.tip_pos_w[:] = torch.tensor([0.03, 0.0, 0.15])
    torch.testing.assert_close(mdp.lumen_misalignment(env, ahead=0.04), torch.tensor([0.2, 0.2]))


def test_progress_fraction_is_clamped(env) -> None:
    env.scope.tip_arc_length[:] = torch.tensor([0.2, 0.7])
    torch.testing.assert_close(mdp.progress_fraction(env), torch.tensor([0.25, 1.0]))


def test_time_to_success_is_the_limit_for_failures(env) -> None:
    env.episode_length_buf[:] = 40
    env.scope.tip_arc_length[:] = torch.tensor([0.2, 0.5])
    torch.testing.assert_close(mdp.time_to_success(env), torch.tensor([10.0, 4.0]))


def test_looping_ratio_and_speed(env) -> None:
    env.episode_length_buf[:] = 20
    env.scope.tip_arc_length[:] = 0.2
    env.scope.inserted_length[:] = 0.25
    torch.testing.assert_close(mdp.looping_ratio(env), torch.full((2,), 1.25))
    torch.testing.assert_close(mdp.mean_speed(env), torch.full((2,), 0.05))


def test_a_task_without_the_setting_is_told_what_to_add(env) -> None:
    del env.cfg.segment
    with pytest.raises(ValueError, match="needs 'segment', but SimpleNamespace has no such field"):
        mdp.success(env)
    assert mdp.success(env, segment="rectum").tolist() == [0.0, 0.0]


def test_the_way_begins_at_the_anus_where_the_episode_does(env) -> None:
    """From rest through the sigmoid, which ends at 0.5 m: a tip at 0.2 m has two fifths behind it, not a quarter."""
    env.scope.tip_arc_length[:] = 0.2
    assert mdp.segment_progress(env).tolist() == pytest.approx([0.25, 0.25])
    env.cfg.start = "rest"
    assert mdp.segment_progress(env).tolist() == pytest.approx([0.4, 0.4])
    assert mdp.segment_progress(env, segment="sigmoid").tolist() == pytest.approx([0.25, 0.25])


def test_a_part_of_the_reward_is_that_of_the_scores(env) -> None:
    parts = mdp.lumen_scores(env)
    for part in ("s_c", "s_1", "s_2", "s_3", "s_o"):
        torch.testing.assert_close(mdp.lumen_part(env, part), getattr(parts, part))
