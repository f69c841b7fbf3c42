# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Action terms: raw actions in [-1, 1] become velocity commands of the tip or of the base."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import torch
import warp as wp

from arcgym.envs.mdp.back_off import BackOff
from arcgym.envs.mdp.roll_oscillation import RollOscillation
from arcgym.managers import ActionTerm, ActionTermCfg
from arcgym.utils.configclass import configclass
from arcgym.utils.validation import Range, require, require_non_negative, require_positive
from arcgym.utils.worlds import fill_worlds

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv

__all__ = ["InsertionAction", "InsertionActionCfg", "TipVelocityAction", "TipVelocityActionCfg", "VelocityAction"]


class VelocityAction(ActionTerm):
    """Clip raw actions to [-1, 1] and scale them; a fixed axis takes no action and keeps its value.

    Subclasses name the axes and hand the result to an actuator of the asset.
    """

    axes: tuple[str, ...] = ()
    """Names of all axes, length D."""

    units: tuple[str, ...] = ()
    """Units of the commanded values, length D."""

    def __init__(self, cfg: ActionTermCfg, env: ManagerBasedEnv, scale: Sequence[float], fixed: dict[int, float]):
        """Allocate the action buffers.

        Args:
            cfg: The term's configuration.
            env: The environment.
            scale: Physical value of a raw action of one, for each axis, length D.
            fixed: Physical value of the axes without action, by index.
        """
        super().__init__(cfg, env)
        free = [axis for axis in range(len(scale)) if axis not in fixed]
        self._free, self._axes = free, torch.tensor(free, device=self.device)
        self._scale = torch.tensor([scale[axis] for axis in free], device=self.device)
        self._roll: RollOscillation | None = None
        self._raw = torch.zeros(self.num_envs, len(free), device=self.device)
        self._processed = torch.zeros(self.num_envs, len(scale), device=self.device)
        self._rest = torch.zeros(len(scale), device=self.device)
        for axis, value in fixed.items():
            self._rest[axis] = value

    def _roll_to_and_fro(self, amplitude: float, period: float) -> None:
        """Add an oscillation to the axis "roll", but with an amplitude of 0."""
        if amplitude > 0.0:
            self._roll = RollOscillation(amplitude, period, self._env.step_dt, self.num_envs, self.device)

    @property
    def action_dim(self) -> int:
        """Number of raw actions A: the axes that are not fixed."""
        return self._raw.shape[1]

    @property
    def axis_names(self) -> list[str]:
        """Name of each raw action, length A."""
        return [self.axes[axis] for axis in self._free]

    @property
    def axis_units(self) -> list[str]:
        """Unit of what each raw action commands, length A."""
        return [self.units[axis] for axis in self._free]

    @property
    def raw_actions(self) -> torch.Tensor:
        """Actions as the policy gave them, shape (N, A)."""
        return self._raw

    @property
    def processed_actions(self) -> torch.Tensor:
        """Commanded velocity of every axis [m/s or rad/s], shape (N, D)."""
        return self._processed

    def process_actions(self, actions: torch.Tensor) -> None:
        """Clip and scale ``actions``, shape (N, A)."""
        self._raw.copy_(actions)
        self._processed.copy_(self._rest.expand_as(self._processed))
        self._processed[:, self._axes] = self._raw.clamp(-1.0, 1.0) * self._scale
        if self._roll is not None:
            self._roll.advance(self._asset.data.inserted_length)
            self._processed[:, self.axes.index("roll")] += self._roll.rate

    def _as_actions(self, values: torch.Tensor) -> torch.Tensor:
        """Return the raw actions, within [-1, 1], of physical values of every axis, shape (N, D).

        The roll to and fro is none of them: it is added to whatever is commanded.
        """
        return (values[:, self._axes] / self._scale).clamp(-1.0, 1.0)

    def resume(self, step: int, env_ids: torch.Tensor | None = None) -> None:
        """Roll to and fro in the given worlds as after so many control steps."""
        if self._roll is not None:
            self._roll.resume(step, env_ids)

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Set the actions of the given worlds to zero."""
        fill_worlds(self._raw, env_ids, 0.0)
        fill_worlds(self._processed, env_ids, 0.0)
        if self._roll is not None:
            self._roll.reset(env_ids)


class TipVelocityAction(VelocityAction):
    """Velocity of the tip in its own frame: X, Y, forward, then rotation about X, Y and the axis; D = 6.

    With ``back_off_velocity`` a tip whose tether no longer comes on goes back for a while, whatever is commanded.
    """

    cfg: TipVelocityActionCfg
    axes = ("right", "up", "forward", "pitch", "yaw", "roll")
    units = ("m/s", "m/s", "m/s", "rad/s", "rad/s", "rad/s")

    def __init__(self, cfg: TipVelocityActionCfg, env: ManagerBasedEnv) -> None:
        """Find the actuator, and fix the forward velocity if the configuration does."""
        roll = cfg.angular_scale if cfg.roll_scale is None else cfg.roll_scale
        scale = [cfg.linear_scale] * 3 + [cfg.angular_scale] * 2 + [roll]
        super().__init__(cfg, env, scale, {} if cfg.forward_velocity is None else {2: cfg.forward_velocity})
        self._pull = self._asset.actuator(cfg.actuator_name)
        self._roll_to_and_fro(cfg.roll_amplitude, cfg.roll_period)
        self._back_off: BackOff | None = None
        if cfg.back_off_velocity > 0.0:
            self._back_off = BackOff(cfg.back_off_after, cfg.back_off_time, env.step_dt, self.num_envs, self.device)

    def process_actions(self, actions: torch.Tensor) -> None:
        """Clip and scale ``actions``, shape (N, A), and go back where the scope no longer comes on."""
        super().process_actions(actions)
        if self._back_off is not None:
            self._back_off.advance(self._asset.data.inserted_length)
            forward = self._processed[:, self.axes.index("forward")]
            forward.copy_(torch.where(self._back_off.active, -self.cfg.back_off_velocity, forward))

    def resume(self, step: int, env_ids: torch.Tensor | None = None) -> None:
        """Roll as after so many control steps; the wait until a tip goes back, which they do not tell, begins anew."""
        super().resume(step, env_ids)
        if self._back_off is not None:
            self._back_off.reset(env_ids)

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Set the actions of the given worlds to zero, with nothing waited."""
        super().reset(env_ids)
        if self._back_off is not None:
            self._back_off.reset(env_ids)

    def apply_actions(self) -> None:
        """Command the actuator."""
        self._pull.set_command(self._processed[:, :3], self._processed[:, 3:])

    def commanded_actions(self) -> torch.Tensor:
        """Return the raw actions of the velocities that the tip is to follow, shape (N, A)."""
        return self._as_actions(torch.cat([wp.to_torch(self._pull.linear), wp.to_torch(self._pull.angular)], dim=1))


