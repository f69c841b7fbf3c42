# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import torch
from tensordict import TensorDict

from arcgym.rl.augmentation import random_shift, shift_images
from arcgym.rl.networks.augmented_cnn import AugmentedCnnModel

IMAGE = torch.tensor([[1, 2, 3], [4, 5, 6], [7, 8, 9]], dtype=torch.uint8)[None, None]


def test_window_moves_down_and_right_and_repeats_the_border():
    assert shift_images(IMAGE, torch.tensor([[1, 0]]))[0, 0].tolist() == [[4, 5, 6], [7, 8, 9], [7, 8, 9]]
    assert shift_images(IMAGE, torch.tensor([[0, -1]]))[0, 0].tolist() == [[1, 1, 2], [4, 4, 5], [7, 7, 8]]


def test_each_image_moves_by_itself_and_its_channels_alike():
    pair = torch.cat((IMAGE, 10 * IMAGE), dim=1).repeat(2, 1, 1, 1)
    moved = shift_images(pair, torch.tensor([[0, 0], [2, 2]]))
    assert torch.equal(moved[0], pair[0])
    assert moved[1, 0].unique().tolist() == [9]
    assert moved[1, 1].unique().tolist() == [90]


def test_shifts_stay_within_the_limit_and_reach_it():
    torch.manual_seed(0)
    ramp = torch.arange(21, dtype=torch.uint8).expand(500, 1, 21, 21)
    centers = random_shift(ramp, 4)[:, 0, 10, 10]
    assert (int(centers.min()), int(centers.max())) == (6, 14)


def test_only_passes_with_gradients_are_augmented():
    torch.manual_seed(0)
    image = torch.randint(0, 256, (4, 1, 16, 16), dtype=torch.uint8)
    obs = TensorDict({"policy": image}, batch_size=[4])
    cnn = {"output_channels": [4], "kernel_size": 4, "stride": 2}
    model = AugmentedCnnModel(obs, {"actor": ["policy"]}, "actor", 2, [8], cnn_cfg=cnn, shift=3)
    with torch.inference_mode():
        acting = model(obs).clone()
    assert not torch.allclose(model(obs), acting)
    assert torch.equal(model.eval()(obs), acting)
    assert torch.equal(obs["policy"], image)
