# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Latency, shutter, measured light, stool and fluid, where a reader can work out the answer."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import torch
import warp as wp
from tube_scene import FORWARD, RADIUS, TubeScene

from arcgym.anatomy.segments import SEGMENTS
from arcgym.sensors import EndoscopeCamera, EndoscopeCameraCfg, ExposureCfg, LightingCfg, PreparationCfg
from arcgym.sensors.camera_rays import fisheye_rays
from arcgym.sensors.camera_view import CameraView
from arcgym.sensors.motion_kernels import smear
from arcgym.sensors.preparation import PARTS
from arcgym.sim.weight_cfg import WeightCfg

SIZE = 64
DT, STEPS = 1.0 / 480.0, 48


class MovingScene(dict):
    """Two worlds whose scope and wall have gone as many millimeters as physics steps have passed."""

    def __init__(self) -> None:
        super().__init__()
        self.num_envs, self.device, self.passed = 2, "cpu", 0
        camera = SimpleNamespace(position=(0.0, 0.0, 0.0), quaternion=(0.0, 0.0, 0.0, 1.0))
        self["endoscope"] = SimpleNamespace(stage=SimpleNamespace(camera=camera), num_bodies=1)
        state = SimpleNamespace(
            body_q=wp.array([(0, 0, 0, 0, 0, 0, 1)] * 2, dtype=wp.transform, device="cpu"),
            body_qd=wp.array([(0, 0, 0.48, 0, 0, 0)] * 2, dtype=wp.spatial_vector, device="cpu"),
        )
        wall = wp.zeros((1, 2), dtype=wp.vec3, device="cpu")
        self.sim = SimpleNamespace(physics_dt=DT, watchers=[], state=state, nodal_pos=wall)

    def step(self) -> None:
        """Make a control step as the simulation does."""
        for left in range(STEPS, 0, -1):
            for watch in self.sim.watchers:
                watch(left, STEPS)
            self.move_to(self.passed + 1)

    def move_to(self, passed: int) -> None:
        self.passed = passed
        wp.to_torch(self.sim.state.body_q)[:, 2] = passed
        wp.to_torch(self.sim.nodal_pos)[..., 2] = passed


def seen(view: CameraView) -> list[float]:
    """How far camera and wall of the first world had gone in what is shown."""
    return [float(view.shot.pose.numpy()[0, 2]), float(view.shot.wall.numpy()[0, 0, 2])]


@pytest.mark.parametrize(("latency", "late"), [(0.08, 38), (0.1, 48), (0.15, 72), (0.25, 120)])
def test_a_picture_shows_camera_and_wall_of_the_nearest_physics_step(latency: float, late: int) -> None:
    scene = MovingScene()
    view = CameraView(scene, latency)
    assert view.lag == late
    for _ in range(4):
        scene.step()
    view.refresh(wp.ones(2, dtype=wp.bool, device="cpu"), stepped=True)
    assert seen(view) == [4 * STEPS - late] * 2


def test_a_world_that_is_written_to_is_shown_as_it_is_and_the_others_late() -> None:
    scene = MovingScene()
    view = CameraView(scene, 0.15)
    for _ in range(3):
        scene.step()
    view.refresh(wp.array([False, True], dtype=wp.bool, device="cpu"), stepped=False)
    assert view.shot.pose.numpy()[:, 2].tolist() == [3 * STEPS - 72, 3 * STEPS]
    scene.step()
    assert view.shot.pose.numpy()[:, 2].tolist() == [4 * STEPS - 72, 4 * STEPS - 72 + 24]


def test_without_latency_the_present_is_shown_with_its_motion() -> None:
    scene = MovingScene()
    view = CameraView(scene, 0.0)
    scene.step()
    view.refresh(wp.ones(2, dtype=wp.bool, device="cpu"), stepped=True)
    assert view.shot.wall is None and view.memory == {} and not scene.sim.watchers
    assert view.shot.pose.numpy()[0, 2] == STEPS and view.shot.motion.numpy()[0, 2] == np.float32(0.48)


