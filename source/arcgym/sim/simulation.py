# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The simulation: all worlds' scopes and colons, stepped together."""

from __future__ import annotations

import logging
from collections.abc import Sequence

import numpy as np
import torch
import warp as wp

from arcgym.utils import warp_setup  # noqa: F401  isort: skip
import newton

from arcgym.assets.colon import Colon
from arcgym.assets.endoscope import Endoscope
from arcgym.sim import model_building
from arcgym.sim.contact.contact_search import ContactSearch
from arcgym.sim.coupling.two_level_coupling import Coupling, TwoLevelCoupling
from arcgym.sim.scope import readout_kernels
from arcgym.sim.scope.actuation import Actuation
from arcgym.sim.simulation_cfg import SimulationCfg
from arcgym.sim.snapshot import Snapshot, SnapshotSet
from arcgym.sim.wall.wall_readout import WallReadout
from arcgym.sim.wall.wall_solver import WallSolver
from arcgym.utils.worlds import fill_worlds

logger = logging.getLogger(__name__)

TIP_SPAN = 3
"""Rings on either side of the last link's own among which the tip is located."""


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
            ValueError: If ``num_envs`` is not positive.
        """
        if num_envs < 1:
            raise ValueError(f"num_envs is {num_envs}; at least one world is needed.")
        self.cfg, self.colon, self.endoscope, self.num_envs = cfg, colon, endoscope, num_envs
        self.device = cfg.device
        self.model = self._scope_model()
        self.state, self.control = self.model.state(), self.model.control()
        newton.eval_fk(self.model, self.state.joint_q, self.state.joint_qd, self.state)
        wall = model_building.wall_parameters(colon)
        points = np.repeat(wall.points.astype(np.float32)[:, None], num_envs, axis=1)
        self.nodal_pos = wp.array(points, dtype=wp.vec3, device=self.device)
        self.nodal_vel = wp.zeros_like(self.nodal_pos)
        self._allocate_readout()
        self.actuation = Actuation(cfg, endoscope, self.model, num_envs, self.device)
        self.contact = ContactSearch(
            cfg.contact,
            colon.surface_offset,
            model_building.wall_lumen(colon),
            colon.wall.ring,
            endoscope.half_length,
            endoscope.stage.link_radius,
            num_envs,
            self.device,
        )
        modes, slots = model_building.wall_modes(wall), len(self.contact.records.face)
        self.wall = WallSolver(cfg.wall, wall, modes, cfg.dt, num_envs, slots, self.device)
        self.wall_readout = WallReadout(
            model_building.wall_lumen(colon), wall.points, wall.ring, wall.anchor, self.wall.tissue.anchor, self.device
        )
        self.coupling: Coupling = self._coupling()
        self.ring_centers = self.contact.centers
        self.friction: torch.Tensor = wp.to_torch(self.contact.friction)
        self.moduli: torch.Tensor = wp.to_torch(self.wall.tissue.moduli)
        self.anchor_scale: torch.Tensor = wp.to_torch(self.wall.tissue.anchor).fill_(colon.anchor_scale)
        self.rigid: torch.Tensor = wp.to_torch(self.wall.tissue.rigid)
        self._graph: wp.Graph | None = None
        self._eager_steps = 0
        colon.bind(self)
        endoscope.bind(self)
        self.forward()
        self.snapshots: SnapshotSet | None = None
        self._start = self.read_snapshot(0)
        self._library = self._to_device([self._start])

    def _scope_model(self) -> newton.Model:
        builder = model_building.empty_builder()
        builder.replicate(model_building.scope_builder(self.endoscope, self.cfg.mass_scaling), self.num_envs)
        return builder.finalize(device=self.device)

    def _coupling(self) -> Coupling:
        if self.cfg.solver == "newton":
            from arcgym.sim.coupling.newton_coupling import NewtonCoupling

            return NewtonCoupling(self)
        return TwoLevelCoupling(
            self.cfg,
            self.model,
            self.state,
            self.control,
            self.actuation,
            self.contact,
            self.wall,
            self.nodal_pos,
            self.nodal_vel,
            self.step_force,
            self._pierced,
        )

    def _allocate_readout(self) -> None:
        n, rows, device = self.num_envs, self.num_envs * self.endoscope.num_bodies, self.device
        self.step_force = wp.zeros(rows, dtype=wp.vec3, device=device)
        self.wall_force = wp.zeros(rows, dtype=wp.vec3, device=device)
        self.wall_force_norm = wp.zeros(rows, dtype=float, device=device)
        self.wall_force_peak = wp.zeros(rows, dtype=float, device=device)
        self.tip_pose = wp.zeros(n, dtype=wp.transform, device=device)
        self.tip_velocity = wp.zeros(n, dtype=wp.spatial_vector, device=device)
        self.camera_pose = wp.zeros(n, dtype=wp.transform, device=device)
        self.tip_arc = wp.zeros(n, dtype=float, device=device)
        self.tip_distance = wp.zeros(n, dtype=float, device=device)
        self.tip_direction = wp.zeros(n, dtype=wp.vec3, device=device)
        self._broken = wp.zeros(n, dtype=int, device=device)
        self._pierced = wp.zeros(n, dtype=int, device=device)
        self.ring_arc = wp.array(self.colon.wall.ring_arc, dtype=float, device=device)
        self._tip_offset = wp.vec3(0.0, 0.0, self.endoscope.tip_offset)
        camera = self.endoscope.stage.camera
        self._camera_offset = wp.transform(wp.vec3(*camera.position), wp.quat(*camera.quaternion))

    @property
    def physics_dt(self) -> float:
        """Physics step [s]."""
        return self.cfg.dt

    @property
    def non_finite(self) -> torch.Tensor:
        """Worlds whose state is not finite or has left the room, shape (N,), bool; as of the last step."""
        return wp.to_torch(self._broken) > 0

    @property
    def pierced(self) -> torch.Tensor:
        """Worlds in which the axis of a link came within a quarter of its radius of the wall, or behind it, in the last
        :meth:`step`, shape (N,), bool.

        Not told with ``solver="newton"``.
        """
        return wp.to_torch(self._pierced) > 0

    def require_two_level(self, what: str) -> None:
        """Refuse what plain Newton cannot give each world for itself.

        Raises:
            ValueError: If ``cfg.solver`` is not ``two_level``.
        """
        if self.cfg.solver != "two_level":
            raise ValueError(
                f"SimulationCfg.solver={self.cfg.solver!r} has one {what} for all worlds: set it in the configuration, "
                "and switch off the events that change it, such as env.events.stiffness=null env.events.friction=null."
            )

    def step(self, n: int = 1) -> None:
        """Advance all worlds by ``n`` physics steps; forces are averaged over them.

        The first two steps ever run kernel by kernel, which compiles them; the next is captured in a graph, which is
        replayed from then on.
        """
        averages = [self.wall_force, *self.actuation.averages]
        for array in (*averages, self.wall_force_peak, self._pierced):
            array.zero_()
        self.wall_readout.clear()
        for _ in range(n):
            self._step_once()
        self.wall_readout.finish(n)
        for array in averages:
            wp.to_torch(array).mul_(1.0 / n)
        self._read_out()

    def _step_once(self) -> None:
        if self._graph is not None:
            wp.capture_launch(self._graph)
            return
        if not self.cfg.use_graph or self._eager_steps < 2:
            self._physics_step()
            self._eager_steps += 1
            return
        with wp.ScopedCapture(device=self.device) as capture:
            self._physics_step()
        self._graph = capture.graph
        wp.capture_launch(self._graph)

    def _physics_step(self) -> None:
        self.coupling.step()
        wp.launch(
            readout_kernels.collect_forces,
            self.step_force.shape,
            [self.step_force, self.wall_force, self.wall_force_peak],
            device=self.device,
        )
        if self.wall.moves:
            self.wall_readout.measure(self.nodal_pos)

    def forward(self) -> None:
        """Recompute link poses, ring centres, tip and camera after the state was written to."""
        self.coupling.forward()
        self._read_out()

    def _read_out(self) -> None:
        links = self.endoscope.num_bodies
        self.contact.update_centers(self.nodal_pos)
        self.contact.track(self.state.body_q)
        args = [self.wall_force, self.wall_force_norm]
        wp.launch(readout_kernels.measure_forces, self.wall_force.shape, args, device=self.device)
        args = [self.state.body_q, self.state.body_qd, links, self._tip_offset, self._camera_offset]
        args += [self.tip_pose, self.tip_velocity, self.camera_pose]
        wp.launch(readout_kernels.read_tip, self.num_envs, args, device=self.device)
        args = [self.tip_pose, self.ring_centers, self.ring_arc, self.contact.ring, TIP_SPAN]
        args += [self.tip_arc, self.tip_distance, self.tip_direction]
        wp.launch(readout_kernels.locate_tip, self.num_envs, args, device=self.device)
        self._broken.zero_()
        args = [self.nodal_pos, self._broken]
        wp.launch(readout_kernels.flag_broken_points, self.nodal_pos.shape, args, device=self.device)
        args = [self.state.body_q, links, self._broken]
        wp.launch(readout_kernels.flag_broken_bodies, self.state.body_q.shape, args, device=self.device)

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
        views = {name: wp.to_torch(array).view(n, -1) for name, array in arrays.items()}
        return {**views, "nodal_pos": self.colon.data.nodal_pos_w, "nodal_vel": self.colon.data.nodal_vel_w}

    def read_snapshot(self, env_id: int) -> Snapshot:
        """Complete state of one world, on the host."""
        return Snapshot.read(self, env_id)

    def load_snapshots(self, snapshots: SnapshotSet) -> None:
        """Make stored states available to :meth:`write_snapshot`.

        Raises:
            ValueError: If they belong to another colon mesh or scope.
        """
        snapshots.check(self)
        self.snapshots = snapshots
        self._library = self._to_device([self._start, *snapshots.snapshots])

    def _to_device(self, snapshots: Sequence[Snapshot]) -> dict[str, torch.Tensor]:
        names = snapshots[0].arrays
        return {k: torch.tensor(np.stack([s.arrays[k] for s in snapshots]), device=self.device) for k in names}

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
        ids = torch.arange(self.num_envs, device=self.device)
        if env_ids is not None:
            ids = torch.as_tensor(env_ids, device=self.device, dtype=torch.long)
        self._check_index(torch.as_tensor(snapshot_index))
        row = torch.as_tensor(snapshot_index, device=self.device, dtype=torch.long).expand(len(ids)) + 1
        for name, array in self.world_arrays().items():
            array[ids] = self._library[name][row].view(len(ids), *array.shape[1:])
        self._clear_step(ids)
        mask = torch.zeros(self.num_envs + 1, dtype=torch.bool, device=self.device)
        mask[ids] = True
        self.coupling.reset(wp.from_torch(mask))

    def _check_index(self, index: torch.Tensor) -> None:
        stored = len(self._library["joint_q"]) - 1
        if not index.is_cuda and ((index < -1) | (index >= stored)).any():
            raise IndexError(
                f"Snapshot index {index.tolist()}: {stored} snapshots are loaded, from 0; -1 is the rest pose."
            )

    def _clear_step(self, ids: torch.Tensor) -> None:
        """Zero the commands and the force averages of some worlds."""
        per_link = [self.step_force, self.wall_force, self.wall_force_norm, self.wall_force_peak]
        for array in (self._pierced, *per_link):
            fill_worlds(wp.to_torch(array).view(self.num_envs, -1), ids, 0.0)
        self.wall_readout.reset(ids)
        self.actuation.reset(ids)
