# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Actions: scale, clip, constant forward velocity, reset."""

from __future__ import annotations

import math

import pytest
import torch

from arcgym.envs import mdp


def test_tip_velocity_is_scaled_and_clipped(env) -> None:
    term = mdp.TipVelocityAction(mdp.TipVelocityActionCfg(linear_scale=0.05, angular_scale=2.0), env)
    assert term.action_dim == 6
    term.process_actions(torch.tensor([[1.0, -3.0, 0.5, 0.0, 0.0, -0.5]] * 2))
    term.apply_actions()
    linear, angular = env.scene["endoscope"].commands["tip"]
    torch.testing.assert_close(linear[0], torch.tensor([0.05, -0.05, 0.025]))
    torch.testing.assert_close(angular[0], torch.tensor([0.0, 0.0, -1.0]))
    assert term.raw_actions[0, 1] == -3.0


def test_roll_has_a_scale_of_its_own(env) -> None:
    term = mdp.TipVelocityAction(mdp.TipVelocityActionCfg(angular_scale=2.0, roll_scale=9.0), env)
    term.process_actions(torch.tensor([[0.0, 0.0, 0.0, 0.5, -0.5, 0.5]] * 2))
    torch.testing.assert_close(term.processed_actions[0, 3:], torch.tensor([1.0, -1.0, 4.5]))


@pytest.mark.parametrize("term_class, cfg, axis", [
    (mdp.TipVelocityAction, mdp.TipVelocityActionCfg(angular_scale=2.0, roll_amplitude=8.0, roll_period=4.0), 5),
    (mdp.InsertionAction, mdp.InsertionActionCfg(roll_scale=2.0, roll_amplitude=8.0, roll_period=4.0), 1),
])  # fmt: skip
def test_roll_to_and_fro_is_added_to_the_commanded_roll(env, term_class, cfg, axis) -> None:
    term = term_class(cfg, env)
    env.scope.inserted_length[:] = torch.tensor([0.3, 2.0])  # half and all of the 0.6 m that take the whole amplitude
    raw = torch.zeros(2, term.action_dim)
    raw[:, axis] = 0.5  # 1 rad/s
    for _ in range(11):  # the eleventh step begins after 1 s: a quarter of a period
        term.process_actions(raw)
    torch.testing.assert_close(term.processed_actions[:, axis], torch.tensor([1.0 + 4.0, 1.0 + 8.0]))
    torch.testing.assert_close(term.raw_actions, raw)
    commanded = torch.zeros(2, len(term.axes))
    commanded[:, term.axes.index("roll")] = 1.0
    torch.testing.assert_close(term._as_actions(commanded), raw)  # what an expert commands has no oscillation
    term.reset(torch.tensor([0]))
    term.process_actions(raw)
    assert term.processed_actions[0, axis] == 1.0
    assert abs(float(term.processed_actions[1, axis]) - (1.0 + 8.0 * math.cos(2.0 * math.pi / 40.0))) < 1e-5


def test_a_tip_whose_tether_stands_still_goes_back_for_a_while(env) -> None:
    """Two steps of 0.1 s at the policy's 0.02 m/s, then one at -0.04 m/s; the second world comes on by 6 mm a step."""
    cfg = mdp.TipVelocityActionCfg(linear_scale=0.04, back_off_velocity=0.04, back_off_after=0.2, back_off_time=0.1)
    term = mdp.TipVelocityAction(cfg, env)
    raw = torch.full((2, 6), 0.5)
    forward = []
    for step in range(6):
        env.scope.inserted_length[:] = torch.tensor([0.3, 0.3 + 0.006 * step])
        term.process_actions(raw)
        forward.append(term.processed_actions[:, 2].tolist())
        assert (term.processed_actions[:, :2] == 0.02).all() and (term.raw_actions == raw).all()
    there, back = pytest.approx([0.02, 0.02]), pytest.approx([-0.04, 0.02])
    assert forward == [there, there, back, there, there, back]
    for forget in term.reset, lambda ids: term.resume(7, ids):
        forget(torch.tensor([0]))
        term.process_actions(raw)
        assert term.processed_actions[0, 2] == 0.02


def test_no_tip_goes_back_by_default(env) -> None:
    term = mdp.TipVelocityAction(mdp.TipVelocityActionCfg(), env)
    for _ in range(60):  # 6 s, longer than the wait of 4 s
        term.process_actions(torch.ones(2, 6))
        assert (term.processed_actions[:, 2] == 0.045).all()


def test_constant_forward_velocity_drops_the_forward_action(env) -> None:
    term = mdp.TipVelocityAction(mdp.TipVelocityActionCfg(linear_scale=0.05, forward_velocity=0.02), env)
    assert term.action_dim == 5
    term.process_actions(torch.tensor([[1.0, 0.0, 0.0, 0.0, 0.0]] * 2))
    torch.testing.assert_close(term.processed_actions[1, :3], torch.tensor([0.05, 0.0, 0.02]))


def test_insertion_moves_base_and_bending(env) -> None:
    cfg = mdp.InsertionActionCfg(insertion_scale=0.05, roll_scale=1.0, bending_scale=1.3)
    term = mdp.InsertionAction(cfg, env)
    env.scope.bending[:] = torch.tensor([0.5, -0.5])
    term.process_actions(torch.tensor([[1.0, -0.5, 1.0, -2.0]] * 2))
    term.apply_actions()
    commands = env.scene["endoscope"].commands
    torch.testing.assert_close(commands["base"][0], torch.full((2,), 0.05))
    torch.testing.assert_close(commands["base"][1], torch.full((2,), -0.5))
    # One step of 0.1 s at 1.3 rad/s turns by 0.13 rad.
    torch.testing.assert_close(commands["bending"][0], torch.full((2,), 0.63))
    torch.testing.assert_close(commands["bending"][1], torch.full((2,), -0.63))


def test_constant_insertion_drops_the_insertion_action(env) -> None:
    term = mdp.InsertionAction(mdp.InsertionActionCfg(insertion_velocity=0.03), env)
    assert term.action_dim == 3
    term.process_actions(torch.zeros(2, 3))
    torch.testing.assert_close(term.processed_actions[:, 0], torch.full((2,), 0.03))


def test_reset_touches_only_its_worlds(env) -> None:
    term = mdp.TipVelocityAction(mdp.TipVelocityActionCfg(), env)
    term.process_actions(torch.ones(2, 6))
    term.reset(torch.tensor([1]))
    assert term.raw_actions[0].all() and not term.raw_actions[1].any() and not term.processed_actions[1].any()
