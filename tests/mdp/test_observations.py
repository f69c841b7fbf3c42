# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Observations: shapes, frames and scales."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest
import torch
import warp as wp

from arcgym.envs import mdp
from arcgym.managers import ObservationTermCfg

SHAPES = {
    "tip_lumen_direction": 3,
    "tip_progress": 1,
    "tip_axis_distance": 1,
    "tip_velocity": 6,
    "tip_bending": 2,
    "inserted_length": 2,
    "wall_forces": 3,
    "drive_forces": 2,
    "lumen_state": 5,
    "last_action": 2,
}


@pytest.mark.parametrize(("name", "size"), SHAPES.items())
def test_vector_terms_have_the_documented_shape(env, name: str, size: int) -> None:
    value = getattr(mdp, name)(env)
    assert value.shape == (2, size) and value.dtype == torch.float32


def test_rgb_is_a_channel_first_view(env) -> None:
    source = env.scene["camera"].data.output["rgb"]
    image = mdp.rgb(env)
    assert image.shape == (2, 3, 4, 6) and image.dtype == torch.uint8
    assert image[1, 2, 3, 4] == source[1, 3, 4, 2]
    assert image.untyped_storage().data_ptr() == source.untyped_storage().data_ptr()


def test_depth_is_scaled_and_clipped(env) -> None:
    env.scene["camera"].data.output["depth"][1] = 0.3
    image = mdp.depth(env, far=0.1)
    assert image.shape == (2, 1, 4, 6)
    assert image[0].unique().tolist() == [0.5] and image[1].unique().tolist() == [1.0]


def test_lumen_direction_is_in_the_tip_frame(env) -> None:
    # The tip is turned by 90 degrees about X: its forward axis is -Y of the world, the lumen's +Z is its +Y.
    half = math.sqrt(0.5)
    env.scope.tip_quat_w[0] = torch.tensor([half, 0.0, 0.0, half])
    torch.testing.assert_close(mdp.tip_lumen_direction(env)[0], torch.tensor([0.0, 1.0, 0.0]))


def test_centerline_ahead_of_a_tip_beside_the_axis(env) -> None:
    term = mdp.centerline_ahead(ObservationTermCfg(func=mdp.centerline_ahead, params={"distances": (0.02, 0.05)}), env)
    env.scope.tip_arc_length[:] = 0.15
    env.scope.tip_pos_w[:] = torch.tensor([0.01, 0.0, 0.15])
    value = term(env, distances=(0.02, 0.05))
    torch.testing.assert_close(value[0], torch.tensor([-0.5, 0.0, 1.0, -0.2, 0.0, 1.0]))


def test_centerline_ends_at_its_last_point(env) -> None:
    term = mdp.centerline_ahead(ObservationTermCfg(func=mdp.centerline_ahead, params={"distances": (0.1,)}), env)
    env.scope.tip_arc_length[:] = 0.5
    env.scope.tip_pos_w[:] = torch.tensor([0.0, 0.0, 0.45])
    torch.testing.assert_close(term(env, distances=(0.1,))[0], torch.tensor([0.0, 0.0, 0.5]))


def test_forces_are_logarithmic(env) -> None:
    env.scope.window_force_w[0, :, 0] = torch.tensor([1.0, 2.0, 1.0]) * (math.e - 1.0)
    # Windows 0 and 2 abut, window 1 overlaps both: together they bear 2 (e - 1) N.
    expected = torch.tensor([0.0, math.log(2.0 * math.e - 1.0), math.log(2.0 * math.e - 1.0)])
    torch.testing.assert_close(mdp.wall_forces(env)[0], expected)


def test_lumen_state_sees_the_image_after_a_reset(env) -> None:
    mdp.lumen_reward(env)
    images = env.scene["camera"].data
    images.output["depth"][0] = 0.003
    images.frame += 1
    assert mdp.lumen_state(env)[0, 4] == -1.0


def test_shape_is_the_shaft_seen_from_the_tip(env) -> None:
    """Links of 4, 4 and 2 cm along +Z, their centers 8, 4 and 1 cm behind the tip, which looks to the side."""
    env.scene["endoscope"].stage = SimpleNamespace(link_length=[0.04, 0.04, 0.02])
    env.scope.tip_pos_w = torch.tensor([[0.0, 0.0, 0.1]] * 2)
    env.scope.body_pos_w = torch.tensor([[[0.0, 0.0, z] for z in (0.02, 0.06, 0.09)]] * 2)
    env.scope.tip_quat_w[1] = torch.tensor([0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5)])
    params = {"points": 3, "spacing": 0.04}
    term = mdp.shaft_shape(ObservationTermCfg(func=mdp.shaft_shape, params=params), env)
    shape = term(env, **params, scale=0.1)
    # 4 cm is nearest to the middle link, 8 and 12 cm to the first one.
    expected = torch.tensor([[0, 0, -0.4, 0, 0, -0.8, 0, 0, -0.8], [0.4, 0, 0, 0.8, 0, 0, 0.8, 0, 0]])
    torch.testing.assert_close(shape, expected, atol=1e-5, rtol=0.0)


def test_insertion_depth(env) -> None:
    env.scope.inserted_length[:] = torch.tensor([0.3, 0.5])
    torch.testing.assert_close(mdp.insertion_depth(env), torch.tensor([[0.3], [0.5]]))


def test_recent_advance_by_hand(env) -> None:
    """Two windows, of one and of three steps; the second world is reset before the third step."""
    params = {"windows_s": (env.step_dt, 3 * env.step_dt)}
    term = mdp.recent_advance(ObservationTermCfg(func=mdp.recent_advance, params=params), env)
    values = []
    for env.common_step_counter, arc in enumerate([0.1, 0.2, 0.4, 0.7, 1.1]):
        if env.common_step_counter == 3:
            term.reset(torch.tensor([1]))
        env.scope.tip_arc_length[:] = arc
        term(env, **params)
        values.append(term(env, **params, scale=0.1))  # a second look in the same step changes nothing
    first, second = torch.stack(values, dim=1)
    torch.testing.assert_close(first[:, 0], torch.tensor([0.0, 1.0, 2.0, 3.0, 4.0]))
    torch.testing.assert_close(first[:, 1], torch.tensor([0.0, 1.0, 3.0, 6.0, 9.0]))
    torch.testing.assert_close(second[:, 0], torch.tensor([0.0, 1.0, 2.0, 0.0, 4.0]))
    torch.testing.assert_close(second[:, 1], torch.tensor([0.0, 1.0, 3.0, 0.0, 4.0]))


def test_target_lead_is_seen_from_the_tip(env) -> None:
    """A target 1 cm ahead along the world's X and half a turn on about its Z; the second tip is turned by 90°."""
    vectors = {"lead": [0.01, 0.0, 0.0], "turn": [0.0, 0.0, math.pi]}
    pull = SimpleNamespace(**{name: wp.array([value] * 2, dtype=wp.vec3) for name, value in vectors.items()})
    env.scene["endoscope"].actuator = {"tip": pull}.__getitem__
    env.scope.tip_quat_w[1] = torch.tensor([0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5)])
    expected = torch.tensor([[0.5, 0.0, 0.0, 0.0, 0.0, 2.0], [0.0, -0.5, 0.0, 0.0, 0.0, 2.0]])
    lead = mdp.target_lead(env, linear_scale=0.02, angular_scale=0.5 * math.pi)
    torch.testing.assert_close(lead, expected, atol=1e-5, rtol=0.0)
