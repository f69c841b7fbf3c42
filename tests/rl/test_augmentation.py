# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import pytest
import torch
from tensordict import TensorDict

from arcgym.rl import export_policy_as_jit, export_policy_as_onnx
from arcgym.rl.augmentation import jitter_colors, random_shift, shift_images, shrink_images
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


def test_color_jitter_stays_within_its_strength_and_is_alike_in_a_stack():
    """A gray image has no contrast and no saturation: its value is multiplied by 0.8 to 1.2."""
    torch.manual_seed(0)
    gray = torch.full((300, 6, 2, 2), 100, dtype=torch.uint8)
    changed = jitter_colors(gray, 0.2)
    assert changed.dtype == torch.uint8
    assert (80, 120) == (int(changed.min()), int(changed.max()))
    assert torch.equal(changed, changed[:, :1, :1, :1].expand_as(changed))
    assert torch.equal(jitter_colors(gray, 0.0), gray)


def test_color_jitter_changes_contrast_and_saturation():
    torch.manual_seed(0)
    image = torch.tensor([200, 100, 60], dtype=torch.uint8).view(1, 3, 1, 1).repeat(300, 1, 2, 2)
    image[:, :, 0] //= 2
    changed = jitter_colors(image, 0.3).float()
    contrast = changed[:, 0, 1, 0] / changed[:, 0, 0, 0]
    saturation = changed[:, 0, 1, 0] / changed[:, 2, 1, 0]
    assert contrast.min() < 1.9 and contrast.max() > 2.1
    assert saturation.min() < 3.0 and saturation.max() > 3.8


def test_small_and_full_images_give_the_same_action(tmp_path):
    """The memory keeps small images, the environment shows full ones; exported policies take those."""
    torch.manual_seed(0)
    image = torch.randint(0, 256, (4, 3, 24, 24), dtype=torch.uint8)
    obs = TensorDict({"policy": image}, batch_size=[4])
    cnn = {"output_channels": [4], "kernel_size": 4, "stride": 2}
    model = AugmentedCnnModel(obs, {"actor": ["policy"]}, "actor", 2, [8], cnn_cfg=cnn, shrink=2)
    small = TensorDict({"policy": shrink_images(image, 2)}, batch_size=[4])
    actions = model(obs)
    assert torch.equal(model(small), actions)
    script = torch.jit.load(str(export_policy_as_jit(model, tmp_path)))
    torch.testing.assert_close(script(torch.zeros(4, 0), [image]), actions)
    export_policy_as_onnx(model, tmp_path)
    onnx = pytest.importorskip("onnx.reference").ReferenceEvaluator(str(tmp_path / "policy.onnx"))
    torch.testing.assert_close(
        torch.tensor(onnx.run(None, {"policy": image.numpy()})[0]), actions, rtol=1e-4, atol=1e-5
    )
