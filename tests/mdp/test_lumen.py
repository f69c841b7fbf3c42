# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""The reward equations against depth images small enough to score by hand."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest
import torch
import warp as wp

from arcgym.envs.mdp.lumen import METRIC, PAPER, LumenCfg, lumen_scores, resolve_lumen, score_depth
from arcgym.envs.mdp.lumen_cuda_kernels import score_images_together
from arcgym.envs.mdp.lumen_kernels import LumenConstants


class FakeEnv:
    """An environment with nothing but a camera and a preset."""

    def __init__(self, depth: torch.Tensor, lumen: str = "paper"):
        self.images = SimpleNamespace(output={"depth": depth}, frame=1)
        self.scene = {"camera": SimpleNamespace(data=self.images)}
        self.cfg = SimpleNamespace(lumen=lumen)


def one_deep_pixel(row: int, column: int, near: float, far: float, height: int = 3, width: int = 5) -> torch.Tensor:
    depth = torch.full((1, height, width), near)
    depth[0, row, column] = far
    return depth


def test_centering_is_one_in_the_middle_and_zero_in_the_corner() -> None:
    middle = score_depth(one_deep_pixel(1, 2, 0.01, 0.1), PAPER)
    corner = score_depth(one_deep_pixel(0, 0, 0.01, 0.1), PAPER)
    assert middle.s_c.item() == pytest.approx(1.0)
    assert corner.s_c.item() == pytest.approx(0.0, abs=1e-6)


def test_center_is_mean_of_the_deep_pixels() -> None:
    depth = torch.tensor([[[0.1, 0.1, 0.1], [0.1, 1.0, 0.8], [0.1, 0.1, 0.69]]])
    scores = score_depth(depth, PAPER)
    # tau = 0.7 m: two pixels, (1, 1) and (1, 2); their mean is half a pixel right of the center (1, 1).
    torch.testing.assert_close(scores.center, torch.tensor([[1.0, 1.5]]))
    assert scores.s_c.item() == pytest.approx(1.0 - 0.5 / math.sqrt(2.0))


def test_paper_preset_by_hand() -> None:
    depth = torch.full((1, 2, 2), 0.004)
    depth[0, 0] = 0.0125
    scores = score_depth(depth, PAPER)
    # d_max = 12.5 mm, d_min = 4 mm, the upper two of four pixels are deep, their mean is half a pixel above the center.
    assert scores.s_1.item() == pytest.approx((12.5 - 5.0) / 15.0)  # 0.5
    assert scores.s_2.item() == pytest.approx((0.5 - 0.2) / 0.8)  # 0.375
    assert scores.s_3.item() == pytest.approx((8.5 - 4.0) / 8.0)  # 0.5625
    s_o = 2.0 * (0.6 * 0.5 + 0.4 * 0.375) * 0.5625 - 1.0
    s_c = 1.0 - 0.5 / math.sqrt(0.5)
    assert scores.s_o.item() == pytest.approx(s_o, abs=1e-6)
    assert scores.s_c.item() == pytest.approx(s_c, abs=1e-6)
    assert scores.reward.item() == pytest.approx(0.5 * s_c + 0.5 * s_o, abs=1e-6)


def test_metric_preset_by_hand() -> None:
    scores = score_depth(one_deep_pixel(1, 1, 0.011, 0.050, 3, 3), METRIC)
    # d_max = 50 mm, contrast 39 mm, one of nine pixels is deep.
    s_2 = (1.0 / 9.0 - 0.002) / 0.998
    assert scores.s_1.item() == pytest.approx(0.5)
    assert scores.s_2.item() == pytest.approx(s_2)
    assert scores.s_3.item() == pytest.approx(0.5, abs=1e-6)
    s_o = 2.0 * (0.9 * 0.5 + 0.1 * s_2) * 0.5 - 1.0
    assert scores.s_o.item() == pytest.approx(s_o, abs=1e-6)
    assert scores.reward.item() == pytest.approx(0.4 + 0.6 * s_o, abs=1e-6)


def test_depth_is_clipped_at_the_far_plane() -> None:
    scores = score_depth(one_deep_pixel(1, 1, 0.01, 0.5, 3, 3), METRIC)
    assert scores.depth_max.item() == pytest.approx(0.10)


def test_flat_wall_gives_the_lowest_visibility() -> None:
    scores = score_depth(torch.full((1, 4, 4), 0.003), PAPER)
    assert scores.s_o.item() == -1.0
    assert scores.reward.item() == pytest.approx(0.5 * 1.0 - 0.5)


def test_image_with_a_nan_has_no_score() -> None:
    image = torch.full((2, 3, 5), 0.03)
    image[0, 1, 1] = torch.nan
    scores = score_depth(image, METRIC)
    assert scores.reward.isnan().tolist() == [True, False] and scores.depth_max.isnan().tolist() == [True, False]


def test_large_and_double_images_are_scored() -> None:
    scores = score_depth(torch.full((1, 2000, 2000), 0.03, dtype=torch.float64), PAPER)
    assert scores.center.tolist() == [pytest.approx([999.5, 999.5])] and scores.s_c.item() == pytest.approx(1.0)


def test_the_kernel_for_a_gpu_scores_as_the_one_for_a_cpu_does() -> None:
    depth = 0.15 * torch.rand(6, 30, 40, generator=torch.Generator().manual_seed(0))
    depth[1, 2, 3], depth[2], depth[3] = math.nan, 0.6, 0.0
    constants = LumenConstants()
    for name, value in vars(METRIC).items():
        setattr(constants, name, value)
    scores = torch.empty(10, 6)
    inputs = [wp.from_torch(depth.flatten(1)), 40, 1, constants, wp.from_torch(scores)]
    wp.launch(score_images_together, (6, 1), inputs=inputs, device="cpu")
    known = score_depth(depth, METRIC)
    expected = [known.s_c, known.s_1, known.s_2, known.s_3, known.s_o, known.reward, *known.center.T]
    torch.testing.assert_close(scores, torch.stack([*expected, known.depth_min, known.depth_max]), equal_nan=True)


def test_worlds_are_scored_independently() -> None:
    images = torch.cat([one_deep_pixel(1, 2, 0.01, 0.1), torch.full((1, 3, 5), 0.003)])
    both = score_depth(images, PAPER).reward
    alone = torch.cat([score_depth(image[None], PAPER).reward for image in images])
    assert torch.equal(both, alone)


def test_scores_are_computed_once_an_image() -> None:
    env = FakeEnv(one_deep_pixel(1, 2, 0.01, 0.1))
    first = lumen_scores(env)
    env.images.output["depth"] = torch.full((1, 3, 5), 0.003)
    assert lumen_scores(env) is first
    env.images.frame += 1
    assert lumen_scores(env).s_o.item() == -1.0


def test_presets_are_cached_apart() -> None:
    env = FakeEnv(one_deep_pixel(1, 1, 0.011, 0.050, 3, 3), lumen="metric")
    assert lumen_scores(env).s_1.item() == pytest.approx(0.5)
    assert lumen_scores(env, "paper").s_1.item() == 1.0
    assert lumen_scores(env, LumenCfg(tau_lumen=0.1)).s_1.item() == pytest.approx(45.0 / 95.0)


def test_unknown_preset_lists_the_known() -> None:
    with pytest.raises(ValueError, match="no lumen preset 'papper'. Did you mean 'paper'"):
        resolve_lumen("papper")


def test_falling_ramp_is_refused() -> None:
    with pytest.raises(ValueError, match=r"tau_wall \(0.1 m\) < tau_lumen \(0.02 m\) must hold"):
        LumenCfg(tau_wall=0.1).validate_config()