def streak(spin: float, gain: float) -> tuple[float, float]:
    """Middle and length [px] of what a bright point at the middle becomes in a picture of 100 px a radian."""
    size, focal, shutter = 41, 100.0, wp.vec3(1 / 200, 1 / 60, 1.0e-3)
    rays = wp.array(fisheye_rays(size, size, np.hypot(size, size) / focal), dtype=wp.vec3, device="cpu")
    sharp = np.zeros((1, size, size, 3), np.float32)
    sharp[0, 20, 20] = 1.0
    out = wp.zeros((1, size, size), dtype=wp.vec3, device="cpu")
    inputs = [
        wp.array(sharp, dtype=wp.vec3, device="cpu"),
        wp.full((1, size, size), 0.05, dtype=float, device="cpu"),
        rays,
        wp.zeros(1, dtype=wp.bool, device="cpu"),
        wp.array([(0, 0, 0, 0, spin, 0)], dtype=wp.spatial_vector, device="cpu"),
        wp.array([gain], dtype=float, device="cpu"),
        shutter,
        focal,
        wp.ones(1, dtype=wp.bool, device="cpu"),
    ]
    wp.launch(smear, (1, size, size), inputs=inputs, outputs=[out], device="cpu")
    light = out.numpy()[0, 20, :, 0]
    assert out.numpy().sum() == pytest.approx(light.sum() * 3.0, rel=5e-3)  # along its row alone
    column = np.arange(size)
    middle = (light * column).sum() / light.sum()
    spread = (light * (column - middle) ** 2).sum() / light.sum()
    return float(middle), float(np.sqrt(12.0 * spread))


@pytest.mark.parametrize(("gain", "time"), [(2.0e-3, 1 / 60), (0.6e-3, 0.01), (1.0e-5, 1 / 200)])
def test_a_streak_is_as_long_as_spin_times_exposure_times_focal_length(gain: float, time: float) -> None:
    spin = 0.1 / time  # 10 px
    middle, length = streak(spin, gain)
    assert middle == pytest.approx(20.0, abs=0.1)
    assert length == pytest.approx(10.0, rel=0.1)


def test_a_camera_that_stands_still_has_sharp_pictures() -> None:
    assert streak(0.0, 1.0) == (20.0, 0.0)


def picture(scene: TubeScene, **settings: object) -> np.ndarray:
    """What a camera sees, in linear light, shape (H, W, 3)."""
    camera = EndoscopeCamera(EndoscopeCameraCfg(width=SIZE, height=SIZE, **settings))
    camera.initialize(scene)
    camera.update()
    return camera.radiance[0].numpy()


ONE_LIGHT = (0.0, 0.0, 0.0)


def test_light_falls_with_the_angle_as_measured(tmp_path) -> None:
    """exp(-2.77 (1 - cos)) over the cosine of a plain lamp: the same wall seen in both lights."""
    scene = TubeScene(tmp_path, plain=True)
    plain = {"scatter": 0.0, "gloss": 0.0, "lamp": ONE_LIGHT}
    bare = picture(scene, lighting=LightingCfg(beam=0.0, **plain))
    measured = picture(scene, lighting=LightingCfg(concentration=2.77, **plain))
    cosine = -fisheye_rays(SIZE, SIZE, np.radians(150.0))[:, :, 0, 2]
    sure = (cosine > 0.3) & (cosine < 0.9)
    expected = np.exp(-2.77 * (1.0 - cosine)) / cosine
    np.testing.assert_allclose(measured[sure][:, 0] / bare[sure][:, 0], expected[sure], rtol=0.03)


def test_brightness_falls_with_distance_to_the_power_of_two_over_gamma(tmp_path) -> None:
    """Twice the tube, half the gamma-2.2 brightness but for 2 ** -0.09; a dim picture does not saturate."""
    lighting = LightingCfg(concentration=2.77, lamp=ONE_LIGHT, min_distance=1.0e-4)
    exposure = ExposureCfg(automatic=False, gain=4.0e-5, gamma=2.2, vignette=0.0, contrast=0.0)
    levels = []
    for radius in (RADIUS, 2.0 * RADIUS):
        camera = EndoscopeCamera(EndoscopeCameraCfg(width=SIZE, height=SIZE, lighting=lighting, exposure=exposure))
        camera.initialize(TubeScene(tmp_path, radius=radius, plain=True))
        camera.update()
        cosine = -fisheye_rays(SIZE, SIZE, np.radians(150.0))[:, :, 0, 2]
        levels.append(camera.data.output["rgb"][0].numpy()[(cosine > 0.4) & (cosine < 0.7)][:, 0].mean())
    assert levels[0] < 160.0
    assert levels[1] / levels[0] == pytest.approx(2.0**-0.91, rel=0.04)


