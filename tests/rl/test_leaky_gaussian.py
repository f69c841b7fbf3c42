# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""The mean of a leaky normal distribution stays near what is carried out, and a policy of the plain one fits."""

from __future__ import annotations

import pytest
import torch
from rsl_rl.models import MLPModel
from tensordict import TensorDict

from arcgym.rl.networks.leaky_gaussian import LeakyGaussianDistribution

LEAKY = "arcgym.rl.networks.leaky_gaussian:LeakyGaussianDistribution"


def _model(kind: str) -> MLPModel:
    obs = TensorDict({"state": torch.zeros(4, 3)}, batch_size=[4])
    distribution = {"class_name": kind, "init_std": 0.5}
    return MLPModel(obs, {"actor": ["state"]}, "actor", 2, hidden_dims=[8], distribution_cfg=distribution)


@pytest.mark.parametrize(("x", "mean"), [(0.3, 0.3), (-1.0, -1.0), (3.0, 1.2), (-2.0, -1.1)])
def test_mean_by_hand(x: float, mean: float):
    distribution = LeakyGaussianDistribution(1, init_std=0.5)
    output = torch.tensor([[x]], requires_grad=True)
    distribution.update(output)
    assert distribution.mean.item() == pytest.approx(mean)
    assert distribution.deterministic_output(output).item() == pytest.approx(mean)
    exported = torch.jit.script(distribution.as_deterministic_output_module())
    assert exported(output).item() == pytest.approx(mean)
    (slope,) = torch.autograd.grad(distribution.mean.sum(), output)
    assert slope.item() == pytest.approx(0.1 if abs(x) > 1.0 else 1.0)


def test_samples_come_back_into_the_bounds_where_plain_ones_do_not():
    torch.manual_seed(0)
    output = torch.full((1000, 1), 3.0)
    leaky, plain = _model(LEAKY).distribution, _model("GaussianDistribution").distribution
    inside = []
    for distribution in (leaky, plain):
        distribution.update(output)
        inside.append((distribution.sample()[:, 0] < 1.0).float().mean().item())
    assert inside[0] == pytest.approx(0.345, abs=0.05)  # of a normal distribution below -0.4 deviations
    assert inside[1] == 0.0


def test_policy_of_the_plain_distribution_acts_alike_within_the_bounds():
    plain, leaky = _model("GaussianDistribution"), _model(LEAKY)
    leaky.load_state_dict(plain.state_dict())
    obs = TensorDict({"state": 5.0 * torch.randn(64, 3)}, batch_size=[64])
    torch.testing.assert_close(leaky(obs).clamp(-1.0, 1.0), plain(obs).clamp(-1.0, 1.0))
