# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""One physics step of a simulation: kernel by kernel at first, then recorded and replayed."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import warp as wp

from arcgym.sim.coupling.two_level_coupling import TwoLevelCoupling
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.two_threads import both, cpu_threads

if TYPE_CHECKING:
    from arcgym.sim.simulation import Simulation


class PhysicsStep:
    """Advances a simulation by one physics step.

    The first two steps ever made run kernel by kernel, which compiles them; the next is recorded in a graph, which is
    replayed from then on. On two threads of a CPU it is three graphs: contacts are found and the scope moves while the
    wall prepares its step, each part in a thread that replays it outside Python. As the two share nothing that either
    writes, results are those of one thread to the bit.
    """

    def __init__(self, sim: Simulation):
        """Nothing is launched yet; ``sim`` has to be built but for this."""
        self._sim = sim
        self._beside: tuple[wp.Graph, wp.Graph] | None = None
        self.graph: wp.Graph | None = None
        """The recorded step, or of one on two cores what comes after the parts done at the same time."""
        self._eager_steps = 0

    def make(self) -> None:
        """Make the step."""
        if self.graph is None and (not self._sim.cfg.use_graph or self._eager_steps < 2):
            self._launch()
            self._eager_steps += 1
            return
        if self.graph is None:
            self._record()
        if self._beside is not None:
            one, other = self._beside
            both(lambda: wp.capture_launch(one), lambda: wp.capture_launch(other))
        wp.capture_launch(self.graph)

    def _launch(self) -> None:
        self._sim.coupling.step()
        self._collect()

    def _collect(self) -> None:
        sim = self._sim
        sim.scope_readout.collect()
        if sim.wall.moves:
            sim.wall_readout.measure(sim.nodal_pos)
            if sim.surroundings is not None:
                sim.surroundings.read(sim.nodal_pos, sim.wall.tissue, sim.wall_readout)

    def _record(self) -> None:
        coupling = self._sim.coupling
        if not isinstance(coupling, TwoLevelCoupling) or not self._two_threads():
            self.graph = self._recorded(self._launch)
            return

        def rest() -> None:
            coupling.finish()
            self._collect()

        self._beside = self._recorded(coupling.prepare_wall), self._recorded(coupling.move_scope)
        self.graph = self._recorded(rest)

    def _two_threads(self) -> bool:
        """Whether a CPU is to use two cores, and the wall has something to do meanwhile."""
        return wp.get_device(self._sim.device).is_cpu and self._sim.wall.moves and cpu_threads() == 2

    def _recorded(self, work: Callable[[], None]) -> wp.Graph:
        with wp.ScopedCapture(device=self._sim.device) as capture:
            work()
        return capture.graph
