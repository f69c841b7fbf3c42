# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Coverage and polyps in a straight tube: 30 cm long, 4 cm wide, 31 rings of 48 vertices 1 cm apart."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
import torch
import warp as wp
from tiny import tiny_colon_stage
from tube_scene import FORWARD, TubeScene

from arcgym.envs import mdp
from arcgym.managers import MetricsTermCfg
from arcgym.sensors import EndoscopeCamera, EndoscopeCameraCfg
from arcgym.sensors.seen_surface import PARTS, SeenSurface, vertex_polyps, vertex_shares


@pytest.fixture
def scene(tmp_path):
    """Camera 5 cm deep on the axis, looking along it, with a polyp 7 cm deep and another 27 cm deep."""
    scene = TubeScene(tmp_path)
    visual = scene["colon"].patients[0].visual
    angle = np.arctan2(visual.points[:, 1], visual.points[:, 0])
    for depth in (0.07, 0.27):
        visual.tint[(np.abs(visual.points[:, 2] - depth) < 0.011) & (np.abs(angle) < 0.4)] = 1.0
    camera = EndoscopeCamera(EndoscopeCameraCfg(width=64, height=64))
    camera.initialize(scene)
    scene["camera"] = camera
    move(scene, 0.05)
    return scene


def move(scene: TubeScene, depth: float) -> None:
    scene.move_camera(0, (0.0, 0.0, depth, *FORWARD))
    scene["camera"].update()


def test_shares_of_vertices_add_up_to_the_whole(scene) -> None:
    shares = vertex_shares(scene["colon"].patients[0].visual)
    assert abs(int(shares.sum()) - PARTS) < 2000
    # The tube's ends stand for half of what a ring between them does.
    rings = shares.reshape(31, 48).sum(axis=1) / PARTS
    np.testing.assert_allclose(rings[[0, 1, 15, 30]], np.array([0.5, 1.0, 1.0, 0.5]) / 30, rtol=1e-4)


def test_patches_of_tint_are_polyps(scene) -> None:
    visual = scene["colon"].patients[0].visual
    polyps = vertex_polyps(visual)
    assert set(polyps[visual.points[:, 2] < 0.1]) == {-1, 0} and set(polyps[visual.points[:, 2] > 0.25]) == {-1, 1}


def test_a_polyp_on_the_seam_is_one(tmp_path) -> None:
    """In the tiny colon the first and the last column of vertices lie in the same places."""
    visual = tiny_colon_stage(texture_folder=tmp_path).visual_proxy
    around = np.arctan2(visual.points[:, 1], visual.points[:, 0])
    on_seam = (np.abs(visual.points[:, 2] - 0.1) < 0.013) & (np.abs(around) < 0.5)
    polyps = vertex_polyps(dataclasses.replace(visual, tint=on_seam.astype(np.float32)))
    assert set(polyps[on_seam]) == {0} and set(polyps[~on_seam]) == {-1}
    assert len(np.unique(np.round(visual.points[on_seam], 6), axis=0)) < on_seam.sum()


def test_coverage_is_the_area_between_the_edge_of_the_picture_and_the_reach(scene) -> None:
    """A corner ray of 75 degrees meets the wall 5 mm ahead, a ray of 5 cm ends 46 mm ahead: 1 to 5 rings of 30."""
    seen = SeenSurface(scene["camera"], [scene["colon"].patients[0].visual], reach=0.05)
    seen.look()
    first = float(seen.coverage[0])
    assert 3.0 / 30 < first < 5.0 / 30
    seen.look()
    assert float(seen.coverage[0]) == first
    move(scene, 0.15)
    seen.look()
    assert float(seen.coverage[0]) == pytest.approx(2.0 * first, rel=1e-3)
    seen.reset(torch.tensor([0]))
    assert float(seen.coverage[0]) == 0.0


def test_a_shorter_reach_sees_less_and_a_covered_lens_nothing(scene) -> None:
    visuals = [scene["colon"].patients[0].visual]
    far, near, blind = (SeenSurface(scene["camera"], visuals, reach) for reach in (0.05, 0.03, 0.05))
    for seen in (far, near):
        seen.look()
    assert float(near.coverage[0]) < 0.7 * float(far.coverage[0])
    wp.to_torch(scene["camera"].renderer.covered)[:] = True
    blind.look()
    assert float(blind.coverage[0]) == 0.0


def test_terms_count_polyps_in_view_and_their_time(scene) -> None:
    patient = torch.zeros(1, dtype=torch.int32)
    scene["colon"].data = SimpleNamespace(patient=patient)

    class Env:
        num_envs, device, step_dt = 1, "cpu", 0.1

    env = Env()
    env.scene = scene
    terms = {name: getattr(mdp, name)(MetricsTermCfg(func=None), env) for name in ("polyps_seen", "polyp_time")}
    gain = mdp.coverage_gain(MetricsTermCfg(func=None), env)
    assert mdp.num_polyps(env).tolist() == [2]
    assert terms["polyps_seen"](env).tolist() == [1]
    # One of two polyps is in view for a step of 0.1 s: 0.05 s for each.
    torch.testing.assert_close(terms["polyp_time"](env), torch.tensor([0.05]))
    first = float(gain(env)[0])
    assert first > 0.1 and float(gain(env)[0]) == 0.0
    move(scene, 0.15)
    assert terms["polyps_seen"](env).tolist() == [1] and terms["polyp_time"](env).tolist() == [0.0]
    move(scene, 0.25)
    assert terms["polyps_seen"](env).tolist() == [2]
    for term in terms.values():
        term.reset(None)
    assert terms["polyps_seen"](env).tolist() == [0]


def test_terms_of_one_task_have_one_reach(scene) -> None:
    scene["colon"].data = SimpleNamespace(patient=torch.zeros(1, dtype=torch.int32))
    env = type("Env", (), {"num_envs": 1, "device": "cpu", "step_dt": 0.1})()
    env.scene = scene
    term = mdp.coverage(MetricsTermCfg(func=None), env)
    term(env)
    with pytest.raises(ValueError, match=r"0.05 and 0.03 m"):
        term(env, reach=0.03)
