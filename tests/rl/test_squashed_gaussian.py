# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import torch
from torch.distributions import Independent, Normal, TransformedDistribution
from torch.distributions.transforms import TanhTransform

from arcgym.rl.networks.squashed_gaussian import SquashedGaussianDistribution


def make(mean, log_std) -> SquashedGaussianDistribution:
    distribution = SquashedGaussianDistribution(2)
    distribution.update(torch.tensor([mean, log_std]).unsqueeze(0))
    return distribution


def test_log_probability_is_that_of_the_squashed_variable():
    distribution = make([0.3, -1.0], [-0.5, 0.2])
    base = Independent(Normal(torch.tensor([[0.3, -1.0]]), torch.tensor([[-0.5, 0.2]]).exp()), 1)
    reference = TransformedDistribution(base, TanhTransform())
    actions, log_prob = distribution.sample_with_log_prob()
    torch.testing.assert_close(log_prob, reference.log_prob(actions), rtol=1e-3, atol=1e-3)
    torch.testing.assert_close(distribution.log_prob(actions), log_prob, rtol=1e-3, atol=1e-3)


def test_samples_stay_in_range_and_carry_gradients():
    output = torch.tensor([[[9.0, 0.0], [2.0, 2.0]]], requires_grad=True)
    distribution = SquashedGaussianDistribution(2)
    distribution.update(output)
    actions = distribution.sample()
    assert float(actions.detach().abs().max()) <= 1.0
    distribution.sample_with_log_prob()[1].sum().backward()
    assert bool(torch.isfinite(output.grad).all())


def test_mean_action_is_the_squashed_mean():
    output = torch.tensor([[[0.5, -2.0], [0.0, 0.0]]])
    expected = torch.tanh(torch.tensor([[0.5, -2.0]]))
    distribution = SquashedGaussianDistribution(2)
    assert torch.equal(distribution.deterministic_output(output), expected)
    assert torch.equal(distribution.as_deterministic_output_module()(output), expected)


def test_values_are_not_checked_which_would_wait_for_the_device():
    distribution = make([float("nan"), 0.0], [0.0, 0.0])
    assert bool(distribution.sample_with_log_prob()[1].isnan().all())
