# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Recorder terms: actions, observations, rewards, costs, forces, wall, poses, metrics; states at either end."""

from __future__ import annotations

from typing import Any

import torch

from arcgym.envs.mdp.image_recorders import PostStepImagesRecorderCfg
from arcgym.managers import RecorderManagerBaseCfg, RecorderTerm, RecorderTermCfg
from arcgym.managers.recorder_term import Record
from arcgym.utils.configclass import configclass

__all__ = [
    "FinalStateRecorder",
    "InitialStateRecorder",
    "PostStepMetricsRecorder",
    "PostStepMetricsRecorderCfg",
    "PostStepCostsRecorder",
    "PostStepForcesRecorder",
    "PostStepForcesRecorderCfg",
    "PostStepPosesRecorder",
    "PostStepRewardsRecorder",
    "PostStepWallRecorder",
    "PostStepWallRecorderCfg",
    "PreStepActionsRecorder",
    "PreStepObservationsRecorder",
    "PreStepObservationsRecorderCfg",
    "TrajectoryRecorderCfg",
    "WorldSettingsRecorder",
]


class PreStepActionsRecorder(RecorderTerm):
    """``actions``: the raw action, shape (T, A)."""

    def record_pre_step(self) -> Record:
        """Return the action that the step is about to apply."""
        return "actions", self._env.action_manager.action


class PreStepObservationsRecorder(RecorderTerm):
    """``obs/<group>``: what the action was chosen from, shape (T, ...); images stay uint8."""

    cfg: PreStepObservationsRecorderCfg

    def record_pre_step(self) -> Record:
        """Return the chosen groups of the last observation."""
        return "obs", {group: self._env.obs_buf[group] for group in self.cfg.groups}


class PostStepRewardsRecorder(RecorderTerm):
    """``rewards/total`` and ``rewards/<term>``, weight times value of each term before the control step, shape (T,)."""

    def record_post_step(self) -> Record:
        """Return the reward and the rate of each term."""
        env: Any = self._env
        return "rewards", {"total": env.reward_buf, **env.reward_manager.step_values}


class PostStepCostsRecorder(RecorderTerm):
    """``costs/<term>``, weight times value of each term before the control step, shape (T,)."""

    def record_post_step(self) -> Record:
        """Return the rate of each term."""
        env: Any = self._env
        return "costs", env.cost_manager.step_values


class PostStepForcesRecorder(RecorderTerm):
    """``forces/...`` [N] over the control step.

    Of the wall on the scope: ``window`` (T, K, 3) and ``window_peak`` (T, K), windows of 50 mm every 25 mm from the
    front of the tip; ``tip`` (T, 3) and ``tip_peak`` (T,). Of the drives: ``base`` (T,) and ``tip_pull`` (T, 3). With
    ``links`` also ``link`` (T, L, 3) and ``link_peak`` (T, L), which change with the links' length.
    """

    cfg: PostStepForcesRecorderCfg

    def record_post_step(self) -> Record:
        """Return the forces on the endoscope."""
        data = self._env.scene["endoscope"].data
        values = {
            "window": data.window_force_w,
            "window_peak": data.window_force_peak,
            "tip": data.tip_force_w,
            "tip_peak": data.tip_force_peak,
            "base": data.base_force,
            "tip_pull": data.tip_pull_force_w,
        }
        links = {"link": data.link_force_w, "link_peak": data.link_force_peak} if self.cfg.links else {}
        return "forces", values | links


class PostStepWallRecorder(RecorderTerm):
    """``wall/strain``, ``wall/strain_peak``, ``wall/anchor_tension``, ``wall/anchor_tension_peak`` [N], shape (T, R).

    With ``positions`` also ``wall/positions`` [m], shape (T, V, 3), with gas ``wall/lumen_pressure`` [Pa], shape (T,).
    """

    cfg: PostStepWallRecorderCfg

    def record_post_step(self) -> Record:
        """Return what the wall's rings bear."""
        data = self._env.scene["colon"].data
        names = ("wall_strain", "wall_strain_peak", "anchor_tension", "anchor_tension_peak")
        values = {name.removeprefix("wall_"): getattr(data, name) for name in names}
        gas = {} if self._env.sim.gas is None else {"lumen_pressure": data.lumen_pressure}
        return "wall", values | gas | ({"positions": data.nodal_pos_w} if self.cfg.positions else {})


class PostStepPosesRecorder(RecorderTerm):
    """``poses/...``: the scope after the step, in world coordinates."""

    NAMES = (
        "joint_pos",
        "joint_vel",
        "body_pos_w",
        "body_quat_w",
        "tip_pos_w",
        "tip_quat_w",
        "tip_arc_length",
        "inserted_length",
    )
    """Attributes of :class:`arcgym.assets.endoscope_data.EndoscopeData`."""

    def record_post_step(self) -> Record:
        """Return joint coordinates and poses."""
        data = self._env.scene["endoscope"].data
        return "poses", {name: getattr(data, name) for name in self.NAMES}


