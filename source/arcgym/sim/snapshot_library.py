# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Stored states on the simulation's device, from which worlds are set."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch

from arcgym.sim.snapshot import Snapshot, SnapshotSet
from arcgym.utils.world_rows import WorldRows, packed


class SnapshotLibrary:
    """Holds the rest pose and the loaded snapshots of every patient in one table, a row for each."""

    def __init__(self, rests: Sequence[Snapshot], arrays: dict[str, torch.Tensor], patient: torch.Tensor):
        """Start with the rest poses alone.

        Args:
            rests: State of index -1 of each of P patients.
            arrays: State of all worlds by name, each of shape (N, ...), to write to.
            patient: Patient of all worlds, shape (N,), read at every write.
        """
        self._rests, self._patient, self._device = rests, patient, patient.device
        self._state = WorldRows([arrays[name] for name in rests[0].arrays])
        self.snapshots: SnapshotSet | None = None
        """The loaded snapshots of the first patient; the others have the same names."""
        self._stack([[rest] for rest in rests])

    def load(self, sets: Sequence[SnapshotSet]) -> None:
        """Replace the loaded snapshots by those of each patient; names that some patient lacks are left out.

        Raises:
            ValueError: If there are not as many sets as patients, or they have no name in common.
        """
        names = [name for name in sets[0].names if all(name in one.names for one in sets)] if sets else []
        if len(sets) != len(self._rests) or not names:
            raise ValueError(
                f"{len(sets)} sets of start states with {names or 'no'} names in common were given, expected one for "
                f"each of {len(self._rests)} patients."
            )
        kept = [one.only(names) for one in sets]
        self.snapshots = kept[0]
        self._stack(
            [
                [rest, *(with_room(state, rest) for state in one.snapshots)]
                for rest, one in zip(self._rests, kept, strict=True)
            ]
        )

    def write(self, index: torch.Tensor | int, env_ids: torch.Tensor) -> None:
        """Copy stored states into some worlds.

        Args:
            index: Which state each world takes, shape (n,), or one for all; -1 is the rest pose.
            env_ids: World indices, int64, shape (n,).

        Raises:
            IndexError: If there is no such state; indices on a GPU are not checked, for that would wait for it.
        """
        self._check(torch.as_tensor(index))
        state = torch.as_tensor(index, device=self._device, dtype=torch.long) + 1
        row = torch.add(state, self._patient[env_ids], alpha=self._states_each).int()
        self._state.copy(self._table, row, env_ids)

    def _check(self, index: torch.Tensor) -> None:
        stored = 0 if self.snapshots is None else len(self.snapshots.snapshots)
        if not index.is_cuda and ((index < -1) | (index >= stored)).any():
            raise IndexError(
                f"Snapshot index {index.tolist()}: {stored} snapshots are loaded, from 0; -1 is the rest pose."
            )

    def _stack(self, snapshots: Sequence[Sequence[Snapshot]]) -> None:
        """Put the states of each patient into the table, S rows for each of the P patients."""
        self._states_each = len(snapshots[0])
        self._table = packed([self._stacked(name, snapshots) for name in self._rests[0].arrays])

    def _stacked(self, name: str, snapshots: Sequence[Sequence[Snapshot]]) -> torch.Tensor:
        """One array of all states, shape (P * S, ...)."""
        empty = np.zeros_like(self._rests[0].arrays[name])
        values = [[snapshot.arrays.get(name, empty) for snapshot in own] for own in snapshots]
        return torch.tensor(np.concatenate([np.stack(own) for own in values]), device=self._device)


def with_room(snapshot: Snapshot, rest: Snapshot) -> Snapshot:
    """Return a state whose memory of contacts has the room that a simulation has for them.

    It is empty where the state has none, or more contacts than find room.

    Args:
        snapshot: The state.
        rest: A state of the simulation.
    """
    own = {name: array for name, array in rest.arrays.items() if name.startswith("contact_")}
    stored = {name: snapshot.arrays[name] for name in own if name in snapshot.arrays}
    fits = len(stored) == len(own)
    if fits and own:
        fits = stored["contact_start"].shape == own["contact_start"].shape
        fits = fits and stored["contact_start"][-1] <= len(own["contact_face"])
    fitted = {}
    for name, array in own.items():
        fitted[name] = np.zeros_like(array)
        if fits:
            length = min(len(array), len(stored[name]))
            fitted[name][:length] = stored[name][:length]
    return Snapshot({**snapshot.arrays, **fitted})
