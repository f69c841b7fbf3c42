# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

from types import SimpleNamespace

import pytest
import torch

from arcgym.rl.action_constraints import (
    INSERTION_AXES,
    TIP_AXES,
    ActionConstraint,
    ConstraintRules,
    deep_region_offset,
)


def view(*lit: tuple[int, int], near: float = 0.02, deep: float = 0.1) -> torch.Tensor:
    """One world's 5 x 5 depth image with some deep pixels (row, column)."""
    depth = torch.full((1, 5, 5), near)
    for row, column in lit:
        depth[0, row, column] = deep
    return depth


def constrain(axes, depth, actions, **rules) -> list[float]:
    constraint = ActionConstraint(axes, lambda: depth, ConstraintRules(**rules))
    return constraint(torch.tensor([actions]))[0].tolist()


def test_offset_is_the_mean_place_of_the_deep_pixels():
    """Columns 3 and 4 of five are 0.5 and 1 half images right of the middle, row 1 half of one above it."""
    offset = deep_region_offset(view((1, 3), (1, 4)), threshold=0.7, far=1.0)
    torch.testing.assert_close(offset, torch.tensor([[0.75, -0.5]]))


def test_tip_moves_and_turns_towards_a_lumen_right_and_below():
    """Image right is the tip's -X: motion along -X and -Y, pitch up, yaw down pass; their opposites become zero."""
    depth = view((4, 4))
    assert constrain(TIP_AXES, depth, [-0.5, -0.5, 0.0, 0.5, -0.5, 0.9]) == pytest.approx(
        [-0.5, -0.5, 0.8, 0.5, -0.5, 0.0]
    )
    assert constrain(TIP_AXES, depth, [0.5, 0.5, 0.0, -0.5, 0.5, 0.9]) == pytest.approx([0, 0, 0.8, 0, 0, 0])


def test_pushed_scope_bends_towards_a_lumen_left_and_above():
    depth = view((0, 0))
    assert constrain(INSERTION_AXES, depth, [-1.0, 0.3, -0.4, 0.6]) == pytest.approx([0.8, 0.0, -0.4, 0.6])
    assert constrain(INSERTION_AXES, depth, [-1.0, 0.3, 0.4, -0.6]) == pytest.approx([0.8, 0.0, 0.0, 0.0])


def test_middle_is_free_within_the_dead_zone():
    depth = view((2, 3))
    assert constrain(("pitch", "yaw"), depth, [0.4, 0.4], dead_zone=0.6) == pytest.approx([0.4, 0.4])
    assert constrain(("pitch", "yaw"), depth, [0.4, 0.4]) == pytest.approx([0.4, 0.0])


def test_tip_backs_off_from_the_wall_for_some_steps():
    wall, lumen = view(near=0.002, deep=0.002), view((2, 4))
    views = iter([wall, lumen, lumen, lumen])
    constraint = ActionConstraint(INSERTION_AXES, lambda: next(views), ConstraintRules(back_off_steps=2))
    forward = [float(constraint(torch.zeros(1, 4))[0, 0]) for _ in range(3)]
    assert forward == pytest.approx([-0.8, -0.8, 0.8])


def test_episode_end_ends_the_backing_off():
    views = iter([view(near=0.002, deep=0.002), view((2, 4))])
    constraint = ActionConstraint(INSERTION_AXES, lambda: next(views))
    constraint(torch.zeros(1, 4))
    constraint.reset(torch.tensor([1]))
    assert float(constraint(torch.zeros(1, 4))[0, 0]) == pytest.approx(0.8)


def test_unknown_axis_lists_the_known():
    with pytest.raises(ValueError, match="'twist', expected some of: x, y, forward"):
        ActionConstraint(("twist",), lambda: view())


def test_image_directions_are_the_cameras():
    """The camera's default pose turns its +X onto the link's -X and keeps +Y: what SIDES rests on."""
    from arcgym.assets.endoscope_spec import CameraSpec
    from arcgym.utils.math import quat_apply

    pose = torch.tensor([CameraSpec(position=(0.0, 0.0, 0.0)).quaternion])
    for camera_axis, link_axis in (
        ([1.0, 0, 0], [-1.0, 0, 0]),
        ([0, 1.0, 0], [0, 1.0, 0]),
        ([0, 0, -1.0], [0, 0, 1.0]),
    ):
        torch.testing.assert_close(quat_apply(pose, torch.tensor([camera_axis])), torch.tensor([link_axis]))


def test_turns_follow_the_expert():
    """The scripted experts turn by the cross product of forward and the lumen's direction: a lumen towards -X, -Y."""
    turn = torch.linalg.cross(torch.tensor([0.0, 0.0, 1.0]), torch.tensor([-0.6, -0.6, 0.5]))
    right_and_below = {"pitch": 1.0, "yaw": -1.0}
    assert {"pitch": float(turn[0].sign()), "yaw": float(turn[1].sign())} == right_and_below
    assert {axis: ActionConstraint.SIDES[axis][1] for axis in right_and_below} == right_and_below


def test_fixed_forward_axis_is_left_out(monkeypatch):
    from arcgym.envs import mdp
    from arcgym.rl.action_constraints import action_axes

    term = object.__new__(mdp.TipVelocityAction)
    term.cfg = mdp.TipVelocityActionCfg(forward_velocity=0.03)
    manager = SimpleNamespace(active_terms=["tip"], get_term={"tip": term}.__getitem__)
    env = SimpleNamespace(unwrapped=SimpleNamespace(action_manager=manager))
    assert action_axes(env) == ("x", "y", "pitch", "yaw", "roll")