class InsertionAction(VelocityAction):
    """Rates of a pushed scope: insertion and roll at the base, pitch and yaw of the bending section; D = 4.

    The bending rates move the bending target once a control step; the asset follows at its own speed and stops at the
    limits of its bending section.
    """

    cfg: InsertionActionCfg
    axes = ("insertion", "roll", "pitch", "yaw")
    units = ("m/s", "rad/s", "rad/s", "rad/s")

    def __init__(self, cfg: InsertionActionCfg, env: ManagerBasedEnv) -> None:
        """Find the actuators, and fix the insertion velocity if the configuration does."""
        scale = [cfg.insertion_scale, cfg.roll_scale, cfg.bending_scale, cfg.bending_scale]
        super().__init__(cfg, env, scale, {} if cfg.insertion_velocity is None else {0: cfg.insertion_velocity})
        self._base_drive = self._asset.actuator(cfg.base_name)
        self._bending_drive = self._asset.actuator(cfg.bending_name)
        self._bending = torch.zeros(self.num_envs, 2, device=self.device)
        self._roll_to_and_fro(cfg.roll_amplitude, cfg.roll_period)

    def process_actions(self, actions: torch.Tensor) -> None:
        """Clip and scale ``actions``, shape (N, A), and move the bending target by one control step."""
        super().process_actions(actions)
        self._bending = self._asset.data.bending + self._processed[:, 2:] * self._env.step_dt

    def apply_actions(self) -> None:
        """Command the actuators."""
        self._base_drive.set_command(self._processed[:, 0], self._processed[:, 1])
        self._bending_drive.set_command(self._bending[:, 0], self._bending[:, 1])

    def commanded_actions(self) -> torch.Tensor:
        """Return the raw actions of the base's commands and of the way left to the bending command, shape (N, A)."""
        base = torch.stack([wp.to_torch(self._base_drive.velocity), wp.to_torch(self._base_drive.roll_rate)], dim=1)
        left = wp.to_torch(self._bending_drive.command) - self._asset.data.bending
        return self._as_actions(torch.cat([base, left / self._env.step_dt], dim=1))


