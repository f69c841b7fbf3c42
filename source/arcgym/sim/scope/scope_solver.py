# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Newton solver for scopes: one serial chain of joints a world, solved directly and implicitly in O(links)."""

from __future__ import annotations

import numpy as np
import warp as wp

from arcgym.utils import warp_setup  # noqa: F401  isort: skip
import newton
from newton import JointType
from newton.solvers import SolverBase

from arcgym.sim.scope import scope_kernels as kernels
from arcgym.sim.scope.aba_cuda_kernels import THREADS, fits, warp_kernel
from arcgym.sim.scope.aba_kernels import chain_kinematics, solve_chain
from arcgym.sim.scope.load_row_kernels import FOURS, LoadRows

JOINTS = (JointType.REVOLUTE, JointType.PRISMATIC, JointType.D6, JointType.FIXED)
"""Joint types that may join two links; a D6 joint with any axes, those that slide first."""

SPREAD_WORLDS = 1024
"""Worlds up to which a block has eight threads, each walking along a chain, so that all multiprocessors of a GPU have
some; of more worlds it has a warp of 32. On an H200, 1024 worlds took 541 us with 8 and 587 us with 32, and 4096 worlds
1342 us with 8, against 979 us of an earlier solver with 32."""


class SolverArticulatedChain(SolverBase):
    """Articulated-body algorithm with linearly implicit Euler steps.

    Position drives (``control.joint_target_q``), stops and the loads in :attr:`loads` and :attr:`resistance` are
    implicit and stable at any stiffness; ``state.body_f`` and ``control.joint_f`` act as they are. Gravity, joint
    friction, velocity targets and contacts of the model are left to the caller. Steps may be made in place.
    """

    def __init__(self, model: newton.Model):
        """Read the chain of the first world, and allocate the scratch of all.

        Args:
            model: Model whose worlds all hold the same single chain.

        Raises:
            ValueError: If the articulation is not a chain, or has joints of another kind.
        """
        super().__init__(model)
        self.num_envs = max(1, model.world_count)
        self._block = 8 if self.num_envs <= SPREAD_WORLDS else 32
        self.chain = self._chain()
        links, dofs, worlds = self.chain.links, self.chain.dofs, self.num_envs
        on_gpu = wp.get_device(model.device).is_cuda and fits(links, dofs)
        self._by_warp = warp_kernel(links, dofs) if on_gpu else None
        self.work = kernels.ChainWork()
        for rows, dtype, names in (
            (links, wp.mat33, "ll la aa"),
            (links, wp.vec3, "force torque arm lever drift_lin drift_ang acc_lin acc_ang"),
            (dofs, wp.vec3, "axis gain_lin gain_ang"),
            (dofs, float, "drive drive_inertia stop stop_inertia offset drive_force"),
        ):
            for name in names.split():
                setattr(self.work, name, self._rows(rows, dtype))
        self.loads: kernels.LinkLoads | LoadRows = self._no_loads(links)
        """Further loads of the links; rows where :attr:`by_warp`."""
        self.resistance = wp.zeros((links, worlds), dtype=wp.spatial_vector, device=model.device)
        """Diagonal of the drop of ``state.body_f`` by the links' acceleration [kg], [kg m^2], shape (L, W)."""

    @property
    def by_warp(self) -> bool:
        """Whether a warp of a GPU solves the chain of a world."""
        return self._by_warp is not None

    def _no_loads(self, links: int) -> kernels.LinkLoads | LoadRows:
        device, worlds = self.model.device, self.num_envs
        if self.by_warp:
            rows = LoadRows()
            rows.fours = wp.zeros(worlds * links * FOURS, dtype=wp.vec4, device=device)
            rows.loaded = wp.zeros(worlds * links, dtype=int, device=device)
            return rows
        loads = kernels.LinkLoads()
        for name in ("ll", "la", "aa"):
            setattr(loads, name, self._rows(links, wp.mat33))
        loads.wrench = self._rows(links, wp.spatial_vector)
        return loads

    def _rows(self, count: int, dtype: type) -> wp.array:
        """Return zeros of shape (``count``, W); where a warp reads them, those of a world lie side by side."""
        if self._by_warp is None:
            return wp.zeros((count, self.num_envs), dtype=dtype, device=self.model.device)
        return wp.zeros((self.num_envs, count), dtype=dtype, device=self.model.device).transpose()

    def _chain(self) -> kernels.Chain:
        model, worlds = self.model, self.num_envs
        counts = [model.body_count, model.joint_dof_count, model.joint_coord_count]
        links, dofs, coords = (count // worlds for count in counts)
        _check_chain(model, links)
        chain = kernels.Chain()
        chain.links, chain.dofs, chain.coords, chain.free = links, dofs, coords, int(coords > dofs)
        first = {
            "parent_frame": (model.joint_X_p, links),
            "child_frame": (model.joint_X_c, links),
            "com": (model.body_com, links),
            "mass": (model.body_mass, links),
            "inertia": (model.body_inertia, links),
            "dof_start": (model.joint_qd_start, links + 1),
            "axis": (model.joint_axis, dofs),
            "stiffness": (model.joint_target_ke, dofs),
            "damping": (model.joint_target_kd, dofs),
            "effort": (model.joint_effort_limit, dofs),
            "armature": (model.joint_armature, dofs),
            "lower": (model.joint_limit_lower, dofs),
            "upper": (model.joint_limit_upper, dofs),
            "stop_stiffness": (model.joint_limit_ke, dofs),
            "stop_damping": (model.joint_limit_kd, dofs),
        }
        for name, (array, count) in first.items():
            setattr(chain, name, wp.clone(array[:count]))
        chain.linear = wp.array(_linear(model, links, dofs), dtype=int, device=model.device)
        return chain

    def forward(self, state: newton.State, world_mask: wp.array) -> None:
        """Recompute the links' poses and velocities in ``world_mask``, shape (W,), bool.

        If nothing was changed this is what :meth:`step` leaves: to the bit on a CPU, to rounding on a GPU.
        """
        wp.launch(
            chain_kinematics,
            self.num_envs,
            inputs=[self.chain, state.joint_q, state.joint_qd, world_mask],
            outputs=[state.body_q, state.body_qd],
            device=self.model.device,
            block_dim=self._block,
        )

    def step(
        self,
        state_in: newton.State,
        state_out: newton.State,
        control: newton.Control,
        contacts: newton.Contacts | None,
        dt: float,
    ) -> None:
        """Advance all chains by ``dt`` [s]; ``contacts`` are not used."""
        if state_in is not state_out:
            wp.copy(state_out.joint_q, state_in.joint_q)
            wp.copy(state_out.joint_qd, state_in.joint_qd)
        self.prepare(state_in, control, dt)
        self.move(state_in, state_out, control, dt)

    def prepare(self, state: newton.State, control: newton.Control, dt: float) -> None:
        """Begin a step of ``dt`` [s] with the joints, for which :attr:`loads` need not be known.

        Where :attr:`by_warp`, :meth:`move` does that, too.
        """
        if self.by_warp:
            return
        chain = self.chain
        wp.launch(
            kernels.prepare_joints,
            (self.num_envs, chain.dofs),
            inputs=[chain, state.joint_q, state.joint_qd, control.joint_target_q, control.joint_f, dt],
            outputs=[self.work],
            device=self.model.device,
        )

    def move(
        self,
        state_in: newton.State,
        state_out: newton.State,
        control: newton.Control,
        dt: float,
        mean_load: wp.array | None = None,
        weight: float = 0.0,
    ) -> None:
        """End a step that :meth:`prepare` began.

        Args:
            state_in: State at the start of the step.
            state_out: State at its end; its joints begin where those of ``state_in`` do.
            control: Targets and forces of the joints, as in :meth:`prepare`.
            dt: Step [s].
            mean_load: Force of :attr:`loads` on each link [N], shape (W*L,); that at the end of the step is added.
            weight: Share of the step in ``mean_load``.
        """
        chain, work, loads, device = self.chain, self.work, self.loads, self.model.device
        poses, joints = [state_in.body_q, state_in.body_qd], [state_in.joint_q, state_in.joint_qd]
        outputs = [work, state_out.joint_q, state_out.joint_qd, state_out.body_q, state_out.body_qd]
        shape, worlds = (chain.links, self.num_envs), self.num_envs
        if self._by_warp is not None:
            inputs = [chain, *poses, state_in.body_f, control.joint_target_q, control.joint_f]
            inputs += [self.resistance, loads, dt, weight]
            outputs += [mean_load]
            shape = (worlds, THREADS)
            wp.launch(self._by_warp, shape, inputs=inputs, outputs=outputs, device=device, block_dim=THREADS)
            return
        inputs = [chain, *poses, state_in.body_f, *joints, self.resistance, loads]
        wp.launch(kernels.prepare_links, shape, inputs=inputs, outputs=[work], device=device)
        inputs = [chain, *poses, dt]
        wp.launch(solve_chain, worlds, inputs=inputs, outputs=outputs, device=device, block_dim=self._block)
        if mean_load is not None:
            inputs = [loads, work.acc_lin, work.acc_ang, weight]
            wp.launch(kernels.record_loads, shape, inputs=inputs, outputs=[mean_load], device=device)


def _linear(model: newton.Model, links: int, dofs: int) -> np.ndarray:
    """Which degrees of freedom of the first world slide, shape (D,)."""
    kind, start = model.joint_type.numpy()[:links], model.joint_qd_start.numpy()[: links + 1]
    sliding = model.joint_dof_dim.numpy()[:links, 0]
    linear = np.zeros(dofs, np.int32)
    for joint in range(links):
        if kind[joint] != JointType.FREE:
            linear[start[joint] : start[joint] + sliding[joint]] = 1
    return linear


def _check_chain(model: newton.Model, links: int) -> None:
    """Refuse what :class:`SolverArticulatedChain` cannot solve.

    Raises:
        ValueError: With the number of the first joint that does not fit.
    """
    if model.joint_count != model.body_count or model.joint_count % max(1, model.world_count):
        raise ValueError(
            f"SolverArticulatedChain needs one chain of joints a world, the first to the world; the model has "
            f"{model.joint_count} joints for {model.body_count} bodies in {model.world_count} worlds."
        )
    kind = model.joint_type.numpy()[:links]
    parent, child = model.joint_parent.numpy()[:links], model.joint_child.numpy()[:links]
    for joint in range(links):
        name = f"Joint {joint} ({JointType(kind[joint]).name})"
        if (parent[joint], child[joint]) != (joint - 1, joint):
            raise ValueError(
                f"{name} joins links {parent[joint]} and {child[joint]} instead of {joint - 1} and {joint}: "
                "SolverArticulatedChain solves serial chains, whose joints are numbered as their links."
            )
        free = kind[joint] == JointType.FREE
        if free and (joint > 0 or not _is_identity(model, joint)):
            raise ValueError(f"{name} is free; only the root may be, and at the world's origin.")
        if not free and kind[joint] not in JOINTS:
            known = ", ".join(JointType(k).name for k in JOINTS)
            raise ValueError(f"{name} is of a kind that SolverArticulatedChain does not take; it takes {known}.")


def _is_identity(model: newton.Model, joint: int) -> bool:
    frames = np.concatenate([model.joint_X_p.numpy()[joint], model.joint_X_c.numpy()[joint]])
    return bool(np.allclose(np.abs(frames), np.tile([0.0] * 6 + [1.0], 2), atol=1e-6))
