# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What the camera sees in a straight tube, where a reader can work out the answer."""

from __future__ import annotations

import numpy as np
import pytest
import torch
import warp as wp
from tube_scene import FORWARD, MIDDLE, RADIUS, TubeScene

from arcgym.sensors import EndoscopeCamera, EndoscopeCameraCfg, ExposureCfg
from arcgym.sensors.camera_rays import fisheye_rays
from arcgym.utils.cpu_threads import VARIABLE

SIZE = 32


def make_camera(scene: TubeScene, **overrides) -> EndoscopeCamera:
    camera = EndoscopeCamera(EndoscopeCameraCfg(width=SIZE, height=SIZE, **overrides))
    camera.initialize(scene)
    return camera


def picture(camera: EndoscopeCamera) -> tuple[np.ndarray, np.ndarray]:
    output = camera.data.output
    return output["rgb"].cpu().numpy().copy(), output["depth"].cpu().numpy().copy()


def test_depth_is_the_distance_along_the_ray(tmp_path):
    """From the axis, a ray at angle theta meets the wall after R / sin(theta)."""
    camera = make_camera(TubeScene(tmp_path))
    camera.update()
    theta = np.arccos(-fisheye_rays(SIZE, SIZE, np.radians(150.0))[:, :, 0, 2])
    expected = RADIUS / np.sin(theta)
    inside = expected < 0.1
    depth = picture(camera)[1][0]
    assert inside.sum() > 900
    assert np.abs(depth[inside] / expected[inside] - 1.0).max() < 0.02


def test_depth_is_far_where_nothing_is_hit(tmp_path):
    scene = TubeScene(tmp_path)
    scene.move_camera(0, [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0])
    camera = make_camera(scene, far=0.5)
    camera.update()
    rgb, depth = picture(camera)
    assert (depth == 0.5).all() and (rgb == 0).all()


@pytest.mark.parametrize(("x", "covered"), [(RADIUS - 0.002, False), (RADIUS + 0.002, True)])
def test_lens_in_the_wall_sees_red(tmp_path, x, covered):
    """2 mm inside the wall's inner surface the lens is free, 2 mm beyond it is covered, and sees no void."""
    scene = TubeScene(tmp_path, plain=True)
    scene.move_camera(0, [x, 0.0, 0.15, *FORWARD])
    camera = make_camera(scene)
    camera.update()
    rgb, depth = picture(camera)
    assert camera.data.covered.item() is covered
    assert (depth == np.float32(0.001)).all() == covered
    if covered:
        assert rgb[0, ..., 0].mean() > 1.3 * rgb[0, ..., 1].mean()


def test_brightness_falls_with_the_square_of_distance(tmp_path):
    """A tube twice as wide is seen under the same angles, so every pixel gets a quarter of the light."""
    radiance = []
    for radius in (RADIUS, 2 * RADIUS):
        scene = TubeScene(tmp_path, radius=radius, plain=True)
        camera = make_camera(scene)
        camera.update()
        radiance.append(camera.radiance[0].clone())
    rim = slice(0, 8)
    assert torch.allclose(radiance[0][rim], 4.0 * radiance[1][rim], rtol=0.02)


def test_automatic_exposure_evens_out_distance(tmp_path):
    means = []
    for radius in (RADIUS, 2 * RADIUS):
        camera = make_camera(TubeScene(tmp_path, radius=radius, plain=True))
        camera.update()
        means.append(picture(camera)[0][0, :8].mean())
    assert means[1] == pytest.approx(means[0], rel=0.1)


def test_exposure_lag_keeps_part_of_the_last_gain(tmp_path):
    """With lag 0.5 the new gain is the geometric mean of the last and the wanted one; a reset forgets the last."""
    scene = TubeScene(tmp_path, plain=True)
    camera = make_camera(scene, exposure=ExposureCfg(lag=0.5))
    camera.update()
    first = camera.exposure_gain.item()
    scene.move_wall(0, scene.rest * (2.0, 2.0, 1.0))
    camera.update()
    lagged = camera.exposure_gain.item()
    camera.reset()
    camera.update()
    wanted = camera.exposure_gain.item()
    assert wanted > 2.0 * first
    assert lagged == pytest.approx((first * wanted) ** 0.5, rel=1.0e-4)


def test_rigid_motion_leaves_the_picture(tmp_path):
    scene = TubeScene(tmp_path)
    camera = make_camera(scene)
    camera.update()
    rgb, depth = picture(camera)
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    shift = np.array([0.2, -0.1, 0.05])
    quarter = np.sqrt(0.5)
    scene.move_wall(0, scene.rest @ turn.T + shift)
    scene.move_camera(0, [*(turn @ MIDDLE + shift), quarter, quarter, 0.0, 0.0])
    camera.update()
    moved_rgb, moved_depth = picture(camera)
    inside = depth < 0.1
    assert np.allclose(moved_depth[inside], depth[inside], atol=1.0e-4)
    assert np.abs(moved_rgb.astype(int) - rgb).mean() < 1.0


def test_worlds_do_not_see_each_other(tmp_path):
    """A second, narrower tube in the same place changes nothing in the first world."""
    alone = TubeScene(tmp_path)
    camera = make_camera(alone)
    camera.update()
    pair = TubeScene(tmp_path, num_envs=2)
    pair.move_wall(1, pair.rest * (0.5, 0.5, 1.0))
    both = make_camera(pair)
    both.update()
    assert torch.equal(both.data.output["rgb"][0], camera.data.output["rgb"][0])
    assert torch.equal(both.data.output["depth"][0], camera.data.output["depth"][0])
    assert both.data.output["depth"][1, 0, 0] == pytest.approx(
        0.5 * both.data.output["depth"][0, 0, 0].item(), rel=0.01
    )


