# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import sys
from types import ModuleType, SimpleNamespace

import pytest
import torch

from arcgym.sensors.depth_estimators import (
    EstimatedDepth,
    SimulatorDepth,
    TransformersDepth,
    align_to_range,
    align_to_reference,
)


def make_env(depth: torch.Tensor) -> SimpleNamespace:
    rgb = torch.zeros(*depth.shape, 3, dtype=torch.uint8)
    camera = SimpleNamespace(data=SimpleNamespace(output={"depth": depth, "rgb": rgb}))
    return SimpleNamespace(unwrapped=SimpleNamespace(scene={"camera": camera}))


def test_simulator_depth_is_the_cameras():
    depth = torch.rand(2, 3, 3)
    assert SimulatorDepth(make_env(depth))() is depth


def test_range_alignment_by_hand():
    """Estimates 0, 5, 10 become inverse depths 10, 55, 100 per meter."""
    depth = align_to_range(torch.tensor([[[0.0, 5.0, 10.0]]]), near=0.01, far=0.1)
    torch.testing.assert_close(depth, torch.tensor([[[0.1, 1 / 55, 0.01]]]))


def test_flat_frame_is_a_wall():
    assert align_to_range(torch.full((1, 2, 2), 3.0), near=0.01, far=0.1).unique().tolist() == pytest.approx([0.01])


def test_reference_alignment_finds_scale_and_shift_of_each_frame():
    torch.manual_seed(0)
    truth = 0.01 + 0.1 * torch.rand(2, 4, 4)
    scale, shift = torch.tensor([0.02, 3.0]).view(2, 1, 1), torch.tensor([1.0, -7.0]).view(2, 1, 1)
    torch.testing.assert_close(align_to_reference(scale / truth + shift, truth), truth, rtol=1e-3, atol=1e-5)


def test_estimate_is_aligned_frame_by_frame():
    env = make_env(torch.rand(2, 1, 3))
    estimate = torch.tensor([[[0.0, 5.0, 10.0]], [[0.0, 50.0, 100.0]]])
    depth = EstimatedDepth(env, lambda images: estimate, near=0.01, far=0.1)()
    torch.testing.assert_close(depth[0], depth[1])


def test_pipeline_result_has_the_size_of_the_image(tmp_path, monkeypatch):
    """A stub in the place of transformers answers with a coarse ramp for each picture."""
    asked = {}

    def pipeline(task, model, device):
        asked.update(task=task, model=model)
        return lambda pictures, batch_size: [{"predicted_depth": torch.eye(2)} for _ in pictures]

    stub = ModuleType("transformers")
    stub.pipeline = pipeline
    monkeypatch.setitem(sys.modules, "transformers", stub)
    images = torch.zeros(3, 4, 6, 3, dtype=torch.uint8)
    inverse = TransformersDepth(tmp_path)(images)
    assert inverse.shape == (3, 4, 6)
    assert float(TransformersDepth(tmp_path, gives_depth=True)(images)[0, 0, 0]) == 1.0 / float(inverse[0, 0, 0])
    assert asked == {"task": "depth-estimation", "model": str(tmp_path)}


def test_missing_weights_are_named(tmp_path):
    with pytest.raises(ValueError, match="nowhere"):
        TransformersDepth(tmp_path / "nowhere")


def test_the_reward_scores_the_estimate(tmp_path, monkeypatch):
    """Whatever the simulator's depth, it is the network's that is scored: here the inverse of a tube's depth."""
    from arcgym.envs import mdp
    from arcgym.managers import RewardTermCfg

    far = torch.full((1, 9, 9), 0.01)
    far[:, 3:6, 3:6] = 0.08
    monkeypatch.setattr(mdp.rewards, "TransformersDepth", lambda *_, **__: lambda images: 1.0 / far)
    camera = SimpleNamespace(output={"depth": torch.zeros(1, 9, 9), "rgb": torch.zeros(1, 9, 9, 3, dtype=torch.uint8)})
    env = SimpleNamespace(device="cpu", num_envs=1, scene={"camera": SimpleNamespace(data=camera)})
    env.unwrapped, env.cfg = env, SimpleNamespace(lumen="paper")
    params = {"weights": "anywhere", "near": 0.01, "far": 0.08}
    term = mdp.estimated_lumen_reward(RewardTermCfg(func=mdp.estimated_lumen_reward, weight=1.0, params=params), env)
    torch.testing.assert_close(term(env, **params), mdp.score_depth(far, mdp.PAPER).reward)