@configclass
class TipVelocityActionCfg(ActionTermCfg):
    """Configuration of :class:`TipVelocityAction`, for a capsule or a tip that a magnet pulls."""

    class_type: type[ActionTerm] | str = TipVelocityAction
    """The term's class."""

    asset_name: str = "endoscope"
    """Scene element that is commanded."""

    actuator_name: str = "tip"
    """Which of ``EndoscopeCfg.actuators`` follows, a :class:`arcgym.assets.TipPullCfg`."""

    linear_scale: float = 0.045
    """Speed along each axis at a raw action of one [m/s]. Insertions pass the colon at 40 to 50 mm/s; slower speeds
    press less on the wall and need a longer episode."""

    angular_scale: float = 1.5
    """Turning rate about each axis at a raw action of one [rad/s]: 8.6 degrees a step at 10 Hz. Raise it for tight
    bends at high speed."""

    roll_scale: float | None = None
    """Roll rate about the tip's axis at a raw action of one [rad/s]; None takes ``angular_scale``. Raise it to let a
    policy roll friction off a tether, for which scripted experts take up to 18 rad/s; the pull's torque limits it."""

    roll_amplitude: float = 0.0
    """Amplitude of a roll to and fro that is added to the commanded one [rad/s], with 0.6 m of tether inside; less with
    less. It takes friction off the tether: try 9 where tips stick that see the lumen; the picture rolls as well."""

    roll_period: float = 4.0
    """Time of one such roll to and fro [s]. A slower one goes farther along the scope."""

    back_off_velocity: float = 0.0
    """Speed at which a tip goes back along its axis whose tether no longer comes on [m/s], in place of the commanded
    forward velocity; its other axes stay the policy's. 0 leaves all to the policy. With 0.045 no policy of the research
    log passed more patients than chance explains. It takes no images: it reads the length of tether inside at the anus,
    which a capsule does not have."""

    back_off_after: float = 4.0
    """Time without 5 mm more tether inside after which the tip goes back [s]; it counts anew when it has gone back."""

    back_off_time: float = 1.5
    """Time for which it goes back [s]."""

    forward_velocity: float | None = None
    """Constant forward velocity [m/s], as in the paper; the forward action is then dropped (A = 5). None leaves it to
    the policy (A = 6)."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require_positive(self, "linear_scale", unit="m/s")
        require_positive(self, "angular_scale", "roll_scale", unit="rad/s")
        require_non_negative(self, "roll_amplitude", unit="rad/s")
        require_non_negative(self, "back_off_velocity", unit="m/s")
        require_positive(self, "roll_period", "back_off_after", "back_off_time", unit="s")
        require(self, "forward_velocity", Range(-1.0, 1.0), unit="m/s")


@configclass
class InsertionActionCfg(ActionTermCfg):
    """Configuration of :class:`InsertionAction`, for a scope that is pushed and rolled from outside the anus."""

    class_type: type[ActionTerm] | str = InsertionAction
    """The term's class."""

    asset_name: str = "endoscope"
    """Scene element that is commanded."""

    base_name: str = "base"
    """Which of ``EndoscopeCfg.actuators`` pushes and rolls, a :class:`arcgym.assets.BaseDriveCfg`."""

    bending_name: str = "bending"
    """Which of ``EndoscopeCfg.actuators`` bends, a :class:`arcgym.assets.BendingDriveCfg`."""

    insertion_scale: float = 0.05
    """Insertion speed at a raw action of one [m/s]: 5 mm a step at 10 Hz."""

    roll_scale: float = 1.0
    """Roll rate of the base at a raw action of one [rad/s]: 0.1 rad a step at 10 Hz."""

    roll_amplitude: float = 0.0
    """Amplitude of a roll to and fro that is added to the commanded one [rad/s], with 0.6 m of shaft inside; less with
    less. It takes friction off the shaft: scripted experts roll with up to 9; the picture rolls as well."""

    roll_period: float = 4.0
    """Time of one such roll to and fro [s]. A slower one goes farther along the scope."""

    bending_scale: float = 1.3
    """Rate of pitch and yaw at a raw action of one [rad/s]: 0.13 rad a step at 10 Hz, enough to steer round every bend
    at 45 mm/s. The control wheels follow at ``BendingDriveCfg.rate``; more than that has no effect."""

    insertion_velocity: float | None = None
    """Constant insertion velocity [m/s]; the insertion action is then dropped (A = 3). None leaves it to the policy
    (A = 4)."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require_positive(self, "insertion_scale", unit="m/s")
        require_positive(self, "roll_scale", "bending_scale", unit="rad/s")
        require_non_negative(self, "roll_amplitude", unit="rad/s")
        require_positive(self, "roll_period", unit="s")
        require(self, "insertion_velocity", Range(-1.0, 1.0), unit="m/s")
