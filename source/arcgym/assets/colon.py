# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The colon as an asset: parameters for the simulation, state for managers."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import newton
import numpy as np
import torch
import warp as wp

from arcgym.anatomy.segments import ANCHOR_FIXED, SEGMENTS
from arcgym.anatomy.shell import ShellMesh
from arcgym.anatomy.stage import ColonStage, WallMesh
from arcgym.assets.anchors import AnchorSprings, anchor_springs
from arcgym.assets.colon_cfg import ColonCfg
from arcgym.assets.colon_data import ColonData
from arcgym.assets.materials import Value, anchor_scale, shell_moduli, solid_moduli, tissue_preset
from arcgym.assets.patient import Patient, on_average_patient
from arcgym.assets.patient_cache import load_patients
from arcgym.assets.patient_checks import check_patients
from arcgym.assets.patient_files import find_stages
from arcgym.assets.shell_loading import add_shell
from arcgym.assets.usd_loading import add_colon_usd
from arcgym.utils.configclass import validate
from arcgym.utils.string import did_you_mean

if TYPE_CHECKING:
    from arcgym.sim.simulation import Simulation


class Colon:
    """Soft colon of every world. V wall vertices, R rings, N worlds.

    Every world has one of the :attr:`patients`. They share one grid of vertices; what :attr:`stage`, :attr:`path` and
    :attr:`wall` say of places holds for the first of them.
    """

    def __init__(self, cfg: ColonCfg):
        """Read and check the stages; nothing is allocated on the device yet.

        Raises:
            StageError: If a stage cannot be used.
            TypeError: If a value of the configuration has another type than its field, or is none of its names.
            ValueError: If a value of the configuration cannot be used, no stages are found, or patients do not have the
                same grid.
        """
        validate(cfg, "ColonCfg")
        self.cfg = cfg
        self.tissue = tissue_preset(cfg.material)
        self.anchor_scale = anchor_scale(cfg.anchors)
        shell = cfg.wall_model == "shell"
        chosen = (cfg.wall_thickness, self.tissue.thickness if shell else None)
        thickness = next((value for value in chosen if value is not None), None)
        paths = find_stages(cfg.usd_path, cfg.num_patients)
        self.patients: tuple[Patient, ...] = load_patients(paths, thickness, shell)
        """Colons, of which each world has one."""
        if cfg.wall_law.mean_surface:
            self.patients = tuple(on_average_patient(patient) for patient in self.patients)
        tissue = ("youngs_modulus", "poissons_ratio", "density")
        own = [name for name in tissue if getattr(cfg, name) is None and getattr(self.tissue, name) is None]
        check_patients(self.patients, own)

    @property
    def path(self) -> Path:
        """Stage file of the first patient."""
        return self.patients[0].path

    @property
    def stage(self) -> ColonStage:
        """Stage of the first patient."""
        return self.patients[0].stage

    @property
    def wall(self) -> WallMesh | ShellMesh:
        """Wall of the first patient; all have its triangles, rings and layers."""
        return self.patients[0].wall

    @property
    def thickness(self) -> float:
        """Thickness of the wall [m], the same for all patients."""
        return self.patients[0].thickness

    @property
    def num_nodes(self) -> int:
        """Number of wall vertices V."""
        return len(self.wall.points)

    @property
    def num_rings(self) -> int:
        """Number of rings R along the centerline."""
        return len(self.wall.ring_arc)

    @cached_property
    def segments(self) -> tuple[str, ...]:
        """Names of the segments that all patients have, from the anus on."""
        return tuple(name for name in SEGMENTS if all(name in patient.bounds for patient in self.patients))

    def require_segment(self, name: str) -> None:
        """Check that all patients have a segment.

        Raises:
            ValueError: If one does not have it; names its stage and the segments that it has.
        """
        if name in self.segments:
            return
        patient = next(patient for patient in self.patients if name not in patient.bounds)
        raise ValueError(f"Segment '{name}' is not in {patient.path}. {did_you_mean(name, patient.bounds)}")

    def add_to(self, builder: newton.ModelBuilder, patient: int = 0) -> None:
        """Load the wall of a patient into ``builder`` and apply the material overrides."""
        one = self.patients[patient]
        if isinstance(one.wall, ShellMesh):
            add_shell(builder, one.wall, self._value("density"), self.moduli(*self.elasticity()))
            return
        first_tet = len(builder.tet_indices)
        particles = add_colon_usd(builder, one.path, one.stage)
        mu, lam, _ = solid_moduli(*self.elasticity())
        for tet in range(first_tet, len(builder.tet_indices)):
            builder.tet_materials[tet] = (mu, lam, builder.tet_materials[tet][2])
        ratio = self._value("density") / self.patients[0].material.density
        for i in particles:
            builder.particle_mass[i] *= ratio

    def elasticity(self) -> tuple[float, float]:
        """Young's modulus [Pa] and Poisson's ratio in use."""
        return self._value("youngs_modulus"), self._value("poissons_ratio")

    def moduli(self, youngs_modulus: Value, poissons_ratio: Value) -> tuple[Value, Value, Value]:
        """Shear, second Lamé parameter and bending of the wall: solid [Pa, Pa, -] or shell [N/m, N/m, N m]."""
        if isinstance(self.wall, ShellMesh):
            return shell_moduli(youngs_modulus, poissons_ratio, self.thickness)
        return solid_moduli(youngs_modulus, poissons_ratio)

    @property
    def surface_offset(self) -> float:
        """Distance of the lumen's surface from the wall's innermost vertices, towards the lumen [m]."""
        return 0.5 * self.thickness if isinstance(self.wall, ShellMesh) else 0.0

    def _value(self, name: str) -> float:
        """Material value: the configuration's, else the preset's, else the stage's."""
        values = [getattr(source, name) for source in (self.cfg, self.tissue, self.patients[0].material)]
        return next(value for value in values if value is not None)

    def mobile(self, patient: int = 0) -> np.ndarray:
        """Whether each wall vertex of a patient moves, shape (V,), bool."""
        wall = self.patients[patient].wall
        if self.cfg.rigid:
            return np.zeros(self.num_nodes, bool)
        free = wall.anchor != ANCHOR_FIXED
        if self.cfg.mobile_until is not None:
            free &= wall.ring_arc[wall.ring] <= self.cfg.mobile_until
        return free

    def anchor_springs(self, patient: int = 0) -> AnchorSprings:
        """Spring of each vertex of a patient to its rest position, before any factor of a world."""
        wall, cfg = self.patients[patient].wall, self.cfg
        sheets = cfg.mesentery.height if cfg.mesentery.enabled else {}
        stiffness = {**cfg.anchor_stiffness, **dict.fromkeys(sheets, self.tissue.anchor_loose)}
        return anchor_springs(wall, self.tissue, stiffness, {**cfg.anchor_slack, **dict.fromkeys(sheets, 0.0)})

    def bind(self, sim: Simulation) -> None:
        """Connect to the arrays of a built simulation; called once by it."""
        self._sim = sim
        self.nodal_pos_wp: wp.array = sim.nodal_pos
        self.patient_wp: wp.array = sim.patient
        self.data = ColonData(self, sim)

    @property
    def wall_version(self) -> int | None:
        """A number that changes where walls that stand still may have been put elsewhere; None for walls that move."""
        return None if self._sim.wall.moves else self._sim.written_states

    def patient_of(self, env_id: int) -> Patient:
        """Return the patient of a world; waits for the device."""
        return self.patients[int(self.data.patient[env_id])]

    def write_nodal_pos_to_sim(self, pos: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | None = None) -> None:
        """Set wall positions [m], shape (n, V, 3), of the worlds ``env_ids`` (all by default)."""
        self.data.nodal_pos_w[self._worlds(env_ids)] = pos

    def write_nodal_velocity_to_sim(
        self, vel: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | None = None
    ) -> None:
        """Set wall velocities [m/s], shape (n, V, 3), of the worlds ``env_ids`` (all by default)."""
        self.data.nodal_vel_w[self._worlds(env_ids)] = vel

    def write_nodal_state_to_sim(
        self, state: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | None = None
    ) -> None:
        """Set wall positions and velocities, shape (n, V, 6), of the worlds ``env_ids`` (all by default)."""
        self.write_nodal_pos_to_sim(state[..., :3], env_ids)
        self.write_nodal_velocity_to_sim(state[..., 3:], env_ids)

    def write_stiffness_scale_to_sim(
        self, scale: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | None = None
    ) -> None:
        """Multiply the configured Young's modulus in the worlds ``env_ids``, shape (n,)."""
        modulus, ratio = self.elasticity()
        self.write_material_to_sim(scale * modulus, torch.full_like(scale, ratio), env_ids)

    def write_material_to_sim(
        self,
        youngs_modulus: torch.Tensor,
        poissons_ratio: torch.Tensor,
        env_ids: Sequence[int] | torch.Tensor | None = None,
    ) -> None:
        """Set Young's modulus [Pa] and Poisson's ratio, shape (n,), of the worlds ``env_ids`` (all by default)."""
        self._sim.require_two_level("has one tissue for all worlds")
        moduli = torch.stack(self.moduli(youngs_modulus, poissons_ratio), dim=-1)
        self._sim.moduli[self._worlds(env_ids)] = moduli.to(self._sim.moduli)

    def write_anchor_scale_to_sim(
        self, scale: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | None = None
    ) -> None:
        """Multiply the preset's stiffness of the attachments in the worlds ``env_ids``, shape (n,).

        It takes the place of the factor that ``ColonCfg.anchors`` names; slack stays as it is.
        """
        self._sim.require_two_level("has one stiffness of the attachments for all worlds")
        self._sim.anchor_scale[self._worlds(env_ids)] = scale.to(self._sim.anchor_scale)

    def write_rigid_to_sim(self, rigid: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | None = None) -> None:
        """Hold the wall where it is, or let it go, in the worlds ``env_ids``, shape (n,), bool.

        Held walls cost as much as others; ``ColonCfg.rigid`` holds all of them at no cost.
        """
        self._sim.require_two_level("has one mobility of the wall for all worlds")
        self._sim.rigid[self._worlds(env_ids)] = rigid.to(self._sim.rigid)

    def write_gas_to_sim(
        self,
        abdominal_pressure: torch.Tensor | None = None,
        start_pressure: torch.Tensor | None = None,
        leak_conductance: torch.Tensor | None = None,
        env_ids: Sequence[int] | torch.Tensor | None = None,
    ) -> None:
        """Set values of the gas, see :class:`arcgym.assets.GasCfg`, of the worlds ``env_ids`` (all by default).

        Args:
            abdominal_pressure: Pressure around the colon [Pa], shape (n,); None leaves it as it is.
            start_pressure: Pressure at which the lumen is filled when the state is written next [Pa], shape (n,).
            leak_conductance: Of the anus [m^3/(s Pa)], shape (n,).
            env_ids: The worlds.

        Raises:
            ValueError: If no gas is simulated.
        """
        given = {"abdominal": abdominal_pressure, "start": start_pressure, "leak": leak_conductance}
        for name, value in given.items():
            if value is not None:
                array = self.data.gas_state(name)
                array[self._worlds(env_ids)] = value.to(array)

    def set_gas_flow(self, flow: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | None = None) -> None:
        """Command a flow of gas into the lumen, or out of it if negative, until the next command or write of state.

        Args:
            flow: At ambient pressure [m^3/s], shape (n,).
            env_ids: The worlds, all by default.

        Raises:
            ValueError: If no gas is simulated.
        """
        array = self.data.gas_state("flow")
        array[self._worlds(env_ids)] = flow.to(array)

    def write_abdomen_to_sim(
        self,
        gap: torch.Tensor | None = None,
        stiffness: torch.Tensor | None = None,
        env_ids: Sequence[int] | torch.Tensor | None = None,
    ) -> None:
        """Set values of the abdomen, see :class:`arcgym.assets.AbdomenCfg`, of the worlds ``env_ids`` (all by default).

        Args:
            gap: Way from the imaged colon to the inside of the abdomen [m], shape (n,); None leaves it as it is.
            stiffness: Pressure over depth [Pa/m], shape (n,).
            env_ids: The worlds.

        Raises:
            ValueError: If there is no abdomen.
        """
        shape = self.data.abdomen().shape
        for array, value in ((shape.gap, gap), (shape.stiffness, stiffness)):
            if value is not None:
                tensor = wp.to_torch(array)
                tensor[self._worlds(env_ids)] = value.to(tensor)

    def write_mesentery_to_sim(
        self,
        fullness: torch.Tensor | None = None,
        stiffness: torch.Tensor | None = None,
        env_ids: Sequence[int] | torch.Tensor | None = None,
    ) -> None:
        """Set values of the mesenteries of the worlds ``env_ids`` (all by default).

        Args:
            fullness: Length of the sheets over that as imaged, shape (n,); None leaves it as it is.
            stiffness: Young's modulus times thickness of the sheets [N/m], shape (n,).
            env_ids: The worlds.

        Raises:
            ValueError: If the mesenteries are no sheets.
        """
        sheets = self.data.mesentery().sheets
        for array, value in ((sheets.fullness, fullness), (sheets.stiffness, stiffness)):
            if value is not None:
                tensor = wp.to_torch(array)
                tensor[self._worlds(env_ids)] = value.to(tensor)

    def set_hand_pressure(
        self,
        force: torch.Tensor,
        place: torch.Tensor | None = None,
        env_ids: Sequence[int] | torch.Tensor | None = None,
    ) -> None:
        """Press on the abdomen by hand until the next command or write of state.

        Args:
            force: Of the hand [N], shape (n,); negative ones count as none.
            place: Where, to the patient's right and cranial of ``AbdomenCfg.hand_place`` [m], shape (n, 2); None leaves
                it. The hand stays on the front.
            env_ids: The worlds, all by default.

        Raises:
            ValueError: If there is no abdomen.
        """
        hand, worlds = self.data.abdomen().hand, self._worlds(env_ids)
        wp.to_torch(hand.force)[worlds] = force.to(self.data.hand_dent).clamp(min=0.0)
        if place is not None:
            self.data.hand_place[worlds] = place.to(self.data.hand_place)

    def write_patient_to_sim(self, patient: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | None = None) -> None:
        """Give the worlds ``env_ids`` (all by default) other patients, indices into :attr:`patients`, shape (n,).

        Their walls are put at rest. The scope stays where it is, in the middle of the new wall or behind it: write a
        start state next, as the event :func:`arcgym.envs.mdp.reset_to_segment_start` does.

        Raises:
            IndexError: If there is no such patient; indices on a GPU are not checked, for that would wait for it.
        """
        if not patient.is_cuda and ((patient < 0) | (patient >= len(self.patients))).any():
            last = len(self.patients) - 1
            raise IndexError(
                f"patient is {patient.tolist()}, expected indices from 0 to {last}: one of Colon.patients each."
            )
        worlds = self._worlds(env_ids)
        self.data.exchange(patient, worlds)
        self.data.nodal_pos_w[worlds] = self.data.rest_of(self.data.patient[worlds])
        self.data.nodal_vel_w[worlds] = 0.0

    @staticmethod
    def _worlds(env_ids: Sequence[int] | torch.Tensor | None) -> slice | torch.Tensor | Sequence[int]:
        return slice(None) if env_ids is None else env_ids
