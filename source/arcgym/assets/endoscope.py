# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The endoscope as an asset: parameters for the simulation, commands from actions, state for managers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import newton
import numpy as np
import torch
import warp as wp

from arcgym.assets.actuators.actuator_base import ActuatorBase
from arcgym.assets.endoscope_cfg import EndoscopeCfg
from arcgym.assets.endoscope_data import EndoscopeData
from arcgym.assets.endoscope_spec import capsule_half_height, shared_stiffness
from arcgym.assets.endoscope_stage import TURNS, read_endoscope
from arcgym.assets.force_windows import ForceWindows, force_windows
from arcgym.assets.scope_length import stage_of_length
from arcgym.assets.usd_loading import add_endoscope_usd
from arcgym.utils.class_type import construct
from arcgym.utils.configclass import validate
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
            ValueError: If a field has no value, or an actuator cannot drive this stage.
        """
        validate(cfg)
        self.cfg = cfg
        self.path = resolve_asset(cfg.usd_path)
        if cfg.length is not None:
            self.path = stage_of_length(self.path, cfg.length)
        self.stage = read_endoscope(self.path)
        drives = {name: drive for name, drive in cfg.actuators.items() if drive is not None}
        self.actuators: dict[str, ActuatorBase] = {name: construct(drive, self) for name, drive in drives.items()}
        """Drives by name, in the order in which they act."""

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
        """Names of the joint coordinates: the root's, then every hinge's ``bend_x``, ``bend_y``, ``twist``."""
        root = ("slide", "roll") if self.stage.root == "slide_roll" else FREE_COORDS
        return [*root, *(f"{TURNS[axis]}_{hinge}" for hinge, axis in self.stage.turns)]

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
        """Distance from the center of the last link to the front of the tip [m]."""
        return float(self.half_length[-1] + self.stage.link_radius[-1])

    @property
    def force_windows(self) -> ForceWindows:
        """Lengths of scope over which the wall's force is summed up."""
        return force_windows(self.stage.link_length, self.tip_offset)

    @property
    def rest_insertion(self) -> float:
        """Inserted length in the rest pose [m]: the front of the tip above the anal verge."""
        return float(self._rest_height[-1]) + self.tip_offset

    @property
    def rest_height(self) -> np.ndarray:
        """Height of each link's center above the anal verge in the rest pose [m], shape (L,)."""
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
        for actuator in self.actuators.values():
            actuator.modify_model(builder, loaded.dofs)
        self._rest_height = np.array([builder.body_q[body][2] for body in loaded.bodies])

    def _override_rigidity(self, builder: newton.ModelBuilder, dofs: Sequence[int]) -> None:
        stage, cfg = self.stage, self.cfg
        first_bent = stage.num_links - stage.bending_links
        twist = shared_stiffness(stage.lever / (cfg.torsional_rigidity or 1.0), stage.twist_stiffness > 0.0)
        for dof, (hinge, axis) in zip(dofs[len(dofs) - len(stage.turns) :], stage.turns, strict=True):
            rigidity = cfg.tip_rigidity if hinge >= first_bent else cfg.shaft_rigidity
            stiffness = None if rigidity is None else rigidity / stage.lever[hinge - 1]
            if axis == 2:
                stiffness = None if cfg.torsional_rigidity is None else twist[hinge - 1]
            if stiffness is not None:
                _scale_turn(builder, dof, stiffness / builder.joint_target_ke[dof])
            if cfg.grading.active and hinge < first_bent and axis != 2:
                behind = float(stage.link_length[hinge:first_bent].sum())
                _scale_turn(builder, dof, cfg.grading.share(behind - ROUNDING))

    def bind(self, sim: Simulation) -> None:
        """Connect to the arrays of a built simulation; called once by it."""
        self.camera_pose_wp: wp.array = sim.scope_readout.camera_pose
        self.data = EndoscopeData(self, sim)
        self._sim = sim

    def actuator(self, name: str) -> Any:
        """Return a drive by name.

        Raises:
            ValueError: If the scope has none of that name, with those that it has.
        """
        if name not in self.actuators:
            raise ValueError(
                f"{self.path.name} has no actuator {name!r}; EndoscopeCfg.actuators has {list(self.actuators)}."
            )
        return self.actuators[name]

    def set_tip_velocity_command(self, lin_vel: torch.Tensor, ang_vel: torch.Tensor) -> None:
        """Set the velocity for a pulled tip to follow, see :meth:`arcgym.assets.actuators.TipPull.set_command`."""
        self.actuator("tip").set_command(lin_vel, ang_vel)

    def set_insertion_command(self, velocity: torch.Tensor, roll_rate: torch.Tensor) -> None:
        """Set the speed of a driven base, see :meth:`arcgym.assets.actuators.BaseDrive.set_command`."""
        self.actuator("base").set_command(velocity, roll_rate)

    def set_bending_command(self, pitch: torch.Tensor, yaw: torch.Tensor) -> None:
        """Set the angles of a bending section, see :meth:`arcgym.assets.actuators.BendingDrive.set_command`."""
        self.actuator("bending").set_command(pitch, yaw)

    def turn_tip_target(self, angle: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | None = None) -> None:
        """Turn what the tip is driven to, beyond where it is driven now.

        Args:
            angle: Rotation vector [rad], shape (n, 3): world axes for a tip that is pulled; for a bending section its
                pitch and yaw, and the third is left out.
            env_ids: Worlds, shape (n,); all by default.
        """
        for actuator in self.actuators.values():
            actuator.turn_tip(angle, slice(None) if env_ids is None else env_ids)

    def write_friction_to_sim(self, mu: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | None = None) -> None:
        """Set the friction coefficient between scope and wall, shape (n,), in the worlds ``env_ids``."""
        self._sim.require_two_level("has one friction coefficient for all worlds")
        self._sim.friction[slice(None) if env_ids is None else env_ids] = mu


ROUNDING = 1.0e-6
"""Rounding of lengths [m]."""


def _scale_turn(builder: newton.ModelBuilder, dof: int, factor: float) -> None:
    """Scale all that belongs to the elasticity of a degree of freedom."""
    for name in ("target_ke", "target_kd", "armature", "limit_ke", "limit_kd"):
        getattr(builder, f"joint_{name}")[dof] *= factor