class InitialStateRecorder(RecorderTerm):
    """``initial_state/...``: everything that the episode's future depends on, for starting it again.

    The names are those of :meth:`arcgym.sim.Simulation.world_arrays`.
    """

    def record_post_reset(self, env_ids: torch.Tensor) -> Record:
        """Return the complete state of the worlds that start."""
        return "initial_state", {name: array[env_ids] for name, array in self._env.sim.world_arrays().items()}


class FinalStateRecorder(RecorderTerm):
    """``final_state/...``: the same at the episode's end, against which a replay is checked."""

    def record_pre_reset(self, env_ids: torch.Tensor) -> Record:
        """Return the complete state of the worlds that end."""
        return "final_state", {name: array[env_ids] for name, array in self._env.sim.world_arrays().items()}


class WorldSettingsRecorder(RecorderTerm):
    """``world_settings/...``: what events made different in this world: friction, moduli, light, color, texture."""

    def record_post_reset(self, env_ids: torch.Tensor) -> Record:
        """Return the settings of the worlds that start, those of a sensor below its name."""
        found: dict[str, Any] = dict(self._env.sim.world_settings())
        for name, sensor in self._env.scene.sensors.items():
            found |= {f"{name}/{key}": value for key, value in sensor.world_settings().items()}
        return "world_settings", {name: value[env_ids] for name, value in found.items()}


class PostStepMetricsRecorder(RecorderTerm):
    """``metrics/<term>``, value of metrics terms in the step, shape (T,); those that the task lacks are left out."""

    cfg: PostStepMetricsRecorderCfg

    def record_post_step(self) -> Record:
        """Return the values of the chosen terms."""
        env: Any = self._env
        values = env.metrics_manager.step_values
        return "metrics", {name: values[name] for name in self.cfg.names if name in values}


@configclass
class PreStepObservationsRecorderCfg(RecorderTermCfg):
    """Records observations; images make files large."""

    class_type: Any = PreStepObservationsRecorder
    groups: tuple[str, ...] = ("policy",)
    """Observation groups to record; their terms must be concatenated or a dict of tensors."""


@configclass
class PostStepForcesRecorderCfg(RecorderTermCfg):
    """Records forces."""

    class_type: Any = PostStepForcesRecorder
    links: bool = False
    """Whether the force on each link is recorded too, to diagnose contact. Publish the windows."""


@configclass
class PostStepWallRecorderCfg(RecorderTermCfg):
    """Records strain and anchor tension."""

    class_type: Any = PostStepWallRecorder
    positions: bool = False
    """Whether every wall vertex is recorded too: some 20 kB a step and world, for drawing an episode again."""


@configclass
class PostStepMetricsRecorderCfg(RecorderTermCfg):
    """Records metrics of every step."""

    class_type: Any = PostStepMetricsRecorder
    names: tuple[str, ...] = ("progress", "s_c", "s_o", "looping_ratio")
    """Metrics terms of the task to record in every step. All of them are in ``info`` at the episode's end anyway."""


@configclass
class TrajectoryRecorderCfg(RecorderManagerBaseCfg):
    """Everything but images; a step and world is some 4 kB before compression."""

    initial_state = RecorderTermCfg(class_type=InitialStateRecorder)
    final_state = RecorderTermCfg(class_type=FinalStateRecorder)
    world_settings = RecorderTermCfg(class_type=WorldSettingsRecorder)
    actions = RecorderTermCfg(class_type=PreStepActionsRecorder)
    observations: PreStepObservationsRecorderCfg | None = None
    """Off: ``PreStepObservationsRecorderCfg()`` records the group ``policy``."""
    rewards = RecorderTermCfg(class_type=PostStepRewardsRecorder)
    costs = RecorderTermCfg(class_type=PostStepCostsRecorder)
    forces: PostStepForcesRecorderCfg | None = PostStepForcesRecorderCfg()
    """Forces on tip and windows, of base and pull."""
    wall: PostStepWallRecorderCfg | None = PostStepWallRecorderCfg()
    """Strain and anchor tension."""
    poses = RecorderTermCfg(class_type=PostStepPosesRecorder)
    metrics: PostStepMetricsRecorderCfg | None = PostStepMetricsRecorderCfg()
    """Progress, view of the lumen and looping ratio of every step."""
    images: PostStepImagesRecorderCfg | None = None
    """Off: ``PostStepImagesRecorderCfg()`` records pictures with depth, normals and labels."""
    hand: RecorderTermCfg | None = None
    """Who chose the action; set by teleoperation."""
    marks: RecorderTermCfg | None = None
    """Complete states at the marks; set by teleoperation."""
