# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Worlds of one patient that work together: those that fall behind go on from where the foremost are."""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple

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
"""Arc length by which a world may be behind the foremost and still go its own way [m]."""
RENEWED = 0.25
"""Share of the worlds that go their own way in the rear half which get new settings at an exchange: a setting lasts for
about four exchanges, 10 to 16 s, as what frees a scope may take that long."""
PLAIN = 0.5
"""Share of the worlds with new settings that take the expert's own, without disturbance, but for what frees a scope."""
ON = 0.01
"""Way that the foremost has to get on between two exchanges, or it counts as stuck [m]."""
STUCK = 0.1
"""From this arc length behind on, worlds that stand beside the foremost go on from a state farther back [m]."""
MOST_NEAR = 0.35
"""Largest arc length by which a world may be behind, after many exchanges in which the foremost was stuck [m]."""


class Ranking(NamedTuple):
    """The worlds, N of them, patient by patient, and within each the best first; P patients."""

    order: torch.Tensor
    """The worlds in that order, int64, shape (N,)."""
    first: torch.Tensor
    """Place of each patient's best world in it, int64, shape (P,); any of a patient without worlds."""
    place: torch.Tensor
    """Place of each world among those of its patient, from 0, shape (N,)."""
    counts: torch.Tensor
    """Worlds of each patient, shape (P,)."""


class WorldPool:
    """The worlds of each patient: N worlds, P patients, at first N / P worlds of each: world ``n`` has ``n % P``.

    The first of each patient's worlds keeps the expert's own settings and no disturbance until it falls behind. Of the
    others half draw all settings and are disturbed, half draw only how they turn the scope.
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
        if scene.num_envs % self.patients:
            raise ValueError(f"{scene.num_envs} worlds cannot be shared out evenly among {self.patients} patients.")
        self.random = torch.Generator(scene.device).manual_seed(seed)
        worlds = torch.arange(scene.num_envs, device=scene.device)
        self.owner = worlds % self.patients
        """Patient of each world, int64, shape (N,)."""
        self._plain = worlds < self.patients
        self._renew(worlds[self.patients :])
        self._farthest = torch.zeros(self.patients, device=scene.device)
        self._near = torch.full_like(self._farthest, NEAR)

    def disturb(self) -> None:
        """Let the disturbances drift on by a control step."""
        noise = torch.randn(self.expert.disturbance.shape, generator=self.random, device=self.scene.device)
        drift = MEMORY * self.expert.disturbance + DISTURBANCE * noise
        self.expert.disturbance.copy_(torch.where(self._plain[:, None], 0.0, drift))

    def rank(self, score: torch.Tensor) -> Ranking:
        """Order the worlds of each patient by a score, shape (N,), the highest first."""
        best = score.argsort(descending=True, stable=True)
        order = best[self.owner[best].argsort(stable=True)]
        count = torch.bincount(self.owner, minlength=self.patients)
        first = count.cumsum(0) - count
        place = torch.empty_like(order)
        place[order] = torch.arange(len(order), device=order.device) - first[self.owner[order]]
        return Ranking(order, first.clamp(max=len(order) - 1), place, count)

    def foremost(self, arc: torch.Tensor) -> torch.Tensor:
        """Return the world of each patient whose tip is foremost, int64, shape (P,); any where it has no world.

        Args:
            arc: Arc lengths of the tips [m], shape (N,).
        """
        ranking = self.rank(arc)
        return ranking.order[ranking.first]

    def exchange(self, score: torch.Tensor, arc: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Let the rear half of each patient's worlds take over the states of the foremost, with new settings.

        Those whose tips are hardly behind keep their states, and most of them their settings: what gets a tip on may
        begin with a step back, or with scope that goes into loops. The longer the foremost is stuck, the farther back
        the others may go to try again.

        Args:
            score: Higher is better, shape (N,).
            arc: Arc lengths of the tips [m], shape (N,).

        Returns:
            The worlds that were moved and those whose states they took, int64, shape (n,).
        """
        ranking = self.rank(score)
        moved = ranking.order[self._of_rear(ranking)]
        farthest = arc[self.foremost(arc)]
        self._wait(farthest)
        behind = arc[moved] < (farthest - self._near)[self.owner[moved]]
        near = moved[~behind]
        self._renew(near[self._draw(len(near)) < RENEWED])
        moved = moved[behind]
        sources = self._leaders(ranking, self.owner[moved])
        if len(moved):
            self._move(moved, sources)
        return moved, sources

    def hand_over(self, ended: Collection[int], score: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Give the worlds of patients that need none any more to the others, who take over states of their foremost.

        Each world goes to a patient that has the fewest by then; of several to the one that has been stuck longest.

        Args:
            ended: The patients that need none.
            score: Higher is better, shape (N,).

        Returns:
            The worlds that were moved and those whose states they took, int64, shape (n,).
        """
        ranking, near = self.rank(score), self._near.tolist()
        count = ranking.counts.tolist()
        done = set(ended)
        free = [world for world, patient in enumerate(self.owner.tolist()) if patient in done]
        left = [patient for patient in range(self.patients) if patient not in done and count[patient]]
        takers = []
        for _ in free if left else ():
            taker = min(left, key=lambda patient: (count[patient], -near[patient]))
            count[taker] += 1
            takers.append(taker)
        moved = torch.tensor(free[: len(takers)], dtype=torch.long, device=self.scene.device)
        patients = torch.tensor(takers, dtype=torch.long, device=self.scene.device)
        sources = self._leaders(ranking, patients)
        if len(moved):
            self.owner[moved] = patients
            self.scene.colon.write_patient_to_sim(patients, moved)
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
        ranking = self.rank(arc)
        worlds = ranking.order[(ranking.place >= self._in_front(ranking)[self.owner])[ranking.order]]
        patient = self.owner[worlds]
        stuck = (self._near > STUCK)[patient] & (arc[worlds] > (self._farthest - NEAR)[patient])
        worlds = worlds[stuck & (self._draw(len(worlds)) < 0.5)]
        self._renew(worlds)
        return worlds, self._near[self.owner[worlds]]

    def _of_rear(self, ranking: Ranking) -> torch.Tensor:
        """Return which places of a ranking are of the rear half of a patient's worlds, shape (N,), bool."""
        return (ranking.place >= (ranking.counts - ranking.counts // BEHIND)[self.owner])[ranking.order]

    def _in_front(self, ranking: Ranking) -> torch.Tensor:
        """Return how many worlds of each patient are followed, shape (P,)."""
        return (ranking.counts // FRONT).clamp(min=1)

    def _leaders(self, ranking: Ranking, patients: torch.Tensor) -> torch.Tensor:
        """Return one of the foremost worlds for each of some patients, drawn at random, both int64, shape (n,)."""
        pick = (self._draw(len(patients)) * self._in_front(ranking)[patients]).long()
        return ranking.order[ranking.first[patients] + pick]

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
        plain = self._draw(len(worlds)) < PLAIN
        self.expert.vary(worlds, self.random, plain)
        self.expert.disturbance[worlds] = 0.0
        self._plain[worlds] = plain

    def _draw(self, count: int) -> torch.Tensor:
        """Draw numbers from [0, 1), shape (count,)."""
        return torch.rand(count, generator=self.random, device=self.scene.device)
