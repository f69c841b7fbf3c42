# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""States on the way of each patient's foremost world, from which others try again where it is stuck. N worlds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import torch

from arcgym.sim import Simulation

SPACING = 0.04
"""Way between two states [m]."""
REACH = 0.4
"""Way behind the foremost for which states are kept [m]."""


class Place(NamedTuple):
    """One state on the way."""

    arc: float
    """Arc length of the tip [m]."""
    state: dict[str, torch.Tensor]
    """The world's row of :meth:`Simulation.world_arrays`."""
    memory: list[torch.Tensor]
    """Its rows of what else is remembered."""


class Trail:
    """Keeps states of a few centimeters each, and puts worlds back into them."""

    def __init__(self, sim: Simulation, patients: int, memory: Callable[[], Sequence[torch.Tensor]]):
        """Begin with no states.

        Args:
            sim: The simulation.
            patients: Number of patients P.
            memory: Returns what is remembered of every world beside its state, tensors of shape (N, ...).
        """
        self._sim, self._memory = sim, memory
        self.places: list[list[Place]] = [[] for _ in range(patients)]
        """States on the way of each patient's foremost world, the rearmost first."""

    def follow(self, patient: int, arc: float, world: int) -> None:
        """Keep the state of a patient's foremost world, if it got on by :data:`SPACING` since the last one."""
        places = self.places[patient]
        if places and arc < places[-1].arc + SPACING:
            return
        state = {name: array[world].clone() for name, array in self._sim.world_arrays().items()}
        places.append(Place(arc, state, [array[world].clone() for array in self._memory()]))
        while places[0].arc < arc - REACH:
            places.pop(0)

    def put_back(
        self, worlds: Sequence[int], patients: Sequence[int], least: Sequence[float], draws: Sequence[float]
    ) -> list[int]:
        """Put worlds into states that are drawn among those of their patients; :meth:`Simulation.forward` is called.

        Args:
            worlds: The worlds.
            patients: Patient of each.
            least: Least arc length of the state of each [m].
            draws: Number in [0, 1) for each, that draws the state.

        Returns:
            The worlds that were put back: those for which there was a state.
        """
        chosen: list[tuple[int, Place]] = []
        for world, patient, low, draw in zip(worlds, patients, least, draws, strict=True):
            fit = [place for place in self.places[patient] if place.arc >= low]
            if fit:
                chosen.append((world, fit[int(draw * len(fit))]))
        if not chosen:
            return []
        moved = [world for world, _ in chosen]
        rows = {name: torch.stack([place.state[name] for _, place in chosen]) for name in chosen[0][1].state}
        ids = torch.tensor(moved, device=self._sim.device)
        self._sim.write_state(rows, ids)
        self._sim.forward()
        for k, array in enumerate(self._memory()):
            array[ids] = torch.stack([place.memory[k] for _, place in chosen])
        return moved
