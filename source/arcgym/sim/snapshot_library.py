# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Stored states on the simulation's device, from which worlds are set."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch

from arcgym.sim.snapshot import Snapshot, SnapshotSet


class SnapshotLibrary:
    """Holds the rest pose and the loaded snapshots as one tensor for each array of the state."""

    def __init__(self, rest: Snapshot, device: str):
        """Start with the rest pose alone.

        Args:
            rest: State of index -1.
            device: Device of the tensors.
        """
        self._rest, self._device = rest, device
        self.snapshots: SnapshotSet | None = None
        """The loaded snapshots."""
        self._arrays = self._stack([rest])

    def load(self, snapshots: SnapshotSet) -> None:
        """Replace the loaded snapshots."""
        self.snapshots = snapshots
        self._arrays = self._stack([self._rest, *snapshots.snapshots])

    def write(self, arrays: dict[str, torch.Tensor], index: torch.Tensor | int, env_ids: torch.Tensor) -> None:
        """Copy stored states into some worlds.

        Args:
            arrays: State of all worlds by name, each of shape (N, ...); changed in place.
            index: Which state each world takes, shape (n,), or one for all; -1 is the rest pose.
            env_ids: World indices, int64, shape (n,).

        Raises:
            IndexError: If there is no such state; indices on a GPU are not checked, for that would wait for it.
        """
        self._check(torch.as_tensor(index))
        row = torch.as_tensor(index, device=self._device, dtype=torch.long).expand(len(env_ids)) + 1
        for name, array in arrays.items():
            array[env_ids] = self._arrays[name][row].view(len(env_ids), *array.shape[1:])

    def _check(self, index: torch.Tensor) -> None:
        stored = 0 if self.snapshots is None else len(self.snapshots.snapshots)
        if not index.is_cuda and ((index < -1) | (index >= stored)).any():
            raise IndexError(
                f"Snapshot index {index.tolist()}: {stored} snapshots are loaded, from 0; -1 is the rest pose."
            )

    def _stack(self, snapshots: Sequence[Snapshot]) -> dict[str, torch.Tensor]:
        return {name: self._stacked(name, snapshots) for name in self._rest.arrays}

    def _stacked(self, name: str, snapshots: Sequence[Snapshot]) -> torch.Tensor:
        """One array of all states. Friction's memory is empty in states that were made with room for other contacts."""
        empty = np.zeros_like(self._rest.arrays[name])
        values = [snapshot.arrays.get(name, empty) for snapshot in snapshots]
        if name.startswith("contact_"):
            values = [value if value.shape == empty.shape else empty for value in values]
        return torch.tensor(np.stack(values), device=self._device)
