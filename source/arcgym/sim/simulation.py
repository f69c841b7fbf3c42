# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The simulation: all worlds' scopes and colons, stepped together."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence

import numpy as np
import torch
import warp as wp

from arcgym.utils import warp_setup  # noqa: F401  isort: skip
import newton

from arcgym.anatomy.shell import ShellMesh
from arcgym.assets.colon import Colon
from arcgym.assets.endoscope import Endoscope
from arcgym.sim import model_building
from arcgym.sim.contact.carried_surface import CarriedSurface
from arcgym.sim.contact.contact_search import ContactSearch
from arcgym.sim.coupling.two_level_coupling import Coupling, TwoLevelCoupling
from arcgym.sim.patient_walls import patient_walls
from arcgym.sim.physics_step import PhysicsStep
from arcgym.sim.scope.actuation import Actuation
from arcgym.sim.scope.scope_readout import ScopeReadout
from arcgym.sim.simulation_cfg import SimulationCfg
from arcgym.sim.snapshot import Snapshot, SnapshotSet, optional
from arcgym.sim.snapshot_library import SnapshotLibrary
from arcgym.sim.wall.wall_readout import WallReadout
from arcgym.sim.wall.wall_solver import WallSolver
from arcgym.sim.wall.wall_topology import LumenTopology
from arcgym.sim.wall_effects import wall_effects
from arcgym.utils.configclass import validate
from arcgym.utils.worlds import fill_worlds

logger = logging.getLogger(__name__)

NEWTON_REMEDY = (
    "set it in the configuration, and switch off the events that change it, such as env.events.stiffness=null "
    "env.events.friction=null"
)
"""How to do without values that differ between worlds."""


