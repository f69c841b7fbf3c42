# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Counts, on the device, what goes wrong in the steps of a soak."""

from __future__ import annotations

from typing import Any

import torch
import warp as wp

from arcgym.benchmarks.fidelity.brute_force import ContactSample, sample_contacts
from arcgym.benchmarks.lumen import LumenCheck
from arcgym.benchmarks.soak.adversaries import KINDS
from arcgym.benchmarks.soak.isolation import ResetGuard, leaves
from arcgym.benchmarks.soak.journal import Tally
from arcgym.benchmarks.soak.piercing import Piercing

LUMEN_EVERY = 10
"""Control steps between two searches for links outside the lumen."""
CONTACTS_EVERY = 10
"""Control steps between two comparisons of contacts with all pairs of a link and a face."""
FORCES = ("link_force_w", "link_force_peak", "window_force_w", "window_force_peak", "base_force", "tip_pull_force_w")
"""Forces in the endoscope's data."""
LOADS = ("wall_strain_peak", "anchor_tension_peak")
"""Strains and forces in the colon's data."""


class Watch:
    """Looks at every step; the counters stay on the device until they are read."""

    def __init__(self, env: Any, kind: torch.Tensor) -> None:
        """Start at zero.

        Args:
            env: The environment.
            kind: Kind of each world's actions, index into ``KINDS``, shape (N,).
        """
        self.guard = ResetGuard(env)
        self.guard.before = self._before_reset
        self._env, self._kind = env, kind
        self._lumen, self._piercing = LumenCheck(env.sim), Piercing(env)
        self._step = 0
        self._failures_read = env.world_failures
        self._dropped_read = int(env.sim.dropped_contacts.sum())
        self._clear()

    def _clear(self) -> None:
        def zero() -> torch.Tensor:
            return torch.zeros((), dtype=torch.long, device=self._env.device)

        self._since = self._step
        self._not_finite: dict[str, torch.Tensor] = {}
        self._largest: dict[str, torch.Tensor] = {}
        self._outside, self._examined = zero(), zero()
        self._piercing.clear()
        self._samples = list[ContactSample]()
        never = torch.full((self._env.num_envs,), -1, dtype=torch.long, device=self._env.device)
        self._last = {what: never.clone() for what in ("recovered", "outside", "pierced_lightly")}
        self.guard.resets, self.guard.disturbed = zero(), zero()

    def look(self, obs: Any, reward: torch.Tensor, terminated: torch.Tensor, extras: dict[str, Any]) -> None:
        """Take in what ``env.step`` returned, and the state that it left."""
        self._step += 1
        self._last["recovered"][self._env.failed] = self._step
        self._last["pierced_lightly"][self._piercing.look()] = self._step
        self._count_not_finite(obs, reward, extras)
        self._note_largest()
        if self._step % LUMEN_EVERY == 0:
            outside, examined = self._lumen.outside()
            self._last["outside"][outside.any(dim=1)] = self._step
            self._outside += outside.sum()
            self._examined += examined.sum()
        if self._step % CONTACTS_EVERY == 0:
            self._samples += sample_contacts(self._env.sim, self._worlds_to_sample())

    def _before_reset(self) -> None:
        """Take in what a reset is about to clear."""
        self._note_largest()
        self._piercing.before_reset()

    def _worlds_to_sample(self) -> set[int]:
        """Return the world with the most contacts, and one after the other of all."""
        counts = wp.to_torch(self._env.sim.contact.records.start)[:, -1]
        return {int(counts.argmax()), self._step // CONTACTS_EVERY % self._env.num_envs}

    def _count_not_finite(self, obs: Any, reward: torch.Tensor, extras: dict[str, Any]) -> None:
        data, colon = self._env.scene["endoscope"].data, self._env.scene["colon"].data
        returned = leaves("obs", obs) | leaves("extras", {key: extras[key] for key in ("cost", "costs")})
        state = leaves("state", self._env.sim.world_arrays())
        force = {f"force/{name}": getattr(data, name) for name in FORCES}
        force |= {f"force/{name}": getattr(colon, name) for name in LOADS}
        for name, value in {**returned, "reward": reward, **state, **force}.items():
            worlds = (~torch.isfinite(value)).reshape(len(value), -1).any(dim=1).sum()
            self._not_finite[name] = self._not_finite.get(name, 0) + worlds

    def _note_largest(self) -> None:
        data, colon = self._env.scene["endoscope"].data, self._env.scene["colon"].data
        found = {
            "tip_force": data.tip_force_peak,
            "shaft_force": data.window_force_peak.amax(dim=1),
            "base_force": data.base_force.abs(),
            "tip_pull": data.tip_pull_force_w.norm(dim=1),
            "wall_displacement": colon.nodal_displacement.amax(dim=1),
            **{name.removesuffix("_peak"): getattr(colon, name).amax(dim=1) for name in LOADS},
            "link_speed": data.body_lin_vel_w.norm(dim=2).amax(dim=1),
        }
        for name, value in found.items():
            largest = self._largest.setdefault(name, torch.zeros(len(KINDS), device=value.device))
            largest.scatter_reduce_(0, self._kind, value.nan_to_num(0.0), "amax")

    def read(self, seconds: float) -> tuple[Tally, list[dict[str, Any]]]:
        """Return the findings since the last call, and the events with all that finds them again; wait for the device.

        Args:
            seconds: Time that the steps took [s].
        """
        failures = self._env.world_failures
        dropped = int(self._env.sim.dropped_contacts.sum())
        tally = Tally(
            env_steps=(self._step - self._since) * self._env.num_envs,
            seconds=seconds,
            resets=int(self.guard.resets),
            recovered_worlds=failures - self._failures_read,
            disturbed_worlds=int(self.guard.disturbed),
            pierced=int(self._piercing.ends),
            pierced_lightly=int(self._piercing.light_ends),
            outside_links=int(self._outside),
            examined_links=int(self._examined),
            dropped_contacts=dropped - self._dropped_read,
            missed_contacts=sum(int(sample.missed.sum()) for sample in self._samples),
            touching_pairs=sum(len(sample.missed) for sample in self._samples),
            contact_samples=len(self._samples),
            not_finite={name: int(count) for name, count in self._not_finite.items() if int(count)},
            largest={
                name: dict(zip(KINDS[: self._env.num_envs], values.tolist(), strict=False))
                for name, values in self._largest.items()
            },
        )
        events = self._events()
        self._failures_read, self._dropped_read = failures, dropped
        self._clear()
        return tally, events

    def _events(self) -> list[dict[str, Any]]:
        """Return the last time that each of these was found in each world: what, world, step and kind of action."""
        events = []
        for what, last in self._last.items():
            for world in (last >= 0).nonzero().flatten().tolist():
                action = KINDS[int(self._kind[world])]
                events.append({"what": what, "world": world, "step": int(last[world]), "action": action})
        return events