def test_masked_update_leaves_the_other_worlds(tmp_path):
    scene = TubeScene(tmp_path, num_envs=3)
    camera = make_camera(scene)
    camera.update()
    rgb, depth = picture(camera)
    for world in range(3):
        scene.move_wall(world, scene.rest * (0.7, 0.7, 1.0))
    camera.update(torch.tensor([False, True, False]))
    new_rgb, new_depth = picture(camera)
    for kept in (0, 2):
        assert np.array_equal(new_rgb[kept], rgb[kept]) and np.array_equal(new_depth[kept], depth[kept])
    assert not np.array_equal(new_depth[1], depth[1])
    assert not np.array_equal(new_rgb[1], rgb[1])


def test_picture_has_structure_and_is_repeatable(tmp_path):
    pictures = []
    for _ in range(2):
        camera = make_camera(TubeScene(tmp_path))
        camera.update()
        pictures.append(picture(camera)[0])
    assert pictures[0].std() > 10
    assert np.array_equal(*pictures)


def test_graph_draws_what_eager_launches_draw(tmp_path):
    scene = TubeScene(tmp_path)
    camera = make_camera(scene)
    camera.update()
    with wp.ScopedCapture(device="cpu") as capture:
        camera.draw()
    scene.move_camera(0, [0.005, 0.002, 0.1, *FORWARD])
    camera.update()
    rgb, depth = picture(camera)
    scene.move_camera(0, [*MIDDLE, *FORWARD])
    camera.update()
    assert not np.array_equal(picture(camera)[1], depth)
    scene.move_camera(0, [0.005, 0.002, 0.1, *FORWARD])
    wp.capture_launch(capture.graph)
    assert np.array_equal(picture(camera)[0], rgb) and np.array_equal(picture(camera)[1], depth)


@pytest.mark.parametrize(
    "device",
    ["cpu", pytest.param("cuda:0", marks=pytest.mark.skipif(not wp.is_cuda_available(), reason="needs CUDA"))],
)
def test_graph_of_a_whole_update_follows_the_moving_wall(tmp_path, device):
    scene = TubeScene(tmp_path, num_envs=2, device=device)
    camera = make_camera(scene)
    camera.update()
    with wp.ScopedCapture(device=device) as capture:
        camera.update()
    scene.move_wall(1, scene.rest * (0.8, 1.1, 1.0))
    camera.update()
    rgb, depth = picture(camera)
    scene.move_wall(1, scene.rest)
    camera.update()
    assert not np.array_equal(picture(camera)[1], depth)
    scene.move_wall(1, scene.rest * (0.8, 1.1, 1.0))
    wp.capture_launch(capture.graph)
    assert np.array_equal(picture(camera)[0], rgb) and np.array_equal(picture(camera)[1], depth)


def test_looks_of_one_world_change_only_that_world(tmp_path):
    scene = TubeScene(tmp_path, num_envs=2)
    camera = make_camera(scene)
    camera.update()
    rgb = picture(camera)[0]
    one = torch.tensor([1])
    camera.write_light_gain(torch.tensor([0.5]), one)
    camera.write_color_gain(torch.tensor([[1.0, 0.8, 0.8]]), one)
    camera.write_texture_offset(torch.tensor([[0.3, 0.6]]), one)
    camera.update()
    new = picture(camera)[0]
    assert np.array_equal(new[0], rgb[0])
    assert new[1].mean() < 0.9 * rgb[1].mean()


def test_data_tells_where_the_picture_was_taken(tmp_path):
    camera = make_camera(TubeScene(tmp_path))
    camera.update()
    assert camera.data.pos_w[0].tolist() == pytest.approx(MIDDLE)
    assert camera.data.quat_w_opengl[0].tolist() == pytest.approx(FORWARD)


def test_snapshot_shows_the_world_asked_for(tmp_path):
    scene = TubeScene(tmp_path, num_envs=2)
    scene.move_wall(1, scene.rest * (0.5, 0.5, 1.0))
    camera = make_camera(scene)
    wide, wide_depth = camera.snapshot_view(0, size=24, samples=2)
    narrow, narrow_depth = camera.snapshot_view(1, size=24, samples=2)
    assert wide.shape == (24, 24, 3) and wide.dtype == np.uint8
    assert narrow_depth[0, 0] == pytest.approx(0.5 * wide_depth[0, 0], rel=0.02)


def test_unknown_data_type_names_the_alternatives():
    with pytest.raises(ValueError, match="normals.*depth, rgb"):
        EndoscopeCamera(EndoscopeCameraCfg(data_types=("rgb", "normals")))


def test_two_halves_make_one_picture(tmp_path, monkeypatch):
    """The second one: the first is drawn in one thread anyway."""
    scene = TubeScene(tmp_path)
    pictures = []
    for threads in ("1", "2"):
        monkeypatch.setenv(VARIABLE, threads)
        camera = make_camera(scene)
        camera.update()
        camera.update()
        pictures.append(picture(camera))
    for one, other in zip(*pictures, strict=True):
        np.testing.assert_array_equal(one, other)


def test_a_wall_that_stands_still_is_skinned_once(tmp_path, monkeypatch):
    scene = TubeScene(tmp_path)
    camera = make_camera(scene)
    skinned = []
    monkeypatch.setattr(camera.surface, "update", lambda *args: skinned.append(1))
    for version, times in ((None, 1), (None, 2), (7, 3), (7, 3), (8, 4)):
        scene["colon"].wall_version = version
        camera.update()
        assert len(skinned) == times
    skinned.clear()
    scene["colon"].wall_version = 9
    camera.update(torch.ones(1, dtype=torch.bool))  # some worlds: the others may show an older version
    camera.update()
    camera.update()
    assert len(skinned) == 2