def with_sim(scene: TubeScene) -> TubeScene:
    """Give a tube what preparation asks of a simulation; gravity points along -X of the tube, across it."""
    gravity = wp.full(scene.num_envs, wp.vec3(-9.81, 0.0, 0.0), dtype=wp.vec3, device="cpu")
    cfg = SimpleNamespace(weight=WeightCfg(enabled=True))
    scene.sim = SimpleNamespace(cfg=cfg, actuation=SimpleNamespace(gravity=gravity))
    return scene


def changed(tmp_path, **settings: object) -> np.ndarray:
    """Share of the wall that looks otherwise than clean, beside the camera, where it is seen at a right angle."""
    scene = with_sim(TubeScene(tmp_path, plain=True))
    scene.move_camera(0, [0.0, 0.0, 0.15, *FORWARD])
    clean = picture(scene)
    left = picture(scene, preparation=PreparationCfg(scores=(3, 3, 1), **settings))
    return np.abs(left - clean).max(axis=-1) > 1e-3 * clean.max(axis=-1)


def test_fluid_covers_its_share_of_the_way_around_at_the_bottom(tmp_path) -> None:
    wet = changed(tmp_path, stool=(0.0,) * 4, liquid=(0.0, 0.25, 0.0, 0.0), turbidity=(1.0,) * 4)
    rays = fisheye_rays(SIZE, SIZE, np.radians(150.0))[:, :, 0]
    around = np.hypot(rays[..., 0], rays[..., 1])
    aside = (around > 0.5) & (rays[..., 2] < 0.0)
    assert wet[aside].mean() == pytest.approx(0.25, abs=0.03)
    assert not wet[aside & (rays[..., 0] > 0.0)].any()  # the camera's X is the tube's


def test_lumps_cover_the_wall_by_the_poisson_law(tmp_path) -> None:
    covered = np.mean(
        [changed(tmp_path, stool=(0.0, share, 0.0, 0.0), liquid=(0.0,) * 4).mean() for share in (0.3, 1.0)]
    )
    assert covered == pytest.approx(np.mean([1.0 - np.exp(-1.32 * share) for share in (0.3, 1.0)]), abs=0.15)


def test_a_score_of_three_of_another_part_leaves_this_one_as_it_is(tmp_path) -> None:
    scene = with_sim(TubeScene(tmp_path, plain=True))  # of the rectum
    dirty = PreparationCfg(scores=(0, 0, 3), liquid=(1.0, 1.0, 1.0, 0.0))
    assert (picture(scene, preparation=dirty) == picture(scene)).all()


def test_every_segment_is_of_one_part() -> None:
    assert sorted(sum(PARTS.values(), ())) == sorted(SEGMENTS)


def test_scores_can_be_written(tmp_path) -> None:
    camera = EndoscopeCamera(EndoscopeCameraCfg(width=4, height=4, preparation=PreparationCfg(scores=(2, 3, 3))))
    camera.initialize(with_sim(TubeScene(tmp_path, num_envs=2)))
    camera.write_preparation(torch.tensor([[0, 1, 2]]), torch.tensor([9]), torch.tensor([1]))
    assert camera.world_settings()["scores"].tolist() == [[2, 3, 3], [0, 1, 2]]
    assert camera.world_settings()["seed"].tolist() == [0, 9]
    clean = EndoscopeCamera(EndoscopeCameraCfg(width=4, height=4))
    clean.initialize(TubeScene(tmp_path))
    with pytest.raises(ValueError, match=r"set env\.scene\.camera\.preparation\.scores"):
        clean.write_preparation(torch.zeros(1, 3), torch.zeros(1))


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"scores": (2, 3, 4)}, "at most 3"),
        ({"stool": (0.5, 1.5, 0.0, 0.0)}, "at most 1"),
    ],
)
def test_a_wrong_preparation_is_told(wrong: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        EndoscopeCamera(EndoscopeCameraCfg(preparation=PreparationCfg(**wrong)))
