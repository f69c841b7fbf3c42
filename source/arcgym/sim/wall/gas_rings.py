# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Gas and wall in one coarse correction: the pressure is solved for together with the rings' motion."""

from __future__ import annotations

from typing import Any

import warp as wp

from arcgym.sim.wall import gas_ring_kernels as kernels
from arcgym.sim.wall.band_kernels import Rings
from arcgym.sim.wall.block_tridiagonal import BlockTridiagonalSolver
from arcgym.sim.wall.coarse_kernels import RingLoads
from arcgym.sim.wall.lumen_gas import LumenGas
from arcgym.sim.wall.ring_modes import MODES
from arcgym.sim.wall.shell_kernels import ShellElements
from arcgym.sim.wall.wall_kernels import Tissue
from arcgym.utils.threaded_graph import launch_rows


class GasRings:
    """Finds the change of pressure with which the gas fits the moved wall.

    The gas couples all rings with one number. With the coarse system A d = f + b dp, where b is the force of 1 Pa on
    the rings' modes, its solution is d = A^-1 f + dp A^-1 b, and the volume grows by b.d: with both solutions known the
    gas law gives dp. So the wall's own stiffness, inertia and contacts at hand decide how far it gives.
    """

    def __init__(self, gas: LumenGas, rings: int):
        """Allocate for R rings."""
        self.gas, self.device, count = gas, gas.device, gas.num_envs
        self._push, self._answer = (wp.zeros((rings, count, MODES), dtype=float, device=self.device) for _ in range(2))
        self._gain = wp.zeros((rings, count), dtype=wp.vec2, device=self.device)
        self._change = wp.zeros(count, dtype=float, device=self.device)

    def solve(
        self,
        shell: ShellElements,
        rings: Rings,
        loads: RingLoads,
        tissue: Tissue,
        system: BlockTridiagonalSolver,
        first: bool,
        last: bool,
    ) -> None:
        """Solve an assembled coarse system together with the gas; :meth:`prolong` moves the wall by it.

        Args:
            shell: The shell, measured where the gas has measured the volume.
            rings: Rings of all patients.
            loads: Loads of all patients.
            tissue: Values of each world.
            system: The system; its right-hand side is replaced by the rings' motion without a change of pressure.
            first: Whether it is the first solution of a physics step, before which gas flows.
            last: Whether it is the last one, whose pressure is noted.
        """
        answer, gas, count = self._answer, self.gas, self._gain.shape
        self._launch(kernels.assemble_push, count, [shell, rings, loads, tissue], [self._push, answer])
        system.solve(also=answer)
        self._launch(kernels.measure_gain, count, [self._push, system.rhs, answer], [self._gain])
        inputs = [gas.parts, self._gain, gas.law, gas.dt if first else 0.0, int(last)]
        self._launch(kernels.settle_pressure, self._change.shape, inputs, [gas.state, gas.loads, self._change])

    def prolong(self, rings: Rings, system: BlockTridiagonalSolver, largest_move: float, x: wp.array) -> None:
        """Move every vertex with its ring as solved for.

        Args:
            rings: Rings of all patients.
            system: The system, solved.
            largest_move: Longest displacement of a vertex [m].
            x: Positions [m], shape (V, W), vec3; moved in place.
        """
        inputs = [rings, system.rhs, self._answer, self._change, largest_move]
        launch_rows(kernels.prolong_with_gas, x.shape, inputs, [x], self.device)

    def _launch(self, kernel: wp.Kernel, shape: Any, inputs: list[Any], outputs: list[Any]) -> None:
        wp.launch(kernel, shape, inputs=inputs, outputs=outputs, device=self.device)
