# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""State of the colon's wall in every world."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import torch
import warp as wp

from arcgym.assets.patient import span_table

if TYPE_CHECKING:
    from arcgym.assets.colon import Colon
    from arcgym.sim.simulation import Simulation
    from arcgym.sim.wall.abdomen import Abdomen
    from arcgym.sim.wall.mesentery import Mesentery


class ColonData:
    """State of the wall as tensors that share memory with the simulation. V vertices, R rings, P patients, N worlds."""

    def __init__(self, colon: Colon, sim: Simulation):
        """Make views on the simulation's arrays."""
        self.nodal_pos_w: torch.Tensor = wp.to_torch(sim.nodal_pos).transpose(0, 1)
        """Positions of the wall vertices [m], shape (N, V, 3)."""
        self.nodal_vel_w: torch.Tensor = wp.to_torch(sim.nodal_vel).transpose(0, 1)
        """Velocities of the wall vertices [m/s], shape (N, V, 3)."""
        self.centerline_pos_w: torch.Tensor = wp.to_torch(sim.ring_centers)
        """Centers of the deformed rings [m], shape (N, R, 3)."""
        self.patient: torch.Tensor = wp.to_torch(sim.patient)
        """Patient of each world, index into :attr:`Colon.patients`, shape (N,), int32; to be read only."""
        self.root_pos_w = torch.zeros(sim.num_envs, 3, device=sim.device)
        """Position of the anal verge [m], shape (N, 3): the origin."""
        patients = colon.patients
        self._rest = _table([patient.wall.points for patient in patients], sim.device)
        self._ring_arc = _table([patient.wall.ring_arc for patient in patients], sim.device)
        self._spans = _table(span_table(patients), sim.device)
        self.centerline_arc: torch.Tensor = self._ring_arc[self.patient]
        """Arc length of the rings at rest [m], shape (N, R)."""
        self.segment_spans: torch.Tensor = self._spans[self.patient]
        """Arc length at start and end of each of :data:`arcgym.anatomy.segments.SEGMENTS` [m], shape (N, S, 2). One
        that a patient does not have begins and ends where the one before it ends."""
        self._gas, self._surroundings = sim.gas, sim.surroundings
        readout = sim.wall_readout
        self.wall_strain: torch.Tensor = wp.to_torch(readout.strain).transpose(0, 1)
        """Largest principal strain (stretch - 1) of each ring's lumen faces, mean over the control step, (N, R)."""
        self.wall_strain_peak: torch.Tensor = wp.to_torch(readout.strain_peak).transpose(0, 1)
        """Largest principal strain of each ring's lumen faces in any physics step of the control step, shape (N, R)."""
        self.anchor_tension: torch.Tensor = wp.to_torch(readout.tension).transpose(0, 1)
        """Net pull of each ring on its anchors [N], mean over the control step, shape (N, R)."""
        self.anchor_tension_peak: torch.Tensor = wp.to_torch(readout.tension_peak).transpose(0, 1)
        """Largest net pull of each ring on its anchors in any physics step of the control step [N], shape (N, R)."""

    @property
    def lumen_pressure(self) -> torch.Tensor:
        """Pressure of the gas in the lumen above the surrounding air's, at the end of the step [Pa], shape (N,).

        Raises:
            ValueError: If no gas is simulated.
        """
        return self.gas_state("pressure")

    @property
    def lumen_pressure_mean(self) -> torch.Tensor:
        """Pressure of the gas in the lumen, mean over the control step [Pa], shape (N,).

        Raises:
            ValueError: If no gas is simulated.
        """
        return self.gas_state("mean")

    @property
    def lumen_pressure_peak(self) -> torch.Tensor:
        """Pressure of the gas in the lumen, highest of the control step [Pa], shape (N,).

        Raises:
            ValueError: If no gas is simulated.
        """
        return self.gas_state("peak")

    @property
    def lumen_volume(self) -> torch.Tensor:
        """Volume inside the wall's middle surface, without the scope's taken off [m^3], shape (N,).

        Raises:
            ValueError: If no gas is simulated.
        """
        return self.gas_state("volume")

    def gas_state(self, name: str) -> torch.Tensor:
        """Return a field of the simulation's ``GasState``, such as ``pressure`` or ``flow``, shape (N,).

        Raises:
            ValueError: If no gas is simulated.
        """
        if self._gas is None:
            raise ValueError("No gas is simulated in the colon: set env.scene.colon.gas.enabled=true.")
        return wp.to_torch(getattr(self._gas.state, name))

    @property
    def abdomen_force(self) -> torch.Tensor:
        """Push of the colon on the abdomen, summed over all places, at the start of the last step [N], shape (N,).

        Raises:
            ValueError: If there is no abdomen.
        """
        return wp.to_torch(self.abdomen().push)

    @property
    def hand_dent(self) -> torch.Tensor:
        """How deep the hand has pressed the front of the abdomen in [m], shape (N,).

        Raises:
            ValueError: If there is no abdomen.
        """
        return wp.to_torch(self.abdomen().hand.dent)

    @property
    def hand_place(self) -> torch.Tensor:
        """Where the hand is, to the right and cranial of ``AbdomenCfg.hand_place`` [m], shape (N, 2).

        Raises:
            ValueError: If there is no abdomen.
        """
        return wp.to_torch(self.abdomen().hand.place)

    @property
    def mesentery_stretch(self) -> torch.Tensor:
        """How much farther from its root each ring is than its sheet is long [m], 0 without a sheet, shape (N, R).

        Raises:
            ValueError: If the mesenteries are no sheets.
        """
        return self.mesentery().stretch(self.centerline_pos_w)

    def mesentery(self) -> Mesentery:
        """Return the sheets that hold the colon.

        Raises:
            ValueError: If the mesenteries are no sheets.
        """
        if self._surroundings is None or self._surroundings.mesentery is None:
            raise ValueError("The mesenteries are no sheets: set env.scene.colon.mesentery.enabled=true.")
        return self._surroundings.mesentery

    def abdomen(self) -> Abdomen:
        """Return the abdomen around the colon, with its hand.

        Raises:
            ValueError: If there is no abdomen.
        """
        if self._surroundings is None or self._surroundings.abdomen is None:
            raise ValueError("There is no abdomen around the colon: set env.scene.colon.abdomen.enabled=true.")
        return self._surroundings.abdomen

    @property
    def default_nodal_state_w(self) -> torch.Tensor:
        """Rest state of the wall vertices, position [m] and velocity [m/s], shape (N, V, 6)."""
        rest = self.default_nodal_pos_w
        return torch.cat([rest, torch.zeros_like(rest)], dim=2)

    @property
    def default_nodal_pos_w(self) -> torch.Tensor:
        """Rest positions of the wall vertices [m], shape (N, V, 3)."""
        return self.rest_of(self.patient)

    def rest_of(self, patient: torch.Tensor) -> torch.Tensor:
        """Rest positions of the wall vertices of patients, shape (n,), in [m], shape (n, V, 3)."""
        return self._rest.expand(len(patient), -1, -1) if len(self._rest) == 1 else self._rest[patient]

    def exchange(self, patient: torch.Tensor, worlds: torch.Tensor | slice | Sequence[int]) -> None:
        """Set the patients of some worlds, and what follows from them but for the state of the wall."""
        self.patient[worlds] = patient.to(self.patient)
        self.centerline_arc[worlds] = self._ring_arc[self.patient[worlds]]
        self.segment_spans[worlds] = self._spans[self.patient[worlds]]

    @property
    def nodal_state_w(self) -> torch.Tensor:
        """Positions [m] and velocities [m/s] of the wall vertices, shape (N, V, 6)."""
        return torch.cat([self.nodal_pos_w, self.nodal_vel_w], dim=2)

    @property
    def nodal_displacement(self) -> torch.Tensor:
        """Distance of each wall vertex from its rest position [m], shape (N, V)."""
        return torch.linalg.vector_norm(self.nodal_pos_w - self.default_nodal_pos_w, dim=2)


def _table(values: list[np.ndarray] | np.ndarray, device: str) -> torch.Tensor:
    """Values of all patients, shape (P, ...), float32."""
    return torch.tensor(np.stack(list(values)), dtype=torch.float32, device=device)
