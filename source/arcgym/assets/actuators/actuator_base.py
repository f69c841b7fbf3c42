# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What every actuator does."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import newton
import torch
import warp as wp

from arcgym.assets.actuators.actuator_base_cfg import ActuatorBaseCfg
from arcgym.utils.worlds import fill_worlds

if TYPE_CHECKING:
    from arcgym.assets.endoscope import Endoscope


class ActuatorBase:
    """One drive of the scopes of all worlds. W worlds, L links, D joint velocities a world.

    A subclass checks the scope in ``__init__``, makes its arrays in :meth:`allocate` and launches its kernels in
    :meth:`apply` and :meth:`record`, which run within a captured graph: no allocation, no branch on values of arrays.
    Its own ``set_command`` writes into ``commands``; action terms call it.
    """

    loads_links = True
    """Whether :meth:`apply` reads or writes ``state.body_f`` or ``resistance``, which hold the links' weight by then.
    If not, it may run while that is written."""

    def __init__(self, cfg: ActuatorBaseCfg, endoscope: Endoscope):
        """Keep configuration and scope; nothing is on the device yet.

        Raises:
            ValueError: In subclasses, if this scope cannot be driven like this.
        """
        self.cfg, self.endoscope = cfg, endoscope
        self.commands: list[wp.array] = []
        """Commands, W entries each; zero after a reset."""
        self.memory: dict[str, wp.array] = {}
        """What the drive remembers between steps, by name, W entries each; kept in start states."""
        self.averages: list[wp.array] = []
        """Forces that :meth:`record` adds up over a control step, W entries each."""
        self.readings: dict[str, wp.array] = {}
        """Arrays shown as fields of :class:`arcgym.assets.EndoscopeData`: ``base_force`` [N], (W,);
        ``tip_pull_force_w`` [N], (W, 3); ``bending`` [rad], (W, 2)."""

    def modify_model(self, builder: newton.ModelBuilder, dofs: Sequence[int]) -> None:
        """Change the Newton model of one world before it is built.

        Args:
            builder: Builder with the scope in it.
            dofs: Indices of the scope's joint velocities, the root's first, length D.
        """

    def allocate(self, model: newton.Model, num_envs: int, device: str) -> None:
        """Make the arrays and fill :attr:`commands`, :attr:`memory`, :attr:`averages` and :attr:`readings`.

        Args:
            model: Newton model of all worlds' scopes.
            num_envs: Number of worlds W.
            device: Warp device.
        """

    def apply(self, state: newton.State, control: newton.Control, resistance: wp.array, dt: float) -> None:
        """Drive the scopes for a substep: add to ``state.body_f`` or move ``control.joint_target_q``.

        Args:
            state: State at the start of the substep; poses, velocities and forces of the links, shape (W*L,).
            control: Joint targets, shape (W*J,).
            resistance: Diagonal of the drop of ``state.body_f`` by the links' acceleration [kg], [kg m^2], shape
                (L, W); add to it what a spring or damper takes back, so that the solver treats it implicitly.
            dt: Substep [s].
        """

    def record(self, drive_force: wp.array, acceleration: wp.array, weight: float) -> None:
        """Add the substep's forces to the averages.

        Args:
            drive_force: Forces of the joint drives [N], [N m], shape (D, W).
            acceleration: Linear accelerations of the links [m/s^2], shape (L, W).
            weight: Share of the substep in the averages.
        """

    def record_explicit(self, state: newton.State, control: newton.Control, weight: float) -> None:
        """As :meth:`record`, with a solver that shows neither drive forces nor accelerations."""

    def turn_tip(self, angle: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | slice) -> None:
        """Turn what the tip is driven to by rotation vectors [rad], shape (n, 3), if this drive turns it."""

    def reset(self, env_ids: torch.Tensor) -> None:
        """Zero commands and averages of some worlds; memory is written by whoever resets the state.

        Args:
            env_ids: World indices, int64, shape (n,).
        """
        _zero([*self.commands, *self.averages], env_ids)


def _zero(arrays: Iterable[wp.array], env_ids: torch.Tensor) -> None:
    for array in arrays:
        fill_worlds(wp.to_torch(array), env_ids, 0.0)
