# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Stops training whose numbers are no longer finite."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

import torch

EPISODE = "episode_"
"""Start of the names under which an algorithm reports means over ended episodes: NaN where none has ended."""


class TrainingDiverged(RuntimeError):
    """A loss or a weight is NaN or infinite; the message names it, the iteration, and what to try."""


def check_finite(losses: dict[str, float], models: Mapping[str, Iterable[torch.nn.Parameter]], iteration: int) -> None:
    """Raise unless all losses and weights are finite. Waits for the device once.

    Args:
        losses: Losses of the update, by name.
        models: Weights after the update, by the model's name.
        iteration: Number of the update, from 0.

    Raises:
        TrainingDiverged: Something is not finite.
    """
    true_losses = {name: value for name, value in losses.items() if not name.startswith(EPISODE)}
    broken = [f"loss '{name}' is {value}" for name, value in true_losses.items() if not math.isfinite(value)]
    for name, parameters in models.items():
        finite = [parameter.detach().isfinite().all() for parameter in parameters]
        if finite and not torch.stack(finite).all():
            broken.append(f"weights of the {name} are not finite")
    if broken:
        raise TrainingDiverged(
            f"iteration {iteration}: {', '.join(broken)}. Lower agent.algorithm.learning_rate or "
            "agent.algorithm.max_grad_norm, and look at the reward's scale"
        )
