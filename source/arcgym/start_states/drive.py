# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A scripted expert drives a robot up the colon, and its state at the start of each segment is kept."""

from __future__ import annotations

from collections.abc import Callable

import torch

from arcgym.experts import make_expert
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.sim import Snapshot, SnapshotSet
from arcgym.sim.snapshot import fingerprint
from arcgym.utils.threads import one_thread

CONTROL_STEP = 0.1
"""Time between two decisions of the expert [s]."""
SETTLING = 1.0
"""Time without commands before a state is kept, at least, and between two looks at its forces [s]."""
LONGEST_SETTLING = 10.0
"""Time after which it is kept though its forces still change [s]."""
STEADY = 0.01, 0.01
"""Change of forces between two looks that counts as none: as a share, and in newtons."""
GAIN = 0.005
"""Way within the patience below that counts as progress [m]."""


class Drive:
    """Drives all worlds of a scene; the first world that enters a segment gives its start state.

    The first segment starts from the rest pose. Whenever a tip enters another one, the complete state is kept once its
    forces have settled without commands, with velocities of zero; the drive then goes on from before.
    """

    def __init__(self, scene: InteractiveScene, speed: float = 0.04, patience: float = 20.0, max_time: float = 180.0):
        """Set up the expert.

        Args:
            scene: Scene at rest, usually one world.
            speed: Speed of the expert [m/s].
            patience: Time without progress after which the drive gives up [s].
            max_time: Time after which it gives up anyway [s].

        Raises:
            ValueError: If the robot has no expert.
        """
        self.scene, self.patience, self.max_time = scene, patience, max_time
        self.bounds = scene["colon"].stage.segment_bounds()
        self.states: dict[str, Snapshot] = {}
        """State at the start of each segment passed so far."""
        self.time = 0.0
        """Simulated time [s]."""
        self.arc = 0.0
        """Largest arc length of a tip [m]."""
        self.problem = ""
        """Why the drive ended early; empty while it has not."""
        self.expert = make_expert(scene, speed=speed)
        self._steps = round(CONTROL_STEP / scene.sim.physics_dt)
        self._progress = (0.0, 0.0)

    def run(self, until: str, report: Callable[[Drive], None] = lambda drive: None) -> bool:
        """Drive until the start state of a segment is there.

        Args:
            until: The segment.
            report: Called after every control step.

        Returns:
            Whether it arrived; otherwise :attr:`problem` says why not.
        """
        with torch.inference_mode(), one_thread():
            self._keep(next(iter(self.bounds)), world=0)
            while until not in self.states and not self.problem:
                self._step()
                report(self)
        return until in self.states

    def snapshots(self, about: dict[str, object]) -> SnapshotSet:
        """Return the states kept so far, with what the file shall say about them."""
        return SnapshotSet(tuple(self.states), tuple(self.states.values()), fingerprint(self.scene.sim), about)

    def _step(self) -> None:
        self.expert.act()
        self.scene.sim.step(self._steps)
        self.time += CONTROL_STEP
        arcs = self.scene["endoscope"].data.tip_arc_length
        broken = self.scene.sim.non_finite
        if bool(broken.all()):
            self.problem = "the simulation broke"
            return
        ahead = torch.where(broken, -1.0, arcs)
        world = int(ahead.argmax())
        arc = float(ahead[world])
        self.arc = max(self.arc, arc)
        for segment, (start, _) in self.bounds.items():
            if arc > start and segment not in self.states:
                self._keep(segment, world)
        self._watch()

    def _watch(self) -> None:
        """Give up where the tip no longer gets on."""
        reached, since = self._progress
        if self.arc > reached + GAIN:
            self._progress = (self.arc, self.time)
        elif self.time - since > self.patience:
            self.problem = f"no progress in {self.patience:g} s"
        if self.time > self.max_time:
            self.problem = f"not there after {self.max_time:g} s"

    def _keep(self, segment: str, world: int) -> None:
        """Keep the state of a world after a while without commands; the simulation itself stays where it is."""
        sim = self.scene.sim
        worlds = torch.arange(sim.num_envs)
        now = tuple(sim.read_snapshot(index) for index in range(sim.num_envs))
        sim.load_snapshots(SnapshotSet(tuple(map(str, range(sim.num_envs))), now, fingerprint(sim)))
        sim.write_snapshot(worlds)
        self._settle(world)
        self.states[segment] = sim.read_snapshot(world).at_rest()
        sim.write_snapshot(worlds)
        sim.forward()

    def _settle(self, world: int) -> None:
        """Wait until the largest force on a window of scope and the push on the base of a world stay the same."""
        sim, share, least = self.scene.sim, *STEADY
        steps, before = round((SETTLING - CONTROL_STEP) / sim.physics_dt), self._forces(world)
        for _ in range(round(LONGEST_SETTLING / SETTLING)):
            sim.step(steps)
            sim.step(self._steps)
            now = self._forces(world)
            if bool(((now - before).abs() <= share * now + least).all()):
                return
            before = now

    def _forces(self, world: int) -> torch.Tensor:
        """Largest force on a window and push on the base, means over a control step [N], shape (2,)."""
        data = self.scene["endoscope"].data
        return torch.stack([data.window_force_norm[world].amax(), data.base_force[world].abs()])
