# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Drives that were cut off in a patient: what another drive needs to go on there."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch

from arcgym.sim import Snapshot
from arcgym.sim.snapshot import fingerprint
from arcgym.start_states.drive import Drive
from arcgym.start_states.route import Entry
from arcgym.start_states.trail import Place
from arcgym.utils.array_files import load_arrays, save_arrays


@dataclass
class Halt:
    """One patient of a drive that was cut off: W worlds, and T states on the way of the foremost."""

    fingerprint: str
    """Of the patient's wall and the scope."""
    arc: float
    """Largest arc length of a tip [m]."""
    time: float
    """Simulated time that it took [s]."""
    entries: dict[str, Entry]
    """How each segment was entered."""
    states: dict[str, dict[str, np.ndarray]]
    """State at the start of each segment entered."""
    worlds: dict[str, np.ndarray]
    """States of the worlds, as :meth:`Simulation.world_arrays`, shape (W, ...)."""
    memory: list[np.ndarray]
    """What is remembered of them, as :meth:`Drive.memory`, shape (W, ...)."""
    settings: dict[str, np.ndarray]
    """Settings of their experts, shape (W,)."""
    trail: list[float]
    """Arc lengths of the states on the way [m]."""
    trail_states: dict[str, np.ndarray]
    """These states, shape (T, ...)."""
    trail_memory: list[np.ndarray]
    """What is remembered with them, shape (T, ...)."""

    def save(self, path: Path) -> None:
        """Write a file, whole or not at all; its folder is made."""
        save_arrays(self, path)

    @staticmethod
    def load(path: Path) -> Halt | None:
        """Read a file of :meth:`save`; None if it is missing or cannot be read."""
        halt = load_arrays(path)
        return halt if isinstance(halt, Halt) else None


def halt_of(drive: Drive, patient: int) -> Halt:
    """Return what is needed to go on in a patient of a drive."""
    worlds = torch.nonzero(drive.pool.owner == patient)[:, 0]
    route, places = drive.routes[patient], drive.trail.places[patient]
    names, kept = drive.scene.sim.world_arrays(), drive.memory()
    trail = {name: torch.stack([place.state[name] for place in places]) for name in names if places}
    passed = [torch.stack([place.memory[k] for place in places]) for k in range(len(kept)) if places]
    return Halt(
        fingerprint=fingerprint(drive.scene.sim, patient),
        arc=route.arc,
        time=route.time,
        entries=dict(route.entries),
        states={name: dict(state.arrays) for name, state in route.states.items()},
        worlds=_off({name: array[worlds] for name, array in names.items()}),
        memory=[array[worlds].cpu().numpy() for array in kept],
        settings=_off({name: getattr(drive.expert, name)[worlds] for name in drive.expert.VARIED}),
        trail=[place.arc for place in places],
        trail_states=_off(trail),
        trail_memory=[array.cpu().numpy() for array in passed],
    )


def go_on(drive: Drive, patient: int, halt: Halt) -> None:
    """Put the worlds of a patient where another drive was cut off, before :meth:`Drive.run`.

    With more worlds than it had, some begin in the same state, with settings of their own.

    Raises:
        ValueError: If it belongs to another patient or scope.
    """
    scene, route, device = drive.scene, drive.routes[patient], drive.scene.device
    if halt.fingerprint != fingerprint(scene.sim, patient):
        name = scene.colon.patients[patient].name
        raise ValueError(f"The drive that was cut off is not of {name} with {scene.endoscope.path.name}.")
    worlds = torch.nonzero(drive.pool.owner == patient)[:, 0]
    source = np.arange(len(worlds)) % len(halt.memory[0])
    scene.sim.write_state(_on(device, {name: array[source] for name, array in halt.worlds.items()}), worlds)
    scene.sim.forward()
    _fill(drive.memory(), (array[source] for array in halt.memory), worlds)
    own = worlds[: len(halt.memory[0])]
    settings = {name: array[: len(own)] for name, array in halt.settings.items()}
    _fill([getattr(drive.expert, name) for name in settings], settings.values(), own)
    drive.trail.places[patient] = [_place(device, halt, k) for k in range(len(halt.trail))]
    route.entries = dict(halt.entries)
    route.states = {name: Snapshot(arrays) for name, arrays in halt.states.items()}
    route.before = halt.time
    route.advance(halt.arc, 0.0)


def _place(device: str, halt: Halt, k: int) -> Place:
    """Return a state on the way of the foremost."""
    state = _on(device, {name: array[k] for name, array in halt.trail_states.items()})
    return Place(halt.trail[k], state, [_tensor(device, array[k]) for array in halt.trail_memory])


def _fill(arrays: Iterable[torch.Tensor], values: Iterable[np.ndarray], worlds: torch.Tensor) -> None:
    """Write values of some worlds into arrays of all."""
    for array, value in zip(arrays, values, strict=True):
        array[worlds] = _tensor(array.device, value).to(array.dtype)


def _on(device: str, arrays: Mapping[str, np.ndarray]) -> dict[str, torch.Tensor]:
    return {name: _tensor(device, array) for name, array in arrays.items()}


def _off(tensors: Mapping[str, torch.Tensor]) -> dict[str, np.ndarray]:
    return {name: tensor.cpu().numpy() for name, tensor in tensors.items()}


def _tensor(device: str | torch.device, array: np.ndarray) -> torch.Tensor:
    return torch.from_numpy(np.array(array)).to(device)
