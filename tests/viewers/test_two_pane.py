# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The picture of env.render(), on a tiny colon and an environment of plain objects."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import torch
import warp as wp
from tiny import tiny_colon_stage

from arcgym.assets.patient import patient_of_stage
from arcgym.viewers import OutsideViewCfg, TwoPaneView, ViewerCfg
from arcgym.viewers.frame_info import read_info

LINKS = 6
SMALL = ViewerCfg(outside=OutsideViewCfg(width=141, height=128))


class FakeCamera:
    """Gives a picture of one color per world."""

    def snapshot_view(self, env_id: int, size: int, samples: int):
        return np.full((size, size, 3), 50 + 100 * env_id, np.uint8), np.ones((size, size))


def make_env(with_camera: bool = True) -> SimpleNamespace:
    stage = tiny_colon_stage()
    points = wp.array(np.repeat(stage.wall.points[:, None], 2, axis=1), dtype=wp.vec3)
    patient = patient_of_stage(stage, shell=False)
    colon = SimpleNamespace(patient_of=lambda env_id: patient, nodal_pos_wp=points, points=wp.to_torch(points))
    position = torch.zeros(2, LINKS, 3)
    position[:, :, 2] = torch.arange(LINKS) * 0.02 - 0.05
    data = SimpleNamespace(
        body_pos_w=position,
        body_quat_w=torch.tensor([0.0, 0.0, 0.0, 1.0]).expand(2, LINKS, 4).clone(),
        tip_force=torch.zeros(2),
        window_arc=torch.tensor([0.025, 0.050, 0.075]),
        window_force_norm=torch.zeros(2, 3),
        link_force_norm=torch.zeros(2, LINKS),
        tip_arc_length=torch.tensor([0.06, 0.14]),
        tip_segment=torch.tensor([1, 3]),
        inserted_length=torch.tensor([0.07, 0.15]),
    )
    scope = SimpleNamespace(link_length=np.full(LINKS, 0.02), link_radius=np.full(LINKS, 0.006), bending_links=2)
    scene = {"colon": colon, "endoscope": SimpleNamespace(stage=scope, data=data)}
    if with_camera:
        scene["camera"] = FakeCamera()
    return SimpleNamespace(
        scene=scene,
        cfg=SimpleNamespace(segment="sigmoid"),
        step_dt=0.1,
        reward_buf=torch.tensor([0.5, -0.5]),
        episode_length_buf=torch.tensor([12, 3]),
    )


def test_frame_is_an_even_sized_picture_with_content():
    frame = TwoPaneView(make_env(), SMALL).frame()
    assert frame.dtype == np.uint8 and frame.ndim == 3
    assert frame.shape[0] % 2 == frame.shape[1] % 2 == 0
    assert frame.std() > 10.0


def test_endoscope_is_left_and_outside_view_is_right():
    frame = TwoPaneView(make_env(), SMALL).frame(env_id=1)
    assert tuple(frame[70, 60]) == (150, 150, 150)
    assert frame[20, -30].min() > 180


def test_frame_changes_with_scope_wall_and_world():
    env = make_env()
    view = TwoPaneView(env, SMALL)
    first = view.frame().astype(int)
    env.scene["endoscope"].data.body_pos_w[0, :, 2] += 0.05
    moved = view.frame().astype(int)
    env.scene["colon"].points[: len(env.scene["colon"].points) // 2] += 0.02
    deformed = view.frame().astype(int)
    other = view.frame(env_id=1).astype(int)
    for before, after in ((first, moved), (moved, deformed), (deformed, other)):
        assert (np.abs(after - before).max(axis=2) > 15).sum() > 20


def test_scene_without_camera_is_drawn_too():
    assert TwoPaneView(make_env(with_camera=False), SMALL).frame().std() > 10.0


def test_info_reads_the_chosen_world():
    env = make_env()
    env.scene["endoscope"].data.window_force_norm[1, 2] = 5.0
    info = read_info(env, 1)
    assert (info.segment, info.max_force, info.tip_force) == ("splenic", 5.0, 0.0)
    assert info.time == pytest.approx(0.3)
    assert info.reward == pytest.approx(-0.5)
    assert info.task_range == pytest.approx((0.04, 0.08), abs=0.006)


def test_extra_numbers_are_shown_and_reward_is_replaced():
    info = read_info(make_env(), 0, {"s_c": 0.75, "reward": 2.0})
    assert info.reward == 2.0
    assert info.terms == {"s_c": 0.75}


def test_metrics_that_the_task_has_are_shown():
    env = make_env()
    env.metrics_manager = SimpleNamespace(step_values={"s_c": torch.tensor([0.25, 0.5])})
    assert read_info(env, 1, metrics=("s_c", "s_o")).terms == {"s_c": 0.5}


def test_charts_start_again_with_every_episode():
    env = make_env()
    view = TwoPaneView(env, SMALL)
    for step in (1, 2, 3):
        env.episode_length_buf[0] = step
        view.frame()
    assert len(view.rewards) == 3
    env.episode_length_buf[0] = 0
    view.frame()
    assert len(view.rewards) == 1


def test_viewer_configuration_chooses_the_colors():
    env = make_env()
    env.scene["colon"].points[:, 0, 2] *= 1.2
    frames = {}
    for color in ("displacement", "strain", "force"):
        outside = OutsideViewCfg(width=141, height=128, wall_color=color, scope_color="plain")
        frames[color] = TwoPaneView(env, ViewerCfg(outside=outside)).frame()
    assert (frames["strain"] != frames["displacement"]).mean() > 0.01
    assert (frames["strain"] != frames["force"]).mean() > 0.01
