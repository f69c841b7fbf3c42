# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Reads what a layer was given in the last forward pass."""

from __future__ import annotations

from typing import Any

import torch
from torch import nn


class FeatureReader:
    """Keeps the input of a layer's last call, with its gradients."""

    def __init__(self, layer: nn.Module):
        """Watch ``layer``."""
        self.last = torch.empty(0)
        layer.register_forward_pre_hook(self._keep)

    def _keep(self, layer: nn.Module, inputs: tuple[Any, ...]) -> None:
        self.last = inputs[0]
