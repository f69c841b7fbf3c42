# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Terms of force, strain and pull on numbers set by hand: two worlds, three windows, six rings, 10 Hz."""

from __future__ import annotations

import math

import pytest
import torch

from arcgym.envs import mdp
from arcgym.envs.mdp import load_metrics
from arcgym.managers import MetricsTermCfg, RewardTermCfg


@pytest.fixture
def loaded(env):
    """World 0 presses with 3 N at the tip and 4 N at the shaft, world 1 with 20 N at the tip."""
    env.scope.window_force_w[0] = torch.tensor([[3.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 4.0, 0.0]])
    env.scope.window_force_w[1, 0] = torch.tensor([0.0, 12.0, 16.0])
    env.scope.tip_force_w[:] = env.scope.window_force_w[:, 0]
    env.scope.tip_force_peak[:] = torch.tensor([5.5, 25.0])
    env.scene["colon"].data.wall_strain[:, 2] = torch.tensor([0.3, 0.7])
    env.scene["colon"].data.wall_strain_peak[:, 2] = torch.tensor([0.4, 0.8])
    env.scene["colon"].data.anchor_tension[0, 4] = 1.0
    env.scene["colon"].data.anchor_tension_peak[0, 4] = 1.5
    return env


def test_observations_are_in_newtons(loaded) -> None:
    torch.testing.assert_close(mdp.load_parts(loaded, "tip_force"), torch.tensor([[3.0], [20.0]]))
    torch.testing.assert_close(mdp.load_parts(loaded, "shaft_force"), torch.tensor([[3.0, 0.0, 4.0], [20.0, 0.0, 0.0]]))
    assert mdp.load_parts(loaded, "wall_strain").shape == (2, 6)
    assert mdp.load_parts(loaded, "anchor_tension").shape == (2, 6)
    assert mdp.base_force(loaded).shape == (2, 1)


def test_tip_force_vector_is_in_the_tip_frame(loaded) -> None:
    # A quarter turn around Y takes the tip's +Z to the world's +X.
    loaded.scope.tip_quat_w[0] = torch.tensor([0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5)])
    expected = torch.tensor([[0.0, 0.0, 3.0], [0.0, 12.0, 16.0]])
    torch.testing.assert_close(mdp.tip_force_vector(loaded), expected, atol=1e-5, rtol=0.0)


def test_penalties(loaded) -> None:
    torch.testing.assert_close(mdp.load_l2(loaded, "tip_force"), torch.tensor([9.0, 400.0]))
    torch.testing.assert_close(mdp.load_excess(loaded, "tip_force", "comfort"), torch.tensor([1.0, 18.0]))
    torch.testing.assert_close(mdp.load_excess(loaded, "shaft_force", "comfort"), torch.tensor([2.0, 18.0]))
    torch.testing.assert_close(mdp.load_excess(loaded, "wall_strain", limit=0.5), torch.tensor([0.0, 0.2]))


def test_above_a_tier_or_a_number(loaded) -> None:
    assert mdp.load_above(loaded, "tip_force", "unsafe").tolist() == [False, True]
    assert mdp.load_above(loaded, "tip_force", "comfort").tolist() == [True, True]
    assert mdp.load_above(loaded, "shaft_force", 3.5).tolist() == [True, True]
    assert mdp.load_above(loaded, "wall_strain", 0.5).tolist() == [False, True]
    assert mdp.load_above(loaded, "wall_strain", 0.75, reduce="peak").tolist() == [False, True]


def test_pull_on_the_anchors(loaded) -> None:
    torch.testing.assert_close(mdp.load_excess(loaded, "anchor_tension", limit=0.4), torch.tensor([0.6, 0.0]))
    assert mdp.load_above(loaded, "anchor_tension", 1.2).tolist() == [False, False]
    assert mdp.load_above(loaded, "anchor_tension", 1.2, reduce="peak").tolist() == [True, False]


def test_peaks_on_request(loaded) -> None:
    loaded.scope.window_force_peak[0, 1] = 7.0
    torch.testing.assert_close(mdp.load_parts(loaded, "tip_force", "peak"), torch.tensor([[5.5], [25.0]]))
    assert mdp.load_excess(loaded, "tip_force", 5.0, reduce="peak").tolist() == [0.5, 20.0]
    assert mdp.load_excess(loaded, "shaft_force", 5.0, reduce="peak").tolist() == [2.0, 0.0]
    assert mdp.load_above(loaded, "shaft_force", 6.0, reduce="peak").tolist() == [True, False]


def test_tip_force_leaves_the_shaft_out(loaded) -> None:
    loaded.scope.window_force_w[0, 2] = 30.0
    assert mdp.load_above(loaded, "tip_force", "perforation").tolist() == [False, True]
    assert mdp.load_above(loaded, "shaft_force", "perforation").tolist() == [True, True]


