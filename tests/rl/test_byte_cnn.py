# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import pytest
import torch
from rsl_rl.models import CNNModel
from tensordict import TensorDict

from arcgym.rl import ByteCnnModel, export_policy_as_jit, export_policy_as_onnx

CNN = {"output_channels": [4, 4], "kernel_size": [4, 3], "stride": [2, 2]}
GAUSSIAN = {"class_name": "GaussianDistribution", "init_std": 0.5}


def make_obs(num_envs: int = 3) -> TensorDict:
    torch.manual_seed(0)
    image = torch.randint(0, 256, (num_envs, 6, 20, 20), dtype=torch.uint8)
    return TensorDict({"policy": image, "proprio": torch.randn(num_envs, 5)}, batch_size=[num_envs])


def make_model(*groups: str, **kwargs) -> ByteCnnModel:
    obs, kwargs = make_obs(), {"hidden_dims": [8], "cnn_cfg": CNN, "distribution_cfg": dict(GAUSSIAN), **kwargs}
    torch.manual_seed(1)
    return ByteCnnModel(obs, {"actor": list(groups)}, "actor", 2, **kwargs)


def test_bytes_equal_floats_in_the_stock_model():
    obs, model = make_obs(), make_model("policy")
    torch.manual_seed(1)
    stock = CNNModel(obs, {"actor": ["policy"]}, "actor", 2, [8], cnn_cfg=CNN, distribution_cfg=dict(GAUSSIAN))
    floats = TensorDict({"policy": obs["policy"].float() / 255.0 - 0.5}, batch_size=[3])
    torch.testing.assert_close(model(obs), stock(floats))


def test_float_images_are_refused():
    obs = TensorDict({"policy": torch.zeros(3, 6, 20, 20)}, batch_size=[3])
    with pytest.raises(TypeError, match="'policy'.*float32.*uint8"):
        ByteCnnModel(obs, {"actor": ["policy"]}, "actor", 2, [8], cnn_cfg=CNN)


def test_normalization_without_vectors_is_refused():
    with pytest.raises(ValueError, match="only images"):
        make_model("policy", obs_normalization=True)


def test_jit_equals_the_policy(tmp_path):
    obs, model = make_obs(), make_model("policy", "proprio", obs_normalization=True)
    policy = torch.jit.load(export_policy_as_jit(model.eval(), tmp_path))
    torch.testing.assert_close(policy(obs["proprio"], [obs["policy"]]), model(obs))


@pytest.mark.parametrize("groups", [("policy",), ("policy", "proprio")])
def test_onnx_equals_the_policy(tmp_path, groups):
    reference = pytest.importorskip("onnx.reference")
    obs, model = make_obs(5), make_model(*groups)
    path = export_policy_as_onnx(model.eval(), tmp_path)
    inputs = {"policy": obs["policy"].numpy()} | ({"obs": obs["proprio"].numpy()} if "proprio" in groups else {})
    actions = reference.ReferenceEvaluator(str(path)).run(None, inputs)[0]
    torch.testing.assert_close(torch.from_numpy(actions), model(obs).detach(), rtol=1e-4, atol=1e-5)
