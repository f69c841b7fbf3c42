# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Correlated noise has the deviation of plain noise in each step, and lasts."""

from __future__ import annotations

import pytest
import torch

from arcgym.rl import GaussianDistributionCfg
from arcgym.rl.networks.correlated_gaussian import CorrelatedGaussianDistribution
from arcgym.utils.validation import FieldError

WORLDS = 20_000


def _noise(correlation: float, steps: int) -> torch.Tensor:
    """Return the samples of worlds whose mean action is 0.5, less that, shape (steps, WORLDS)."""
    torch.manual_seed(0)
    distribution = CorrelatedGaussianDistribution(1, correlation=correlation, init_std=0.3)
    with torch.no_grad():
        distribution.update(torch.full((WORLDS, 1), 0.5))
        return torch.stack([distribution.sample()[:, 0] - 0.5 for _ in range(steps)])


@pytest.mark.parametrize("correlation", [0.0, 0.6, 0.9])
def test_each_step_has_the_deviation_and_the_next_the_correlation(correlation: float):
    noise = _noise(correlation, 4)
    assert noise.std(dim=1).tolist() == pytest.approx([0.3] * 4, rel=0.03)
    of_two_steps = torch.corrcoef(noise)
    for lag in (1, 2, 3):
        assert of_two_steps[0, lag].item() == pytest.approx(correlation**lag, abs=0.03)


def test_updates_draw_without_a_past():
    distribution = CorrelatedGaussianDistribution(1, correlation=0.999, init_std=1.0)
    distribution.update(torch.zeros(WORLDS, 1))
    with torch.no_grad():
        first = distribution.sample()
    drawn_in_an_update = distribution.sample()
    with torch.no_grad():
        second = distribution.sample()
    assert torch.corrcoef(torch.cat([first, second], dim=1).T)[0, 1] > 0.99
    assert torch.corrcoef(torch.cat([first, drawn_in_an_update], dim=1).T)[0, 1].abs() < 0.05


def test_another_number_of_worlds_begins_anew():
    distribution = CorrelatedGaussianDistribution(2)
    with torch.no_grad():
        for worlds in (3, 5):
            distribution.update(torch.zeros(worlds, 2))
            assert distribution.sample().shape == (worlds, 2)


def test_a_correlation_of_one_is_refused():
    with pytest.raises(FieldError, match="correlation is 1.0, expected a number at least 0 and below 1"):
        GaussianDistributionCfg(correlation=1.0).validate_config()


def test_plain_noise_has_no_correlation():
    with pytest.raises(FieldError, match="with class_name GaussianDistribution: noise that lasts is"):
        GaussianDistributionCfg(correlation=0.5).validate_config()
