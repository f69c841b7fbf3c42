# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""PPO with a bounds loss: its arithmetic, and that means come back into the bounds."""

from __future__ import annotations

import pytest
import torch
from pixel_tasks import SteerToDot
from small_agents import roll_and_update, runner_cfg

from arcgym.rl import OnPolicyRunner
from arcgym.rl.agent_cfgs.ppo_bounded import RslRlPpoBoundedAlgorithmCfg
from arcgym.rl.algorithms.ppo_bounded import bounds_loss
from arcgym.utils.threads import one_thread


def test_loss_by_hand():
    """Drawn to 1 and -1 in the first row, 0.5 and 2 away from it; in the second to what it was: (0.25 + 4) / 2."""
    mean, former = torch.tensor([[1.5, -3.0], [0.4, -0.2]]), torch.tensor([[2.0, -3.0], [0.4, -0.2]])
    assert bounds_loss(mean, former).item() == pytest.approx(2.125)


def _means_after(coef: float, updates: int = 12) -> torch.Tensor:
    """Return the mean actions of a policy that began far beyond the bounds."""
    torch.manual_seed(0)
    algorithm = RslRlPpoBoundedAlgorithmCfg(learning_rate=3e-3, schedule="fixed", gamma=0.8, bounds_loss_coef=coef)
    runner = OnPolicyRunner(SteerToDot(16), runner_cfg(algorithm=algorithm).to_dict(), device="cpu")
    with torch.no_grad():
        runner.alg.actor.mlp[-1].bias.fill_(5.0)
    for _ in range(updates):
        losses = roll_and_update(runner)
    assert losses["bounds"] >= 0.0
    with torch.no_grad():
        return runner.alg.actor(runner.env.get_observations())


@one_thread()
def test_means_come_back_into_the_bounds():
    assert _means_after(coef=1.0).abs().median() < 1.5
    assert _means_after(coef=0.0).abs().median() > 3.0
