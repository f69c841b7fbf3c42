# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Terms of force, strain and pull on numbers set by hand: two worlds, three links, six rings, 10 Hz."""

from __future__ import annotations

import math

import pytest
import torch

from arcgym.envs import mdp
from arcgym.managers import MetricsTermCfg


@pytest.fixture
def loaded(env):
    """World 0 presses with 3 N at the tip and 4 N at the base link, world 1 with 20 N at the tip."""
    env.scope.wall_force_w[0] = torch.tensor([[0.0, 4.0, 0.0], [0.0, 0.0, 0.0], [3.0, 0.0, 0.0]])
    env.scope.wall_force_w[1, 2] = torch.tensor([0.0, 12.0, 16.0])
    env.scope.tip_force[:] = torch.tensor([3.0, 20.0])
    env.scope.tip_force_peak[:] = torch.tensor([5.5, 25.0])
    env.scene["colon"].data.wall_strain[:, 2] = torch.tensor([0.3, 0.7])
    env.scene["colon"].data.wall_strain_peak[:, 2] = torch.tensor([0.4, 0.8])
    env.scene["colon"].data.anchor_tension[0, 4] = 1.0
    env.scene["colon"].data.anchor_tension_peak[0, 4] = 1.5
    return env


def test_observations_are_in_newtons(loaded) -> None:
    torch.testing.assert_close(mdp.tip_force(loaded), torch.tensor([[3.0], [20.0]]))
    torch.testing.assert_close(mdp.link_forces(loaded), torch.tensor([[4.0, 0.0, 3.0], [0.0, 0.0, 20.0]]))
    assert mdp.wall_strain(loaded).shape == mdp.anchor_tension(loaded).shape == (2, 6)
    assert mdp.base_force(loaded).shape == (2, 1)


def test_tip_force_vector_is_in_the_tip_frame(loaded) -> None:
    # A quarter turn around Y takes the tip's +Z to the world's +X.
    loaded.scope.tip_quat_w[0] = torch.tensor([0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5)])
    expected = torch.tensor([[0.0, 0.0, 3.0], [0.0, 12.0, 16.0]])
    torch.testing.assert_close(mdp.tip_force_vector(loaded), expected, atol=1e-5, rtol=0.0)


def test_penalties(loaded) -> None:
    torch.testing.assert_close(mdp.tip_force_l2(loaded), torch.tensor([9.0, 400.0]))
    torch.testing.assert_close(mdp.excess_tip_force(loaded), torch.tensor([1.0, 18.0]))
    torch.testing.assert_close(mdp.excess_wall_force(loaded), torch.tensor([2.0, 18.0]))
    torch.testing.assert_close(mdp.excess_wall_strain(loaded, limit=0.5), torch.tensor([0.0, 0.2]))


def test_costs_count_tiers(loaded) -> None:
    assert mdp.tip_force_above(loaded).tolist() == [0.0, 1.0]
    assert mdp.tip_force_above(loaded, limit="comfort").tolist() == [1.0, 1.0]
    assert mdp.wall_force_above(loaded, limit=3.5).tolist() == [1.0, 1.0]
    assert mdp.wall_strain_above(loaded).tolist() == [0.0, 1.0]
    assert mdp.wall_strain_above(loaded, limit=0.75, peak=True).tolist() == [0.0, 1.0]


def test_pull_on_the_anchors(loaded) -> None:
    torch.testing.assert_close(mdp.excess_anchor_tension(loaded, limit=0.4), torch.tensor([0.6, 0.0]))
    assert mdp.anchor_tension_above(loaded, limit=1.2).tolist() == [0.0, 0.0]
    assert mdp.anchor_tension_above(loaded, limit=1.2, peak=True).tolist() == [1.0, 0.0]
    assert mdp.anchors_overloaded(loaded, limit=0.4).tolist() == [True, False]
    assert mdp.overstrained(loaded, limit=0.5).tolist() == [False, True]


def test_peaks_on_request(loaded) -> None:
    loaded.scope.wall_force_peak[0, 1] = 7.0
    torch.testing.assert_close(mdp.tip_force(loaded, peak=True), torch.tensor([[5.5], [25.0]]))
    assert mdp.excess_tip_force(loaded, limit=5.0, peak=True).tolist() == [0.5, 20.0]
    assert mdp.excess_wall_force(loaded, limit=5.0, peak=True).tolist() == [2.0, 0.0]
    assert mdp.perforation(loaded, limit=22.0, peak=True).tolist() == [False, True]
    assert mdp.excess_force(loaded, limit=6.0, peak=True).tolist() == [True, False]


def test_perforation_is_by_the_tip_alone(loaded) -> None:
    assert mdp.perforation(loaded).tolist() == [False, True]
    loaded.scope.wall_force_w[0, 0] = 30.0
    assert mdp.perforation(loaded).tolist() == [False, True]
    assert mdp.excess_force(loaded).tolist() == [True, True]


def test_metrics_of_one_step(loaded) -> None:
    torch.testing.assert_close(mdp.tip_impulse(loaded), torch.tensor([0.3, 2.0]))
    torch.testing.assert_close(mdp.time_above(loaded, "unsafe"), torch.tensor([0.0, 0.1]))
    torch.testing.assert_close(mdp.peak_tip_force(loaded), torch.tensor([5.5, 25.0]))
    torch.testing.assert_close(mdp.max_wall_strain(loaded), torch.tensor([0.4, 0.8]))
    torch.testing.assert_close(mdp.max_anchor_tension(loaded), torch.tensor([1.5, 0.0]))


def test_percentile_over_the_episode(env) -> None:
    term = mdp.tip_force_percentile(MetricsTermCfg(func=mdp.tip_force_percentile), env)
    for force in range(1, 21):
        env.scope.tip_force[:] = torch.tensor([float(force), 0.0])
        value = term(env)
    # 19 of 20 steps, 95 %, are at most 19 N; bins are 5 % wide.
    assert 19.0 <= float(value[0]) <= 19.0 * 1.05
    assert float(value[1]) == 0.0


def test_percentile_forgets_at_reset(env) -> None:
    term = mdp.tip_force_percentile(MetricsTermCfg(func=mdp.tip_force_percentile), env)
    env.scope.tip_force[:] = 10.0
    term(env)
    term.reset(torch.tensor([1]))
    env.scope.tip_force[:] = 1.0
    value = term(env, percentile=95.0)
    assert value[0] > 9.9 and value[1] < 1.06


def test_a_task_changes_the_tiers_of_all_its_terms(loaded) -> None:
    loaded.cfg.force_tiers = mdp.ForceTiersCfg(comfort=1.0, unsafe=2.5, perforation=30.0)
    assert mdp.tip_force_above(loaded).tolist() == [1.0, 1.0]
    assert mdp.perforation(loaded).tolist() == [False, False]


def test_unknown_tier_lists_the_known(env) -> None:
    with pytest.raises(ValueError, match="no force tier 'unsave'.*'unsafe'.*comfort, perforation, unsafe"):
        mdp.force_limit(env, "unsave")


def test_tiers_must_rise() -> None:
    with pytest.raises(ValueError, match="got 6.0, 5.0 and 14.1 N"):
        mdp.ForceTiersCfg(comfort=6.0).validate_config()
