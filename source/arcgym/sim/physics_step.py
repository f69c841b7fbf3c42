# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""One physics step of a simulation: kernel by kernel at first, then recorded and replayed."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import warp as wp

from arcgym.sim.coupling.two_level_coupling import TwoLevelCoupling
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.cpu_threads import Pace, cpu_threads
from arcgym.utils.side_stream import SideStream
from arcgym.utils.threaded_graph import ThreadedGraph, at_the_same_time

if TYPE_CHECKING:
    from arcgym.sim.simulation import Simulation


class PhysicsStep:
    """Advances a simulation by physics steps.

    The first two steps ever made run kernel by kernel, which compiles them; the next is recorded in a graph, which is
    replayed from then on. With several threads of a CPU it is recorded in stages, which they replay together.
    """

    def __init__(self, sim: Simulation):
        """Nothing is launched yet; ``sim`` has to be built but for this."""
        self._sim = sim
        self.recorded: wp.Graph | ThreadedGraph | None = None
        """The recorded step: stages for several threads of a CPU, a graph for one of them or a GPU."""
        self._eager_steps = 0
        self._pace = Pace()
        self._side = SideStream(sim.device)

    def advance(self, steps: int = 1) -> None:
        """Advance all worlds by ``steps`` physics steps."""
        while steps > 0 and (not self._sim.cfg.use_graph or self._eager_steps < 2):
            self._launch()
            self._eager_steps += 1
            steps -= 1
        if steps == 0:
            return
        if self.recorded is None:
            self._record()
        if isinstance(self.recorded, ThreadedGraph):
            self._pace.run(functools.partial(self.recorded.run, steps), steps)
            return
        for _ in range(steps):
            wp.capture_launch(self.recorded)

    def _launch(self) -> None:
        coupling = self._sim.coupling
        if not isinstance(coupling, TwoLevelCoupling):
            coupling.step()
            self._sim.scope_readout.collect()
            self._read_wall()
            return
        coupling.move()
        if self._side.on_gpu:
            with self._side.scope():
                self._read_wall()
            self._finish_contacts(coupling)
            self._side.join()
            return
        at_the_same_time(functools.partial(self._finish_contacts, coupling), self._read_wall)

    def _finish_contacts(self, coupling: TwoLevelCoupling) -> None:
        """End what concerns scope and contacts; the wall is read, as by :meth:`_read_wall`."""
        coupling.finish_contacts()
        self._sim.scope_readout.collect()

    def _read_wall(self) -> None:
        sim = self._sim
        if sim.wall.moves:
            sim.wall_readout.measure(sim.nodal_pos)
            if sim.surroundings is not None:
                sim.surroundings.read(sim.nodal_pos, sim.wall.tissue, sim.wall_readout)

    def _record(self) -> None:
        threads = self._threads()
        if threads > 1:
            self.recorded = ThreadedGraph(threads)
            self.recorded.record(self._launch)
            return
        with wp.ScopedCapture(device=self._sim.device) as capture:
            self._launch()
        self.recorded = capture.graph

    def _threads(self) -> int:
        """Return how many threads have something to do."""
        sim = self._sim
        shared = isinstance(sim.coupling, TwoLevelCoupling) and sim.wall.moves and wp.get_device(sim.device).is_cpu
        return cpu_threads() if shared else 1
