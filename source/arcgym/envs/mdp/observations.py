# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Observation terms ``(env, **params) -> (N, ...)``: images for the policy, privileged state for the critic.

Privileged terms are scaled so that their entries are of order one; each docstring names shape and scale.
Forces and strains as they are, in their own units, are :func:`arcgym.envs.mdp.load_parts`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import torch
import warp as wp

from arcgym.anatomy.segments import SEGMENTS
from arcgym.assets.force_windows import ABUTTING
from arcgym.envs.mdp.centerline import points_ahead
from arcgym.envs.mdp.loads import load, load_parts
from arcgym.envs.mdp.lumen import LUMEN_PRESETS, LumenCfg, lumen_scores
from arcgym.envs.mdp.segments import segment_progress
from arcgym.managers import ManagerTermBase, ObservationTermCfg, SceneEntityCfg
from arcgym.utils.math import quat_apply_inverse
from arcgym.utils.validation import POSITIVE, Range, expects
from arcgym.utils.worlds import fill_worlds

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv

__all__ = [
    "base_force",
    "centerline_ahead",
    "depth",
    "drive_forces",
    "inserted_length",
    "insertion_depth",
    "last_action",
    "lumen_state",
    "recent_advance",
    "rgb",
    "shaft_shape",
    "target_lead",
    "tip_axis_distance",
    "tip_bending",
    "tip_force_vector",
    "tip_lumen_direction",
    "tip_progress",
    "tip_velocity",
    "wall_forces",
]

LOOK_AHEAD = (0.01, 0.02, 0.04, 0.08)
"""Arc lengths ahead of the tip [m] at which :class:`centerline_ahead` looks: half to four scope diameters."""

RECENT = (1.0, 3.0, 10.0)
"""Windows [s] over which :class:`recent_advance` looks back."""

_CAMERA = SceneEntityCfg("camera")


def rgb(env: ManagerBasedEnv, sensor_cfg: SceneEntityCfg = _CAMERA) -> torch.Tensor:
    """Color image, shape (N, 3, H, W), uint8: a view of the camera's memory, from which the observation is copied.

    Args:
        sensor_cfg: The camera.
    """
    return env.scene[sensor_cfg.name].data.output["rgb"].permute(0, 3, 1, 2)


@expects(far=POSITIVE)
def depth(env: ManagerBasedEnv, far: float = 0.1, sensor_cfg: SceneEntityCfg = _CAMERA) -> torch.Tensor:
    """Depth image over a far distance, in [0, 1], shape (N, 1, H, W), float32.

    Args:
        far: Depth that becomes one [m].
        sensor_cfg: The camera.
    """
    return (env.scene[sensor_cfg.name].data.output["depth"].unsqueeze(1) / far).clamp(0.0, 1.0)


def tip_lumen_direction(env: ManagerBasedEnv) -> torch.Tensor:
    """Return the unit direction of the lumen at the tip, in the tip frame (+Z forward), shape (N, 3)."""
    data = env.scene["endoscope"].data
    return quat_apply_inverse(data.tip_quat_w, data.tip_lumen_direction_w)


@expects(distances=POSITIVE)
class centerline_ahead(ManagerTermBase):
    """Points of the deformed centerline ahead of the tip, in the tip frame, each over its distance, shape (N, 3 K).

    Beyond the end of the centerline its last point is taken.
    """

    def __init__(self, cfg: ObservationTermCfg, env: ManagerBasedEnv) -> None:
        """Keep the distances on the device."""
        super().__init__(cfg, env)
        self._ahead = torch.tensor(cfg.params.get("distances", LOOK_AHEAD), device=env.device)

    def __call__(self, env: ManagerBasedEnv, distances: Sequence[float] = LOOK_AHEAD) -> torch.Tensor:
        """Return the points.

        Args:
            distances: Arc lengths ahead of the tip [m], shape (K,), read once at construction.
        """
        return (points_ahead(env, self._ahead) / self._ahead[:, None]).flatten(1)


@expects(segment=SEGMENTS)
def tip_progress(env: ManagerBasedEnv, segment: str | None = None) -> torch.Tensor:
    """Way of the tip through the segment, 0 at its start and 1 at its end, shape (N, 1).

    Args:
        segment: Name of the segment; None takes the task's, ``env.cfg.segment``.
    """
    return segment_progress(env, segment).unsqueeze(1)


