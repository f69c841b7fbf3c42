# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Copies between host and device for which the host does not wait until the device has nothing left to do."""

from __future__ import annotations

import torch


class HostCopy:
    """Brings a tensor from the device to the host: asked for at one point of the program, waited for at a later one.

    The host waits for what was launched before :meth:`ask` alone. What is launched between the two keeps the device
    busy while the host goes on with the answer.
    """

    def __init__(self, like: torch.Tensor) -> None:
        """Allocate the copy.

        Args:
            like: Tensor of the shape, type and device of those that will be asked for.
        """
        self._copy = torch.empty_like(like, device="cpu", pin_memory=like.is_cuda)
        self._arrived = torch.cuda.Event() if like.is_cuda else None

    def ask(self, values: torch.Tensor) -> None:
        """Have values copied as soon as the device has made them; they replace those asked for before."""
        self._copy.copy_(values, non_blocking=True)
        if self._arrived is not None:
            self._arrived.record(torch.cuda.current_stream(values.device))

    def wait(self) -> torch.Tensor:
        """Return the values last asked for, on the host, in memory that the next :meth:`ask` overwrites."""
        if self._arrived is not None:
            self._arrived.synchronize()
        return self._copy


def send(values: torch.Tensor, device: str) -> torch.Tensor:
    """Return a copy on the device of a small tensor on the host; the host does not wait for it."""
    if torch.device(device).type != "cuda":
        return values.to(device)
    return values.pin_memory().to(device, non_blocking=True)