def test_load_is_that_of_the_hardest_pressing_window(loaded) -> None:
    torch.testing.assert_close(mdp.load(loaded, "shaft_force"), torch.tensor([4.0, 20.0]))


def test_a_load_of_ones_own_has_all_terms(loaded, monkeypatch) -> None:
    monkeypatch.setitem(mdp.LOADS, "depth", mdp.Load("endoscope", "inserted_length", "inserted_length", "m"))
    loaded.scope.inserted_length[:] = torch.tensor([0.2, 0.5])
    torch.testing.assert_close(mdp.load_excess(loaded, "depth", 0.4), torch.tensor([0.0, 0.1]))
    RewardTermCfg(func=mdp.load_excess, params={"kind": "depth", "limit": 0.4}).validate()


def test_metrics_of_one_step(loaded) -> None:
    torch.testing.assert_close(mdp.load_impulse(loaded, "tip_force"), torch.tensor([0.3, 2.0]))
    torch.testing.assert_close(mdp.load_time_above(loaded, "tip_force", "unsafe"), torch.tensor([0.0, 0.1]))
    torch.testing.assert_close(mdp.load(loaded, "tip_force", "peak"), torch.tensor([5.5, 25.0]))
    torch.testing.assert_close(mdp.load(loaded, "wall_strain", "peak"), torch.tensor([0.4, 0.8]))
    torch.testing.assert_close(mdp.load(loaded, "anchor_tension", "peak"), torch.tensor([1.5, 0.0]))


def test_percentile_over_the_episode(env) -> None:
    term = mdp.load_percentile(MetricsTermCfg(func=mdp.load_percentile), env)
    for force in range(1, 21):
        env.scope.tip_force_w[0, 2] = force
        value = term(env, "tip_force")
    # 19 of 20 steps, 95 %, are at most 19 N, the only one in its bin of 5 %.
    assert float(value[0]) == 19.0
    assert float(value[1]) == 0.0


@pytest.mark.parametrize("force", [0.003, 4.26, 250.0])
def test_a_steady_load_is_its_own_percentile(env, force: float) -> None:
    """Also below the first bin and above the last one, and never above the largest load."""
    term = mdp.load_percentile(MetricsTermCfg(func=mdp.load_percentile), env)
    env.scope.tip_force_w[0, 2] = force
    values = [float(term(env, "tip_force")[0]) for _ in range(3)]
    assert values == pytest.approx([force] * 3)


@pytest.mark.parametrize(("kind", "largest"), [("tip_force", 20.0), ("wall_strain", 0.02), ("lumen_pressure", 8000.0)])
def test_percentiles_of_every_load_are_within_five_percent(env, monkeypatch, kind: str, largest: float) -> None:
    """Of 100 steps that rise evenly to the largest the 95th percentile is 0.95 of it."""
    monkeypatch.setattr(load_metrics, "load", lambda env, kind: env.now)
    term = mdp.load_percentile(MetricsTermCfg(func=mdp.load_percentile), env)
    for step in range(1, 101):
        env.now = torch.full((2,), largest * step / 100)
        value = term(env, kind)
    assert value.tolist() == pytest.approx([0.95 * largest] * 2, rel=0.05)


def test_percentile_forgets_at_reset(env) -> None:
    term = mdp.load_percentile(MetricsTermCfg(func=mdp.load_percentile), env)
    env.scope.tip_force_w[:, 2] = 10.0
    term(env, "tip_force")
    term.reset(torch.tensor([1]))
    env.scope.tip_force_w[:, 2] = 1.0
    value = term(env, "tip_force", percentile=95.0)
    assert value[0] > 9.9 and value[1] < 1.06


def test_a_task_changes_the_tiers_of_all_its_terms(loaded) -> None:
    loaded.cfg.force_tiers = mdp.ForceTiersCfg(comfort=1.0, unsafe=2.5, perforation=30.0)
    assert mdp.load_above(loaded, "tip_force", "unsafe").tolist() == [True, True]
    assert mdp.load_above(loaded, "tip_force", "perforation").tolist() == [False, False]


def test_unknown_tier_lists_the_known(env) -> None:
    with pytest.raises(ValueError, match="no force tier 'unsave'.*'unsafe'.*comfort, perforation, unsafe"):
        mdp.force_limit(env, "unsave")


@pytest.mark.parametrize("term", [mdp.load_above, mdp.load_excess, mdp.load_time_above])
def test_tiers_are_of_forces_alone(loaded, term) -> None:
    with pytest.raises(ValueError, match="limit is 'comfort' for wall_strain, expected a number"):
        term(loaded, "wall_strain", limit="comfort")


def test_tiers_must_rise() -> None:
    with pytest.raises(ValueError, match=r"comfort \(6.0 N\) < unsafe \(5.0 N\) < perforation"):
        mdp.ForceTiersCfg(comfort=6.0).validate_config()
