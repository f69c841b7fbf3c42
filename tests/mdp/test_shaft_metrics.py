# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Loops of drawn shafts, and measures of motions that can be counted by hand: two worlds, 10 Hz."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import torch
from drawn_shafts import up_and_round, zigzag

from arcgym.anatomy.segments import SEGMENTS
from arcgym.envs import mdp
from arcgym.managers import MetricsTermCfg


def kinds(env, *shafts: torch.Tensor) -> list[str]:
    env.scope.body_pos_w = torch.stack(shafts)
    env.common_step_counter += 1
    return [mdp.LOOPS[code] for code in mdp.loop_type(env).tolist()]


def test_a_crossing_in_front_is_an_alpha_and_one_behind_a_reverse_alpha(env) -> None:
    assert kinds(env, up_and_round(0.06), up_and_round(-0.06)) == ["alpha", "reverse_alpha"]
    assert mdp.loop_rate(env, "alpha").tolist() == [True, False]


def test_an_n_comes_down_by_four_centimeters_and_rises_again(env) -> None:
    assert kinds(env, zigzag(0.05), zigzag(0.03)) == ["n", "none"]


def test_what_lies_beyond_the_descending_colon_or_outside_is_no_loop(env) -> None:
    spans = env.scene["colon"].data.segment_spans.clone()
    spans[0, SEGMENTS.index("descending"), 1] = 0.05
    env.scene["colon"].data.segment_spans = spans
    assert kinds(env, up_and_round(0.06), up_and_round(0.06) - torch.tensor([0.0, 0.0, 0.3])) == ["none", "none"]


def test_a_capsule_has_no_loop(env) -> None:
    assert kinds(env, torch.zeros(1, 3), torch.zeros(1, 3)) == ["none", "none"]


def test_paradoxical_motion_counts_what_is_pushed_in_while_the_tip_slides_back(env) -> None:
    term = mdp.paradoxical_motion(MetricsTermCfg(func=mdp.paradoxical_motion), env)
    steps = [((0.30, 0.30), (0.20, 0.20)), ((0.32, 0.30), (0.19, 0.22)), ((0.33, 0.29), (0.20, 0.21))]
    found = []
    for inserted, arc in steps:
        env.scope.inserted_length, env.scope.tip_arc_length = torch.tensor(inserted), torch.tensor(arc)
        found.append(term(env))
    # World 0 pushes 2 cm and slides back, then advances; world 1 holds, then pulls and slides back.
    torch.testing.assert_close(torch.stack(found), torch.tensor([[0.0, 0.0], [0.02, 0.0], [0.0, 0.0]]))


def test_efficiency_is_the_way_along_the_lumen_over_the_path_of_the_tip(env) -> None:
    term = mdp.path_efficiency(MetricsTermCfg(func=mdp.path_efficiency), env)
    for x, z in ((0.0, 0.0), (0.03, 0.04), (0.0, 0.08)):  # two diagonals of 5 cm make 8 cm along the lumen
        env.scope.tip_pos_w = torch.tensor([[x, 0.0, z], [0.0, 0.0, z]])
        env.scope.tip_arc_length = torch.tensor([z, z])
        value = term(env)
    torch.testing.assert_close(value, torch.tensor([0.8, 1.0]))
    term.reset(torch.tensor([0]))
    assert term(env).tolist() == [0.0, pytest.approx(1.0)]


def test_sheets_are_stretched_beyond_their_length(env) -> None:
    env.scene["colon"].cfg.mesentery.enabled = True
    env.scene["colon"].data.mesentery_stretch = torch.tensor([[0.0, 0.01, 0.03], [0.0, 0.0, 0.0]])
    term = mdp.mesentery_stretch(MetricsTermCfg(func=mdp.mesentery_stretch), env)
    torch.testing.assert_close(term(env), torch.tensor([0.03, 0.0]))


def test_a_mesentery_is_stretched_by_what_goes_beyond_its_slack(env) -> None:
    colon = env.scene["colon"]
    codes = [SEGMENTS.index(name) for name in ("rectum", "sigmoid", "sigmoid")]
    wall = SimpleNamespace(
        layer=np.zeros(6, int),
        ring=np.repeat([0, 1, 2], 2),
        ring_arc=np.array([0.0, 0.1, 0.2]),
        points=np.array([[x, 0.0, z] for z in (0.0, 0.1, 0.2) for x in (-0.02, 0.02)]),
        segment=np.repeat(codes, 2),
    )
    colon.patients[0].wall = wall
    colon.anchor_springs = lambda patient: SimpleNamespace(slack=np.repeat([0.0, 0.06, 0.0], 2))
    # Rings move 5 cm in the rectum, 8 in the sigmoid with 6 of slack, and 1 where it has none.
    moved = torch.tensor([[0.05, 0.0, 0.0], [0.08, 0.0, 0.1], [0.0, 0.01, 0.2]])
    colon.data.centerline_pos_w = torch.stack([moved, torch.tensor([[0.0, 0.0, z] for z in (0.0, 0.1, 0.2)])])
    term = mdp.mesentery_stretch(MetricsTermCfg(func=mdp.mesentery_stretch), env)
    torch.testing.assert_close(term(env), torch.tensor([0.02, 0.0]), atol=1e-6, rtol=0.0)


def test_loops_are_looked_for_again_where_worlds_were_put_elsewhere(env) -> None:
    """A reset or an undo moves the shaft within one control step."""
    assert kinds(env, up_and_round(0.06), up_and_round(0.06)) == ["alpha", "alpha"]
    env.scope.body_pos_w = torch.stack([up_and_round(-0.06), up_and_round(0.06)])
    env.sim.written_states += 1
    assert [mdp.LOOPS[code] for code in mdp.loop_type(env).tolist()] == ["reverse_alpha", "alpha"]
