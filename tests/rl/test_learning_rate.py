# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

from types import SimpleNamespace

import pytest
import torch
from pixel_tasks import SteerToDot
from small_agents import runner_cfg

from arcgym.rl import OnPolicyRunner, RslRlPpoAlgorithmCfg
from arcgym.rl.learning_rate import linear_rate, set_learning_rate
from arcgym.utils.errors import UsageError
from arcgym.utils.threads import one_thread


def make_runner(schedule: str = "fixed", max_iterations: int = 4, learning_rate: float = 4e-3) -> OnPolicyRunner:
    torch.manual_seed(0)
    algorithm = RslRlPpoAlgorithmCfg(learning_rate=learning_rate, schedule=schedule, num_learning_epochs=1)
    cfg = runner_cfg(algorithm=algorithm, final_learning_rate=1e-3, max_iterations=max_iterations)
    return OnPolicyRunner(SteerToDot(4), cfg.to_dict(), device="cpu")


def test_rate_is_on_a_line_and_stays_at_its_end():
    rates = [linear_rate(4.0, 1.0, fraction) for fraction in (0.0, 0.5, 1.0, 2.0)]
    assert rates == [4.0, 2.5, 1.0, 1.0]


@one_thread()
def test_resumed_run_goes_on_along_the_line(tmp_path):
    """Four updates, two of them before it is stopped and two on top of those afterwards."""
    runner = make_runner()
    runner.learn(2)
    assert runner.alg.optimizer.param_groups[0]["lr"] == pytest.approx(3e-3)
    runner.save(str(tmp_path / "model_1.pt"))
    resumed = make_runner(max_iterations=2)
    resumed.load(str(tmp_path / "model_1.pt"))
    resumed.learn(1)
    assert resumed.alg.optimizer.param_groups[0]["lr"] == resumed.alg.learning_rate == pytest.approx(2e-3)


@one_thread()
def test_a_resumed_run_has_the_rate_that_it_is_given(tmp_path) -> None:
    make_runner().save(str(tmp_path / "model_0.pt"))
    resumed = make_runner(learning_rate=2e-3)
    resumed.load(str(tmp_path / "model_0.pt"))
    assert resumed.alg.optimizer.param_groups[0]["lr"] == resumed.alg.learning_rate == 2e-3


def test_a_rate_that_a_graph_reads_changes_in_place():
    rate = torch.tensor(4e-3)
    learner = SimpleNamespace(optimizer=torch.optim.Adam([torch.zeros(1)], lr=rate))
    set_learning_rate(learner, 1e-3)
    assert learner.optimizer.param_groups[0]["lr"] is rate
    assert float(rate) == pytest.approx(1e-3)


def test_adaptive_schedule_is_refused():
    with pytest.raises(UsageError, match="'adaptive', expected 'fixed'"):
        make_runner("adaptive")
