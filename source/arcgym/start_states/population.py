# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Worlds of one patient that work together: those that fall behind go on from where the foremost are."""

from __future__ import annotations

import torch

from arcgym.experts import ExpertBase
from arcgym.scene.interactive_scene import InteractiveScene

MEMORY = 0.85
"""Share of the disturbance that is left after a control step: it lasts about 0.7 s."""
DISTURBANCE = 0.25
"""Size of what is added to the disturbance in a control step."""
FRONT = 4
"""One of so many worlds of a patient is followed."""
BEHIND = 2
"""One of so many worlds of a patient is moved, if it is behind."""
NEAR = 0.03
"""Arc length by which a world may be behind the foremost and still go its own way, with new settings [m]."""
ON = 0.01
"""Way that the foremost has to get on between two exchanges, or it counts as stuck [m]."""
STUCK = 0.1
"""The same, from which worlds that stand beside the foremost go on from a state farther back [m]."""
MOST_NEAR = 0.35
"""Largest arc length by which a world may be behind, after many exchanges in which the foremost was stuck [m]."""


class Population:
    """The worlds of each patient: N worlds, P patients, W = N / P worlds of each. World ``n`` has patient ``n % P``.

    The first of each patient's worlds keeps the expert's own settings and no disturbance until it falls behind.
    """

    def __init__(self, scene: InteractiveScene, expert: ExpertBase, seed: int = 0):
        """Draw the settings.

        Args:
            scene: The scene.
            expert: Its expert.
            seed: Seed of settings, disturbances and of who takes over from whom.

        Raises:
            ValueError: If the worlds cannot be shared out evenly.
        """
        self.scene, self.expert = scene, expert
        self.patients = len(scene.colon.patients)
        self.each = scene.num_envs // self.patients
        if self.each * self.patients != scene.num_envs:
            raise ValueError(f"{scene.num_envs} worlds cannot be shared out evenly among {self.patients} patients.")
        self.random = torch.Generator(scene.device).manual_seed(seed)
        worlds = torch.arange(scene.num_envs, device=scene.device)
        expert.vary(worlds[self.patients :], self.random)
        self._plain = worlds < self.patients
        self._farthest = torch.zeros(self.patients, device=scene.device)
        self._near = torch.full_like(self._farthest, NEAR)

    def disturb(self) -> None:
        """Let the disturbances drift on by a control step."""
        noise = torch.randn(self.expert.disturbance.shape, generator=self.random, device=self.scene.device)
        drift = MEMORY * self.expert.disturbance + DISTURBANCE * noise
        self.expert.disturbance.copy_(torch.where(self._plain[:, None], 0.0, drift))

    def exchange(self, score: torch.Tensor, arc: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Let the rear half of each patient's worlds take over the states of the foremost, with new settings.

        Those whose tips are hardly behind keep their states: what gets a tip on may begin with a step back, or with
        scope that goes into loops. The longer the foremost is stuck, the farther back the others may go to try again.

        Args:
            score: Higher is better, shape (N,).
            arc: Arc lengths of the tips [m], shape (N,).

        Returns:
            The worlds that were moved and those whose states they took, int64, shape (n,).
        """
        of_patient = score.view(self.each, self.patients)
        order = of_patient.argsort(dim=0, descending=True)
        front, rear = order[: max(1, self.each // FRONT)], order[self.each - self.each // BEHIND :]
        pick = torch.randint(len(front), rear.shape, generator=self.random, device=self.scene.device)
        number = torch.arange(self.patients, device=self.scene.device)
        moved, sources = ((rows * self.patients + number).flatten() for rows in (rear, front.gather(0, pick)))
        farthest = arc.view(self.each, self.patients).amax(dim=0)
        self._wait(farthest)
        behind = arc[moved] < (farthest - self._near)[moved % self.patients]
        self._renew(moved[~behind])
        moved, sources = moved[behind], sources[behind]
        if len(moved):
            self._move(moved, sources)
        return moved, sources

    def tries_again(self, arc: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Return worlds that stand where their foremost has been stuck for a while, with new settings.

        Half of those that do and are not of the foremost quarter, drawn at random: they may go on from a state farther
        back.

        Args:
            arc: Arc lengths of the tips [m], shape (N,).

        Returns:
            The worlds, int64, shape (n,), and how far back each may go [m], shape (n,).
        """
        order = arc.view(self.each, self.patients).argsort(dim=0, descending=True)[max(1, self.each // FRONT) :]
        worlds = (order * self.patients + torch.arange(self.patients, device=self.scene.device)).flatten()
        patient = worlds % self.patients
        stuck = (self._near > STUCK)[patient] & (arc[worlds] > (self._farthest - NEAR)[patient])
        draw = torch.rand(len(worlds), generator=self.random, device=self.scene.device) < 0.5
        worlds = worlds[stuck & draw]
        self._renew(worlds)
        return worlds, self._near[worlds % self.patients]

    def _wait(self, farthest: torch.Tensor) -> None:
        """Take note of the arc lengths of the foremost tips [m], shape (P,), and of whether they got on."""
        on = farthest > self._farthest + ON
        self._farthest = torch.where(on, farthest, self._farthest)
        self._near = torch.where(on, NEAR, (self._near + NEAR).clamp(max=MOST_NEAR))

    def _move(self, moved: torch.Tensor, sources: torch.Tensor) -> None:
        sim = self.scene.sim
        sim.write_state({name: array[sources] for name, array in sim.world_arrays().items()}, moved)
        sim.forward()
        self.expert.take_over(moved, sources)
        self._renew(moved)

    def _renew(self, worlds: torch.Tensor) -> None:
        """Give worlds new settings."""
        self.expert.vary(worlds, self.random)
        self.expert.disturbance[worlds] = 0.0
        self._plain[worlds] = False