@expects(windows_s=POSITIVE, scale=POSITIVE)
class recent_advance(ManagerTermBase):
    """Advance of the tip along the lumen over each of several windows, over a scale, shape (N, K).

    It tells a critic how long a tip has been stuck, which its present state does not. Before a window has passed since
    the world's reset, its advance is that since the reset.
    """

    def __init__(self, cfg: ObservationTermCfg, env: ManagerBasedEnv) -> None:
        """Allocate the ring buffer of past positions, shape (longest window + 1, N)."""
        super().__init__(cfg, env)
        windows = cfg.params.get("windows_s", RECENT)
        self._steps = torch.tensor([max(1, round(window / env.step_dt)) for window in windows], device=env.device)
        self._arc = torch.full((int(self._steps.max()) + 1, env.num_envs), torch.nan, device=env.device)
        self._now, self._step = 0, -1

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Forget the past of the given worlds."""
        fill_worlds(self._arc, env_ids, torch.nan, dim=1)

    def __call__(self, env: ManagerBasedEnv, windows_s: Sequence[float] = RECENT, scale: float = 0.05) -> torch.Tensor:
        """Return the advances until now; a second call in a control step sees the same past.

        Args:
            windows_s: Lengths of the windows [s], shape (K,), read once at construction.
            scale: Advance that becomes one [m].
        """
        arc = env.scene["endoscope"].data.tip_arc_length
        self._now = (self._now + (env.common_step_counter != self._step)) % len(self._arc)
        self._step = env.common_step_counter
        self._arc.copy_(torch.where(self._arc.isnan(), arc, self._arc))
        self._arc[self._now] = arc
        return ((arc - self._arc[(self._now - self._steps) % len(self._arc)]) / scale).T


@expects(scale=POSITIVE)
def tip_axis_distance(env: ManagerBasedEnv, scale: float = 0.02) -> torch.Tensor:
    """Distance of the tip from the deformed centerline over a scale, shape (N, 1).

    Args:
        scale: Distance that becomes one [m].
    """
    return env.scene["endoscope"].data.tip_centerline_distance.unsqueeze(1) / scale


@expects(linear_scale=POSITIVE, angular_scale=POSITIVE)
def tip_velocity(env: ManagerBasedEnv, linear_scale: float = 0.05, angular_scale: float = 2.0) -> torch.Tensor:
    """Linear and angular velocity of the tip in its frame, each over its scale, shape (N, 6).

    Args:
        linear_scale: Speed that becomes one [m/s].
        angular_scale: Turning rate that becomes one [rad/s].
    """
    data = env.scene["endoscope"].data
    velocity = torch.stack((data.tip_lin_vel_w / linear_scale, data.tip_ang_vel_w / angular_scale), dim=1)
    return quat_apply_inverse(data.tip_quat_w.unsqueeze(1), velocity).flatten(1)


def tip_bending(env: ManagerBasedEnv) -> torch.Tensor:
    """Commanded bending in pitch and yaw over pi, shape (N, 2)."""
    return env.scene["endoscope"].data.bending / math.pi


def inserted_length(env: ManagerBasedEnv) -> torch.Tensor:
    """Return the inserted length [m] and its excess over the tip's arc length over 0.1 m (loops), shape (N, 2)."""
    data = env.scene["endoscope"].data
    return torch.stack((data.inserted_length, (data.inserted_length - data.tip_arc_length) / 0.1), dim=1)


@expects(scale=POSITIVE)
def insertion_depth(env: ManagerBasedEnv, scale: float = 1.0) -> torch.Tensor:
    """Return the length of scope inside the anus over a scale, as marks on the shaft give it, shape (N, 1).

    Args:
        scale: Length that becomes one [m].
    """
    return env.scene["endoscope"].data.inserted_length.unsqueeze(1) / scale


