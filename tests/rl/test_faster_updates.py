# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""PPO's updates in bfloat16 and with compiled networks; SAC's are in test_sac."""

from __future__ import annotations

import pytest
import torch
from pixel_tasks import SteerToDot
from small_agents import runner_cfg

from arcgym.rl import OnPolicyRunner, RslRlPpoAlgorithmCfg
from arcgym.utils.threads import one_thread


def step(mode: str | None = None, mixed: bool = False) -> torch.Tensor:
    """Change of all weights of policy and critic in one update on the same rollout, shape (W,)."""
    algorithm = RslRlPpoAlgorithmCfg(learning_rate=1e-3, schedule="fixed", use_mixed_precision=mixed)
    torch.manual_seed(0)
    cfg = runner_cfg(algorithm=algorithm, torch_compile_mode=mode)
    runner = OnPolicyRunner(SteerToDot(8), cfg.to_dict(), device="cpu")
    weights = [*runner.alg.get_policy().parameters(), *runner.alg._raw_critic.parameters()]
    before = [weight.detach().clone() for weight in weights]
    torch.manual_seed(1)
    runner.learn(1)
    return torch.cat([(weight.detach() - old).flatten() for weight, old in zip(weights, before, strict=True)])


@one_thread()
def test_bfloat16_makes_nearly_the_same_step():
    """Within 11 degrees, and the weights stay float32."""
    plain, mixed = step(), step(mixed=True)
    assert mixed.dtype == torch.float32
    assert not torch.equal(plain, mixed)
    assert float(torch.cosine_similarity(plain, mixed, dim=0)) > 0.98
    assert float(mixed.norm()) == pytest.approx(float(plain.norm()), rel=0.05)


@pytest.mark.slow
@one_thread()
def test_compiled_networks_make_the_same_step():
    torch.testing.assert_close(step(mode="default"), step(), rtol=1e-3, atol=2e-4)
