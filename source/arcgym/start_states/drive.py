# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Scripted experts drive a robot up the colons of a scene, and the states at the start of each segment are kept."""

from __future__ import annotations

from collections.abc import Callable

import torch

from arcgym.experts import make_expert
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.sim import Snapshot, SnapshotSet
from arcgym.sim.snapshot import fingerprint
from arcgym.start_states.leaps import Leaps
from arcgym.start_states.route import Peaks, Route, what_holds
from arcgym.start_states.settling import CONTROL_STEP, settle
from arcgym.start_states.trail import Trail
from arcgym.start_states.world_pool import WorldPool
from arcgym.utils.threads import one_thread

OUT_OF_PLACE = -1.0
"""Arc length that a world has whose state is broken or behind the wall [m]."""


class Drive:
    """Drives all worlds of a scene; in each patient the first world that enters a segment gives its start state.

    The first segment starts from the rest pose. With several worlds a patient they differ in their settings, and every
    few seconds those that fall behind go on from where the foremost are. Worlds whose scope is behind the wall, or got
    through it into another loop, do not count. The states are kept once their forces have settled without commands,
    with velocities of zero.
    """

    def __init__(
        self,
        scene: InteractiveScene,
        speed: float = 0.04,
        patience: float = 30.0,
        max_time: float = 180.0,
        seed: int = 0,
    ):
        """Set up the expert.

        Args:
            scene: Scene at rest, with as many worlds for each of its patients.
            speed: Speed of the first world's expert [m/s].
            patience: Time without progress after which the drive gives up a patient [s].
            max_time: Time after which it gives up anyway [s].
            seed: Seed of the settings of the other worlds.

        Raises:
            ValueError: If the robot has no expert, or the worlds cannot be shared out evenly.
        """
        self.scene, self.patience, self.max_time = scene, patience, max_time
        self.routes = [Route(dict(patient.bounds)) for patient in scene.colon.patients]
        """How far it has come in each patient."""
        self.foremost = list(range(len(self.routes)))
        """World of each patient whose tip is foremost."""
        self.time = 0.0
        """Simulated time [s]."""
        self.expert = make_expert(scene, speed=speed)
        self.pool = WorldPool(scene, self.expert, seed)
        self._peaks = Peaks(scene)
        self._leaps = Leaps(scene["endoscope"].data.tip_arc_length)
        self.trail = Trail(scene.sim, len(self.routes), self.memory)
        """States on the way of each patient's foremost world."""
        self._steps = round(CONTROL_STEP / scene.sim.physics_dt)
        self._count = 0
        self._settled: set[tuple[int, str]] = set()

    @property
    def bounds(self) -> dict[str, tuple[float, float]]:
        """Arc length at start and end of each segment of the first patient [m]."""
        return self.routes[0].bounds

    @property
    def states(self) -> dict[str, Snapshot]:
        """State at the start of each segment of the first patient passed so far."""
        return self.routes[0].states

    @property
    def arc(self) -> float:
        """Largest arc length of a tip in the first patient [m]."""
        return self.routes[0].arc

    @property
    def problem(self) -> str:
        """Why the drive ended early in the first patient, and what held it; empty while it has not."""
        return self.routes[0].failure

    def run(self, until: str, report: Callable[[Drive], None] = lambda drive: None, *, settled: bool = True) -> bool:
        """Drive until the start state of a segment is there in all patients, or nothing gets on.

        Args:
            until: The segment; in a patient without it the last one.
            report: Called after every control step.
            settled: Whether to let the states settle, which takes time; else they are as the drive passed.

        Returns:
            Whether it arrived in all; otherwise :attr:`Route.problem` says why not.
        """
        with torch.inference_mode(), one_thread():
            for patient, route in enumerate(self.routes):
                route.until = until if until in route.bounds else list(route.bounds)[-1]
                if not route.entries:
                    self._enter(route, next(iter(route.bounds)), patient)
            while any(route.running for route in self.routes):
                self._step()
                report(self)
            if settled:
                self._settle()
        return all(route.until in route.entries for route in self.routes)

    def snapshots(self, about: dict[str, object], patient: int = 0) -> SnapshotSet:
        """Return the states kept so far of a patient, with what the file shall say about them."""
        states = self.routes[patient].states
        empty = tuple(state.to_be_filled() for state in states.values())
        return SnapshotSet(tuple(states), empty, fingerprint(self.scene.sim, patient), about)

    def _step(self) -> None:
        self.pool.disturb()
        self.expert.act()
        self.scene.sim.step(self._steps)
        self._count += 1
        self.time = self._count * CONTROL_STEP
        self._peaks.update()
        arcs = self._arcs()
        front = self.pool.foremost(arcs)
        broken = self._all_broken()
        places = zip(self.routes, arcs[front].tolist(), front.tolist(), broken.tolist(), strict=True)
        for patient, (route, arc, world, lost) in enumerate(places):
            if route.running:
                self.foremost[patient] = world
                route.problem = "the simulation broke" if lost else ""
                self._follow(patient, arc, world)
        if self.scene.num_envs > 1 and self._count % self.expert.PERIOD == 0:
            merit = torch.where(arcs == OUT_OF_PLACE, OUT_OF_PLACE, self.expert.merit())
            self._carry_over(*self.pool.exchange(merit, arcs))
            self._try_again(arcs)
            ended = [patient for patient, route in enumerate(self.routes) if not route.running]
            if 0 < len(ended) < len(self.routes):
                self._carry_over(*self.pool.hand_over(ended, merit))

    def _carry_over(self, moved: torch.Tensor, sources: torch.Tensor) -> None:
        """Let worlds that took over the states of others remember what those have met."""
        self._peaks.take_over(moved, sources)
        self._leaps.take_over(moved, sources)

    def _try_again(self, arcs: torch.Tensor) -> None:
        """Let some worlds go on from farther back where the foremost is stuck."""
        worlds, back = self.pool.tries_again(arcs)
        owner = self.pool.owner[worlds]
        least = (arcs[self.pool.foremost(arcs)][owner] - back).tolist()
        draws = torch.rand(len(worlds), generator=self.pool.random, device=self.scene.device).tolist()
        self.trail.put_back(worlds.tolist(), owner.tolist(), least, draws)

    def memory(self) -> list[torch.Tensor]:
        """Return what is remembered of every world beside its state, tensors of shape (N, ...)."""
        return [*self.expert.memory(), *self._peaks.memory, *self._leaps.memory]

    def _all_broken(self) -> torch.Tensor:
        """Return the patients in all of whose worlds the simulation broke, shape (P,), bool."""
        owner = self.pool.owner
        whole = torch.zeros(len(self.routes), dtype=torch.int32, device=owner.device)
        return whole.index_add_(0, owner, (~self.scene.sim.non_finite).int()) == 0

    def _arcs(self) -> torch.Tensor:
        """Return the arc lengths of the tips of worlds that count [m], shape (N,)."""
        arc, misplaced = self.scene["endoscope"].data.tip_arc_length, self._misplaced()
        return torch.where(misplaced | self._leaps.update(arc, ~misplaced), OUT_OF_PLACE, arc)

    def _misplaced(self) -> torch.Tensor:
        """Return the worlds that do not count, shape (N,), bool."""
        sim = self.scene.sim
        return sim.non_finite | sim.wall_penetrated if sim.cfg.solver == "two_level" else sim.non_finite

    def _follow(self, patient: int, arc: float, world: int) -> None:
        """Take note of a patient's foremost world."""
        route = self.routes[patient]
        if self.scene.num_envs > 1 and arc > OUT_OF_PLACE:
            self.trail.follow(patient, arc, world)
        for segment in route.advance(arc, self.time):
            self._enter(route, segment, world)
        if route.running:
            route.watch(self.patience, self.max_time)
            if route.problem:
                route.held_by = what_holds(self.scene, world)

    def _enter(self, route: Route, segment: str, world: int) -> None:
        route.entries[segment] = self._peaks.entry(world, route.time)
        route.states[segment] = self.scene.sim.read_snapshot(world)

    def _settle(self) -> None:
        """Let the states settle that have not."""
        kept = [(patient, name) for patient, route in enumerate(self.routes) for name in route.states]
        fresh = [key for key in kept if key not in self._settled]
        raw = [(patient, self.routes[patient].states[name]) for patient, name in fresh]
        for (patient, name), state in zip(fresh, settle(self.scene, raw), strict=True):
            self.routes[patient].states[name] = state
        self._settled |= set(fresh)
