# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The rows of action and reaction are out of their bound where a force is lost or late."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from arcgym.benchmarks.fidelity.checks import moving
from arcgym.benchmarks.fidelity.models import build
from arcgym.benchmarks.fidelity.rows import Row, Run

Loss = Callable[[Any, np.ndarray], np.ndarray]
"""What becomes of the debts of a step [N], shape (W, L, 3), given the simulation."""


def three_percent(sim: Any, debt: np.ndarray) -> np.ndarray:
    """Of all that the links have had from the wall they hand on 97 %."""
    return debt + 0.03 * sim.endoscope.data.link_force_w.numpy()


def forget(sim: Any, debt: np.ndarray) -> np.ndarray:
    """Nothing is paid."""
    return 0.0 * debt


class Hold:
    """Everything is paid a step later still."""

    def __init__(self) -> None:
        self.held: np.ndarray | float = 0.0

    def __call__(self, sim: Any, debt: np.ndarray) -> np.ndarray:
        due, self.held = self.held, debt.copy()
        return due + 0.0 * debt


def worst(run: Run, monkeypatch: pytest.MonkeyPatch, material: str, loss: Loss) -> Row:
    """Return the row with a loss after every step."""

    def lossy(*args: Any, **kwargs: Any) -> Any:
        sim = build(*args, **kwargs)
        step = sim.step

        def step_and_lose(count: int) -> None:
            step(count)
            sim.contact.debt.assign(loss(sim, sim.contact.debt.numpy()))

        sim.step = step_and_lose
        return sim

    monkeypatch.setattr(moving, "build", lossy)
    return moving.action_reaction(run, material)[1]


def test_a_loss_of_three_percent_is_seen(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    row = worst(run, monkeypatch, "paper", three_percent)
    assert not row.ok and 0.03 < row.error < 0.06  # the largest force is 1.8 times the mean


@pytest.mark.slow
@pytest.mark.parametrize("loss", [three_percent, forget, Hold()], ids=["lost", "forgotten", "later"])
def test_in_soft_tissue_a_loss_is_seen(run: Run, monkeypatch: pytest.MonkeyPatch, loss: Loss) -> None:
    assert not worst(run, monkeypatch, "in_situ", loss).ok


def test_a_largest_mean_is_that_of_any_steps_one_after_the_other() -> None:
    force = np.zeros((9, 3))
    force[4:6, 1] = 1.0
    assert moving.largest_mean(force, 4) == pytest.approx(0.5)
