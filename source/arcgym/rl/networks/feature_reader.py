# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Reads what a layer was given in the last forward pass."""

from __future__ import annotations

from typing import Any

import torch
from torch import nn


class FeatureReader:
    """Keeps the input of a layer's last call, with its gradients, in a ``with`` block.

    Outside of it the layer has no hook: TorchScript cannot export one.
    """

    def __init__(self, layer: nn.Module):
        """Remember which layer to watch."""
        self.layer, self.last = layer, torch.empty(0)

    def __enter__(self) -> FeatureReader:
        """Watch the layer."""
        self._handle = self.layer.register_forward_pre_hook(self._keep)
        return self

    def __exit__(self, *error: object) -> None:
        """Leave the layer as it was."""
        self._handle.remove()

    def _keep(self, layer: nn.Module, inputs: tuple[Any, ...]) -> None:
        self.last = inputs[0]
