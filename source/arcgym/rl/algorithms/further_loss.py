# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""One more loss of PPO's mini-batches, at the place where rsl_rl's PPO asks its extension for symmetry."""

from __future__ import annotations

from typing import Any

import torch
from rsl_rl.models import MLPModel


class FurtherLoss:
    """Loss that PPO adds to its own; set it as ``alg.symmetry``. Its mean is reported as ``symmetry``."""

    use_mirror_loss = True

    def __init__(self, coef: float):
        """Keep the weight of the loss."""
        self.mirror_loss_coeff = coef

    def augment_batch(self, batch: Any, size: int) -> None:
        """Leave the mini-batch as it is."""

    def compute_loss(self, actor: MLPModel, batch: Any, size: int) -> torch.Tensor:
        """Return the mean loss of the mini-batch that the policy has just seen."""
        raise NotImplementedError
