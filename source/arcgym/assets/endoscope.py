# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The endoscope as an asset: parameters for the simulation, commands from actions, state for managers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import newton
import numpy as np
import torch
import warp as wp

from arcgym.assets.endoscope_cfg import EndoscopeCfg
from arcgym.assets.endoscope_data import EndoscopeData
from arcgym.assets.endoscope_spec import capsule_half_height, shared_stiffness
from arcgym.assets.endoscope_stage import read_endoscope
from arcgym.assets.usd_loading import add_endoscope_usd
from arcgym.utils.paths import resolve_asset

if TYPE_CHECKING:
    from arcgym.sim.simulation import Simulation

FREE_COORDS = ("pos_x", "pos_y", "pos_z", "quat_x", "quat_y", "quat_z", "quat_w")
"""Names of a free root's coordinates."""


class Endoscope:
    """Endoscope of every world. L links, J joint coordinates, N worlds."""

    def __init__(self, cfg: EndoscopeCfg):
        """Read and check the stage; nothing is allocated on the device yet.

        Raises:
            StageError: If the stage cannot be used.
        """
        self.cfg = cfg
        self.path = resolve_asset(cfg.usd_path)
        self.stage = read_endoscope(self.path)

    @property
    def kind(self) -> str:
        """``capsule``, ``magnetic`` or ``proximal``."""
        return self.stage.kind

    @property
    def num_bodies(self) -> int:
        """Number of links L."""
        return self.stage.num_links

    @property
    def body_names(self) -> list[str]:
        """Names of the links, base first."""
        return [f"link_{i}" for i in range(self.num_bodies)]

    @property
    def joint_names(self) -> list[str]:
        """Names of the joint coordinates: the root's, then those of each hinge, its bending before its twist."""
        root = ("slide", "roll") if self.stage.root == "slide_roll" else FREE_COORDS
        return [*root, *(f"{'twist' if twist else 'hinge'}_{hinge}" for hinge, twist in self.stage.turns)]

    @property
    def num_joints(self) -> int:
        """Number of joint coordinates J."""
        return len(self.joint_names)

    @property
    def half_length(self) -> np.ndarray:
        """Half the axis of each link's collision capsule [m], shape (L,)."""
        pairs = zip(self.stage.link_length, self.stage.link_radius, strict=True)
        return np.array([capsule_half_height(length, radius, self.num_bodies) for length, radius in pairs])

    @property
    def tip_offset(self) -> float:
        """Distance from the centre of the last link to the front of the tip [m]."""
        return float(self.half_length[-1] + self.stage.link_radius[-1])

    @property
    def rest_insertion(self) -> float:
        """Inserted length in the rest pose [m]: the front of the tip above the anal verge."""
        return float(self._rest_height[-1]) + self.tip_offset

    @property
    def rest_height(self) -> np.ndarray:
        """Height of each link's centre above the anal verge in the rest pose [m], shape (L,)."""
        return self._rest_height

    def add_to(self, builder: newton.ModelBuilder, mass_scaling: float) -> None:
        """Load the articulation into ``builder``, scale its masses and apply the overrides.

        Args:
            builder: Builder of one world.
            mass_scaling: Factor on masses and inertias.
        """
        loaded = add_endoscope_usd(builder, self.path, self.stage)
        for body in loaded.bodies:
            builder.body_mass[body] *= mass_scaling
            builder.body_inertia[body] = builder.body_inertia[body] * mass_scaling
            builder.body_inv_mass[body] /= mass_scaling
            builder.body_inv_inertia[body] = builder.body_inv_inertia[body] / mass_scaling
        self._override_rigidity(builder, loaded.dofs)
        if self.kind == "proximal":
            limits = (self.cfg.insertion_force_limit, self.cfg.roll_torque_limit)
            for dof, limit in zip(loaded.dofs, limits, strict=False):
                if limit is not None:
                    builder.joint_effort_limit[dof] = limit
        self._rest_height = np.array([builder.body_q[body][2] for body in loaded.bodies])

    def _override_rigidity(self, builder: newton.ModelBuilder, dofs: Sequence[int]) -> None:
        stage, cfg = self.stage, self.cfg
        lever = 0.5 * (stage.link_length[:-1] + stage.link_length[1:])
        first_bent = stage.num_links - stage.bending_links
        twist = shared_stiffness(lever / (cfg.torsional_rigidity or 1.0), stage.twist_stiffness > 0.0)
        for dof, (hinge, twists) in zip(dofs[len(dofs) - len(stage.turns) :], stage.turns, strict=True):
            rigidity = cfg.tip_rigidity if hinge >= first_bent else cfg.shaft_rigidity
            stiffness = None if rigidity is None else rigidity / (2.0 * lever[hinge - 1])
            if twists:
                stiffness = None if cfg.torsional_rigidity is None else twist[hinge - 1]
            if stiffness is not None:
                _scale_turn(builder, dof, stiffness / builder.joint_target_ke[dof])

    def bind(self, sim: Simulation) -> None:
        """Connect to the arrays of a built simulation; called once by it."""
        actuation = sim.actuation
        self.camera_pose_wp: wp.array = sim.camera_pose
        self.data = EndoscopeData(self, sim)
        self._lin = wp.to_torch(actuation.tip_lin_command)
        self._ang = wp.to_torch(actuation.tip_ang_command)
        self._insertion = wp.to_torch(actuation.insertion_velocity)
        self._roll = wp.to_torch(actuation.roll_rate)
        self._bending = wp.to_torch(actuation.bending_command)
        self._turn = wp.to_torch(actuation.turn)
        self._sim = sim

    def set_tip_velocity_command(self, lin_vel: torch.Tensor, ang_vel: torch.Tensor) -> None:
        """Velocity for the tip to follow, in its own frame (+Z forward, +Y up), kept until changed.

        Args:
            lin_vel: Linear velocity [m/s], shape (N, 3).
            ang_vel: Angular velocity [rad/s], shape (N, 3).

        Raises:
            RuntimeError: If the scope is pushed from its base.
        """
        if self.kind == "proximal":
            raise RuntimeError(
                f"{self.path.name} is pushed from its base and its tip cannot be pulled; "
                "use set_insertion_command and set_bending_command."
            )
        self._lin.copy_(lin_vel)
        self._ang.copy_(ang_vel)

    def set_insertion_command(self, velocity: torch.Tensor, roll_rate: torch.Tensor) -> None:
        """Speed of the base, kept until changed.

        Args:
            velocity: Insertion [m/s], shape (N,).
            roll_rate: Roll about the shaft [rad/s], shape (N,).

        Raises:
            RuntimeError: If the scope has no driven base.
        """
        self._require_base("set_insertion_command")
        self._insertion.copy_(velocity)
        self._roll.copy_(roll_rate)

    def set_bending_command(self, pitch: torch.Tensor, yaw: torch.Tensor) -> None:
        """Angles of the bending section, approached at ``EndoscopeCfg.bending_rate`` and within its limits.

        Args:
            pitch: Bending about the tip's X axis [rad], shape (N,).
            yaw: Bending about the tip's Y axis [rad], shape (N,).

        Raises:
            RuntimeError: If the scope has no driven base.
        """
        self._require_base("set_bending_command")
        self._bending[:, 0] = pitch
        self._bending[:, 1] = yaw

    def turn_tip_target(self, angle: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | None = None) -> None:
        """Turn what the tip is driven to, beyond where it is driven now.

        Args:
            angle: Rotation vector [rad], shape (n, 3): world axes for a tip that is pulled; for a bending section its
                pitch and yaw, and the third is left out.
            env_ids: Worlds, shape (n,); all by default.
        """
        ids = slice(None) if env_ids is None else env_ids
        if self.kind == "proximal":
            self.data.bending[ids] += angle[:, :2]
            self._bending[ids] = self.data.bending[ids]
        else:
            self._turn[ids] += angle

    def _require_base(self, method: str) -> None:
        if self.kind != "proximal":
            raise RuntimeError(
                f"{self.path.name} is a {self.kind} scope without a driven base, so {method} has nothing to move; "
                "use set_tip_velocity_command."
            )

    def write_friction_to_sim(self, mu: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | None = None) -> None:
        """Set the friction coefficient between scope and wall, shape (n,), in the worlds ``env_ids``."""
        self._sim.require_two_level("friction coefficient")
        self._sim.friction[slice(None) if env_ids is None else env_ids] = mu


def _scale_turn(builder: newton.ModelBuilder, dof: int, factor: float) -> None:
    """Scale all that belongs to the elasticity of a degree of freedom."""
    for name in ("target_ke", "target_kd", "armature", "limit_ke", "limit_kd"):
        getattr(builder, f"joint_{name}")[dof] *= factor