class Simulation:
    """Physics of N worlds, each one endoscope in one colon. V wall vertices, L links, R rings.

    The state lives once, on the device: ``state`` (Newton's, the scope), ``nodal_pos`` and ``nodal_vel`` (the wall).
    Managers see the same memory as torch tensors through ``colon.data`` and ``endoscope.data``.
    """

    def __init__(self, cfg: SimulationCfg, colon: Colon, endoscope: Endoscope, num_envs: int):
        """Build models and solvers.

        Args:
            cfg: Settings.
            colon: Colon of every world.
            endoscope: Endoscope of every world.
            num_envs: Number of worlds N.

        Raises:
            StageError: If Newton's importer drops something of a stage.
            ValueError: If ``num_envs`` is not positive or a setting is out of its bounds.
        """
        validate(cfg, "sim")
        if num_envs < 1:
            raise ValueError(f"num_envs is {num_envs}, expected 1 or more worlds.")
        self.cfg, self.colon, self.endoscope, self.num_envs = cfg, colon, endoscope, num_envs
        self.device = cfg.device
        patients = np.arange(num_envs, dtype=np.int32) % len(colon.patients)
        self.patient = wp.array(patients, dtype=int, device=self.device)
        """Patient of each world, index into ``colon.patients``, shape (N,)."""
        self.model = model_building.scope_model(endoscope, cfg.mass_scaling, num_envs, self.device)
        self.state, self.control = self.model.state(), self.model.control()
        newton.eval_fk(self.model, self.state.joint_q, self.state.joint_qd, self.state)
        self.scope_readout = ScopeReadout(
            endoscope, [patient.wall.ring_arc for patient in colon.patients], self.patient, self.device
        )
        self.actuation = Actuation(cfg, endoscope, self.model, num_envs, self.device)
        self._build_wall()
        self.coupling: Coupling = self._coupling()
        self.ring_centers = self.contact.centers
        self.friction: torch.Tensor = wp.to_torch(self.contact.friction)
        """Coulomb coefficient between scope and wall of each world, shape (N,)."""
        self.moduli: torch.Tensor = wp.to_torch(self.wall.tissue.moduli)
        """Elastic moduli of each world's wall, see :meth:`arcgym.assets.Colon.moduli`, shape (N, 3)."""
        self.anchor_scale: torch.Tensor = wp.to_torch(self.wall.tissue.anchor).fill_(colon.anchor_scale)
        """Factor on the stiffness of each world's anchors, shape (N,)."""
        self.rigid: torch.Tensor = wp.to_torch(self.wall.tissue.rigid)
        """1 where a world's wall is held still, 0 elsewhere, shape (N,), int32."""
        self._all_worlds = wp.ones(num_envs, dtype=wp.bool, device=self.device)
        self.written_states = 0
        """How often states were written so far, see :meth:`forward`."""
        self._physics = PhysicsStep(self)
        self.watchers: list[Callable[[int, int], None]] = []
        """Called before each physics step of :meth:`step` with how many are left, this one counted, and how many there
        are in all: for sensors that look between control steps. Launches only."""
        colon.bind(self)
        endoscope.bind(self)
        self.forward()
        self._library = SnapshotLibrary(self._rests(), self.world_arrays(), colon.data.patient)

    def _build_wall(self) -> None:
        """Wall positions and velocities, contact search, wall solver and its readout."""
        cfg, colon, scope = self.cfg, self.colon, self.endoscope
        (walls, modes), lumen = patient_walls(colon), model_building.wall_lumen(colon.wall)
        rest = [wall.points for wall in walls]
        points = np.stack(rest, axis=1).astype(np.float32)[:, self.patient.numpy()]
        self.nodal_pos = wp.array(points, dtype=wp.vec3, device=self.device)
        self.nodal_vel = wp.zeros_like(self.nodal_pos)
        self.contact = ContactSearch(
            cfg.contact,
            colon.surface_offset,
            lumen,
            colon.wall.ring,
            scope.half_length,
            scope.stage.link_radius,
            self.num_envs,
            self.device,
            self._carried_surface(rest, lumen),
        )
        slots = len(self.contact.records.face)
        effects = wall_effects(self, walls, modes, lumen)
        self.gas, self.surroundings = effects.gas, effects.surroundings
        self.wall = WallSolver(cfg.wall, walls, modes, cfg.dt, self.patient, slots, self.device, *effects)
        self.contact.still = not self.wall.moves
        if isinstance(colon.wall, ShellMesh):
            self.contact.soften(self.wall.tissue.moduli, cfg.contact.tissue_share)
        anchors, scale = [wall.anchor for wall in walls], self.wall.tissue.anchor
        self.wall_readout = WallReadout(lumen, rest, colon.wall.ring, anchors, scale, self.patient, self.device)

    def _carried_surface(self, rest: list[np.ndarray], lumen: LumenTopology) -> CarriedSurface | None:
        """Return the fine surface that the links touch, or None if they touch the wall's own faces."""
        if self.cfg.contact.surface == "wall":
            return None
        self.require_two_level("touches the wall's own faces", "set env.sim.contact.surface=wall")
        rows_alone = self.cfg.contact.surface == "rows"
        return model_building.carried_surface(self.colon, rest, lumen, self.patient, rows_alone)

    def _coupling(self) -> Coupling:
        if self.cfg.solver == "newton":
            if len(self.colon.patients) > 1:
                remedy = "choose solver='two_level', or one stage in env.scene.colon.usd_path"
                self.require_two_level("has one patient in all worlds", remedy)
            from arcgym.sim.coupling.newton_coupling import NewtonCoupling

            return NewtonCoupling(self)
        return TwoLevelCoupling(self)

    @property
    def physics_dt(self) -> float:
        """Physics step [s]."""
        return self.cfg.dt

    @property
    def non_finite(self) -> torch.Tensor:
        """Worlds whose state is not finite or has left the room, shape (N,), bool; as of the last step."""
        return wp.to_torch(self.scope_readout.broken) > 0

    @property
    def wall_penetrated(self) -> torch.Tensor:
        """Worlds in which a link's axis came within a quarter of its radius of the wall, or behind it, in the last
        :meth:`step`, shape (N,), bool.

        Raises:
            ValueError: If ``cfg.solver`` is not ``two_level``.
        """
        self.require_two_level("does not measure wall penetration", "set env.terminations.wall_penetrated=null")
        return wp.to_torch(self.scope_readout.penetrated) > 0

    @property
    def dropped_contacts(self) -> torch.Tensor:
        """Contacts of each world that found no room since the simulation was built, shape (N,), int.

        See :attr:`arcgym.sim.ContactCfg.capacity`.
        """
        return wp.to_torch(self.contact.records.dropped)

    @property
    def snapshots(self) -> SnapshotSet | None:
        """The loaded snapshots."""
        return self._library.snapshots

    def require_two_level(self, limit: str, remedy: str = NEWTON_REMEDY) -> None:
        """Refuse what plain Newton cannot do.

        Args:
            limit: What ``solver="newton"`` does instead, or does not do.
            remedy: How to do without.

        Raises:
            ValueError: If ``cfg.solver`` is not ``two_level``.
        """
        if self.cfg.solver != "two_level":
            raise ValueError(f"SimulationCfg.solver={self.cfg.solver!r} {limit}: {remedy}.")

    def step(self, n: int = 1) -> None:
        """Advance all worlds by ``n`` physics steps; forces are averaged over them.

        The first two steps ever run kernel by kernel, which compiles them; the next is captured in a graph, which is
        replayed from then on.
        """
        averages = self.actuation.averages
        for array in averages:
            array.zero_()
        self.scope_readout.clear()
        self.wall_readout.clear()
        if self.gas is not None:
            self.gas.clear()
        if self.watchers:
            for left in range(n, 0, -1):
                for watch in self.watchers:
                    watch(left, n)
                self._physics.advance()
        else:
            self._physics.advance(n)
        for array in averages:
            wp.to_torch(array).mul_(1.0 / n)
        self.scope_readout.finish(n)
        self.wall_readout.finish(n)
        if self.gas is not None:
            self.gas.finish(n)
        self._read_out(self._all_worlds)

    def forward(self, env_mask: torch.Tensor | None = None) -> None:
        """Recompute link poses, ring centers, tip and camera after the state was written to.

        Args:
            env_mask: Worlds that were written to, shape (N,), bool; None for all. The others stay as they are to the
                last bit, which they would not on a GPU: the same formula may round otherwise in another kernel.
        """
        mask = self._all_worlds if env_mask is None else wp.from_torch(env_mask.contiguous(), dtype=wp.bool)
        self.written_states += 1
        if self.contact.still:
            self.contact.measure_surface(self.nodal_pos)
        self.coupling.forward(mask)
        if self.gas is not None:
            self.gas.fill(self.nodal_pos, mask)
        self._read_out(mask)

    def _read_out(self, world_mask: wp.array) -> None:
        self.contact.update_centers(self.nodal_pos)
        self.contact.track(self.state.body_q, world_mask)
        self.scope_readout.update(self.state, self.contact, self.nodal_pos)

    def world_arrays(self) -> dict[str, torch.Tensor]:
        """Everything that a world's future depends on, as views of shape (N, ...)."""
        n = self.num_envs
        arrays = {
            "joint_q": self.state.joint_q,
            "joint_qd": self.state.joint_qd,
            "joint_target_q": self.control.joint_target_q,
            "link_ring": self.contact.ring,
            **self.actuation.memory,
        }
        views = {name: wp.to_torch(array).view(n, -1) for name, array in arrays.items()} | self.contact.memory
        views |= self.wall.elements.memory | ({} if self.gas is None else self.gas.memory)
        views |= {} if self.surroundings is None else self.surroundings.memory
        return {**views, "nodal_pos": self.colon.data.nodal_pos_w, "nodal_vel": self.colon.data.nodal_vel_w}

    def world_settings(self) -> dict[str, torch.Tensor]:
        """Return what differs between worlds and no step changes, such as friction, as views of shape (N, ...).

        All may be written to but ``patient``: see :meth:`arcgym.assets.Colon.write_patient_to_sim`.
        """
        return {
            "friction": self.friction,
            "moduli": self.moduli,
            "anchor_scale": self.anchor_scale,
            "rigid": self.rigid,
            "patient": self.colon.data.patient,
            **({} if self.gas is None else self.gas.settings),
            **({} if self.surroundings is None else self.surroundings.settings),
            **({"gravity": wp.to_torch(self.actuation.gravity)} if self.cfg.weight.enabled else {}),
        }

    def write_gravity(self, gravity: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | None = None) -> None:
        """Turn patients: set the acceleration of free fall in their axes.

        Args:
            gravity: Such as ``cfg.weight.gravity("prone")`` [m/s^2], shape (n, 3).
            env_ids: The worlds, all by default.

        Raises:
            ValueError: If nothing weighs.
        """
        if not self.cfg.weight.enabled:
            raise ValueError("Nothing weighs, so a posture changes nothing: set env.sim.weight.enabled=true.")
        array = wp.to_torch(self.actuation.gravity)
        array[self._worlds(env_ids)] = gravity.to(array)

    def write_loop_friction(self, friction: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | None = None) -> None:
        """Set the coefficient of friction between loops of the colon, shape (n,), of the worlds (all by default).

        Raises:
            ValueError: If loops do not rub.
        """
        if self.surroundings is None or self.surroundings.friction is None:
            raise ValueError("Loops do not rub on each other: set env.sim.loops.enabled=true.")
        array = wp.to_torch(self.surroundings.friction.friction)
        array[self._worlds(env_ids)] = friction.to(array)

    def write_state(
        self, arrays: Mapping[str, torch.Tensor], env_ids: Sequence[int] | torch.Tensor | None = None
    ) -> None:
        """Put worlds into states given in full, with zero commands; call :meth:`forward` after the last write.

        Args:
            arrays: All arrays of :meth:`world_arrays` by name, each of shape (n, ...).
            env_ids: The worlds, shape (n,); all by default.

        Raises:
            ValueError: If arrays are missing, unknown or of another shape, with their names.
        """
        ids = self._worlds(env_ids)
        own = self.world_arrays()
        wrong = sorted(set(own) ^ set(arrays))
        wrong += [name for name in own if name not in wrong and arrays[name].shape != (len(ids), *own[name].shape[1:])]
        if wrong:
            raise ValueError(
                f"This state does not fit {self.colon.path} with {self.endoscope.path}: {', '.join(wrong)} are "
                "missing, unknown or of another shape."
            )
        for name, array in own.items():
            array[ids] = arrays[name].to(array)
        self._after_write(ids)

    def read_snapshot(self, env_id: int) -> Snapshot:
        """Complete state of one world, on the host."""
        return Snapshot.read(self, env_id)

    def load_snapshots(self, snapshots: SnapshotSet | Sequence[SnapshotSet]) -> None:
        """Make stored states available to :meth:`write_snapshot`.

        Args:
            snapshots: States of the patient, or of each; names that one of them lacks are left out.

        Raises:
            ValueError: If they belong to another colon mesh or scope, or there is not a set for each patient.
        """
        sets = [snapshots] if isinstance(snapshots, SnapshotSet) else list(snapshots)
        for patient, one in enumerate(sets[: len(self.colon.patients)]):
            one.check(self, patient)
        self._library.load(sets)

    def _rests(self) -> list[Snapshot]:
        """Return the rest pose in each patient: that of the scope is the same, its links look for their rings, and the
        lumen is to be filled."""
        now = self.read_snapshot(0).arrays
        now["link_ring"] = np.full_like(now["link_ring"], -1)
        now |= {name: np.zeros_like(now[name]) for name in now if optional(name)}
        walls = [patient.wall.points.astype(np.float32) for patient in self.colon.patients]
        return [Snapshot({**now, "nodal_pos": points}) for points in walls]

    def write_snapshot(
        self, snapshot_index: torch.Tensor | int, env_ids: Sequence[int] | torch.Tensor | None = None
    ) -> None:
        """Put worlds into stored states, with zero commands; call :meth:`forward` after the last write.

        Args:
            snapshot_index: Which state of ``self.snapshots`` each world takes, shape (n,), or one for all; -1 is the
                rest pose, scope straight and tip just inside the anus.
            env_ids: The worlds, all by default.

        Raises:
            IndexError: If there is no such state; indices on a GPU are not checked, for that would wait for it.
        """
        ids = self._worlds(env_ids)
        self._library.write(snapshot_index, ids)
        self._after_write(ids)

    def _worlds(self, env_ids: Sequence[int] | torch.Tensor | None) -> torch.Tensor:
        """Return the indices of worlds on the device, int64; all for None."""
        if env_ids is None:
            return torch.arange(self.num_envs, device=self.device)
        return torch.as_tensor(env_ids, device=self.device, dtype=torch.long)

    def _after_write(self, ids: torch.Tensor) -> None:
        """Let worlds whose state was written forget commands, averages and what the solvers remember."""
        self._clear_step(ids)
        mask = torch.zeros(self.num_envs + 1, dtype=torch.bool, device=self.device)
        fill_worlds(mask, ids, True)
        self.coupling.reset(wp.from_torch(mask))

    def _clear_step(self, ids: torch.Tensor) -> None:
        """Zero the commands and the force averages of some worlds."""
        self.scope_readout.reset(ids)
        self.wall_readout.reset(ids)
        self.actuation.reset(ids)
        if self.gas is not None:
            self.gas.reset(ids)
        if self.surroundings is not None:
            self.surroundings.reset(ids)
