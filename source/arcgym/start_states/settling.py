# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""States without commands: worlds are left alone until their forces no longer change."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import torch

from arcgym.experts.expert_base import CONTROL_STEP
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.sim import Snapshot
from arcgym.sim.snapshot_library import with_room

SETTLING = 1.0
"""Time without commands before a state is kept, at least, and between two looks at its forces [s]."""
LONGEST_SETTLING = 10.0
"""Time after which it is kept though its forces still change [s]."""
STEADY = 0.01, 0.01
"""Change of forces between two looks that counts as none: as a share, and in newtons."""
ALONE = 3.0
"""Time without commands over which a kept state is judged [s]."""
LEAST = 0.1
"""Force below which changes are compared with it [N]."""


def settle(scene: InteractiveScene, states: Sequence[tuple[int, Snapshot]]) -> list[Snapshot]:
    """Return states after a while without commands, at rest; the scene's own state is left as it is.

    Args:
        scene: Scene; its worlds are used, as many states at a time.
        states: Patient and state of each.
    """
    sim, colon = scene.sim, scene.colon
    now = {name: array.clone() for name, array in sim.world_arrays().items()}
    owner = colon.data.patient.clone()
    settled: list[Snapshot | None] = [None] * len(states)
    for first in range(0, len(states), scene.num_envs):
        some = states[first : first + scene.num_envs]
        _put(scene, some)
        for world, state in _until_steady(scene, range(len(some))):
            settled[first + world] = state.at_rest()
    if len(colon.patients) > 1:
        colon.write_patient_to_sim(owner)
    sim.write_state(now)
    sim.forward()
    return [state for state in settled if state is not None]


def left_alone(scene: InteractiveScene, states: Sequence[tuple[int, Snapshot]]) -> np.ndarray:
    """Return the forces on the scopes while worlds are left alone in states, one world a state.

    Args:
        scene: Scene with as many worlds as states, or more.
        states: Patient and state of each, N of them.

    Returns:
        Largest force on a window and push on the base after every control step [N], float64, shape (T, N, 2).
    """
    _put(scene, states)
    return forces_alone(scene)[:, : len(states)]


def forces_alone(scene: InteractiveScene) -> np.ndarray:
    """Return the same of all worlds from where they are, shape (T, N, 2)."""
    control = round(CONTROL_STEP / scene.sim.physics_dt)
    forces = []
    for _ in range(round(ALONE / CONTROL_STEP)):
        scene.sim.step(control)
        forces.append(_forces(scene).cpu().numpy())
    return np.array(forces, dtype=float)


def changes(forces: np.ndarray) -> np.ndarray:
    """Return how far forces [N] of :func:`left_alone` are from the first ones, as shares, shape (T, N, 2)."""
    return np.abs(forces - forces[0]) / np.maximum(forces[0], LEAST)


def _put(scene: InteractiveScene, states: Sequence[tuple[int, Snapshot]]) -> None:
    """Put the first worlds into states, each of a patient."""
    sim, colon, device = scene.sim, scene.colon, scene.device
    worlds = list(range(len(states)))
    if len(colon.patients) > 1:
        colon.write_patient_to_sim(torch.tensor([patient for patient, _ in states], device=device), worlds)
    own = sim.read_snapshot(0)
    rows = [with_room(state, own).arrays for _, state in states]
    arrays = {name: np.stack([row[name] for row in rows]) for name in own.arrays}
    sim.write_state({name: torch.from_numpy(array).to(device) for name, array in arrays.items()}, worlds)
    sim.forward()


def _until_steady(scene: InteractiveScene, worlds: Sequence[int]) -> Iterator[tuple[int, Snapshot]]:
    """Yield each world's state once its largest force on a window and the push on its base stay the same."""
    sim, (share, least) = scene.sim, STEADY
    control = round(CONTROL_STEP / sim.physics_dt)
    steps = round(SETTLING / sim.physics_dt) - control
    waiting, before = list(worlds), _forces(scene)
    for look in range(round(LONGEST_SETTLING / SETTLING)):
        sim.step(steps)
        sim.step(control)
        now = _forces(scene)
        steady = ((now - before).abs() <= share * now + least).all(dim=1).cpu()
        last = look == round(LONGEST_SETTLING / SETTLING) - 1
        for world in [world for world in waiting if last or steady[world]]:
            waiting.remove(world)
            yield world, sim.read_snapshot(world)
        if not waiting:
            return
        before = now


def _forces(scene: InteractiveScene) -> torch.Tensor:
    """Return the largest force on a window and the push on the base, means over a control step [N], shape (N, 2)."""
    data = scene["endoscope"].data
    return torch.stack([data.window_force_norm.amax(dim=1), data.base_force.abs()], dim=1)