@expects(points=Range(1), spacing=POSITIVE, scale=POSITIVE)
class shaft_shape(ManagerTermBase):
    """Places along the shaft in the tip's frame over a scale, as a fiber or magnetic imaging gives, shape (N, 3 K).

    Each is the center of the link nearest to its distance from the front of the tip; beyond the base,
    that of the base. A capsule's are all its own center.
    """

    def __init__(self, cfg: ObservationTermCfg, env: ManagerBasedEnv) -> None:
        """Choose the links."""
        super().__init__(cfg, env)
        scope = env.scene["endoscope"]
        length = torch.as_tensor(scope.stage.link_length, dtype=torch.float32)
        behind = length.flip(0).cumsum(0).flip(0) - 0.5 * length
        wanted = cfg.params.get("spacing", 0.05) * torch.arange(1, cfg.params.get("points", 12) + 1)
        self._links = (behind[None] - wanted[:, None]).abs().argmin(dim=1).to(env.device)

    def __call__(
        self, env: ManagerBasedEnv, points: int = 12, spacing: float = 0.05, scale: float = 0.2
    ) -> torch.Tensor:
        """Return the places.

        Args:
            points: Number of places K, read once at construction.
            spacing: Length of shaft between them [m], read once at construction.
            scale: Distance that becomes one [m].
        """
        data = env.scene["endoscope"].data
        away = data.body_pos_w[:, self._links] - data.tip_pos_w[:, None]
        quat = data.tip_quat_w[:, None].expand(-1, len(self._links), -1)
        return (quat_apply_inverse(quat, away) / scale).flatten(1)


def wall_forces(env: ManagerBasedEnv) -> torch.Tensor:
    """``log(1 + F / 1 N)`` of the force on the wall by the tip, by the hardest pressing window, by all, shape (N, 3).

    The last is the sum over windows that abut. The size is the same for every scope.
    """
    force = load_parts(env, "shaft_force")
    tip, total = load(env, "tip_force"), force[:, ::ABUTTING].sum(dim=1)
    return torch.log1p(torch.stack((tip, force.amax(dim=1), total), dim=1))


def drive_forces(env: ManagerBasedEnv) -> torch.Tensor:
    """``log(1 + F / 1 N)`` of the push at the base and of the pull at the tip, shape (N, 2)."""
    data = env.scene["endoscope"].data
    return torch.log1p(torch.stack((data.base_force.abs(), data.tip_pull_force_w.norm(dim=-1)), dim=1))


@expects(linear_scale=POSITIVE, angular_scale=POSITIVE)
def target_lead(
    env: ManagerBasedEnv, actuator_name: str = "tip", linear_scale: float = 0.01, angular_scale: float = 1.0
) -> torch.Tensor:
    """How far the target of a pulled tip is ahead of it, in the tip's frame: way and turn over scales, shape (N, 6).

    No picture shows it, and it takes as long to undo as it took to grow.

    Args:
        actuator_name: Which of ``EndoscopeCfg.actuators``, a :class:`arcgym.assets.TipPullCfg`.
        linear_scale: Way that becomes one [m].
        angular_scale: Turn that becomes one [rad].
    """
    scope = env.scene["endoscope"]
    pull = scope.actuator(actuator_name)
    ahead = torch.stack((wp.to_torch(pull.lead) / linear_scale, wp.to_torch(pull.turn) / angular_scale), dim=1)
    return quat_apply_inverse(scope.data.tip_quat_w.unsqueeze(1), ahead).flatten(1)


def tip_force_vector(env: ManagerBasedEnv) -> torch.Tensor:
    """Force of the wall on the tip in its frame [N], as a sensor in the tip feels it, shape (N, 3)."""
    data = env.scene["endoscope"].data
    return quat_apply_inverse(data.tip_quat_w, data.tip_force_w)


def base_force(env: ManagerBasedEnv) -> torch.Tensor:
    """Push on the base [N], negative for a pull, mean over the control step, shape (N, 1)."""
    return env.scene["endoscope"].data.base_force.unsqueeze(1)


def last_action(env: ManagerBasedEnv) -> torch.Tensor:
    """Raw action of the last step, shape (N, A)."""
    return env.action_manager.action


@expects(lumen=LUMEN_PRESETS)
def lumen_state(env: ManagerBasedEnv, lumen: str | LumenCfg | None = None) -> torch.Tensor:
    """Parts of the lumen reward ``s_c, s_1, s_2, s_3, s_o``, of order one as they are, shape (N, 5).

    Args:
        lumen: Constants of the scores, or a preset's name; None takes the task's, ``env.cfg.lumen``.
    """
    scores = lumen_scores(env, lumen)
    return torch.stack((scores.s_c, scores.s_1, scores.s_2, scores.s_3, scores.s_o), dim=1)
