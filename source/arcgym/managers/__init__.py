# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Managers: observations, actions, rewards, costs, terminations, events, curricula, metrics and records made of terms.

They know nothing of colons or scopes; terms do.
"""

from arcgym.managers.action_manager import ActionManager, ActionTerm
from arcgym.managers.cost_manager import CostManager
from arcgym.managers.curriculum_manager import CurriculumManager
from arcgym.managers.event_manager import EventManager
from arcgym.managers.manager_base import ManagerBase
from arcgym.managers.metrics_manager import MetricsManager
from arcgym.managers.noise import ConstantNoiseCfg, GaussianNoiseCfg, NoiseCfg, UniformNoiseCfg
from arcgym.managers.observation_manager import ObservationManager
from arcgym.managers.recorder_cfg import RecorderManagerBaseCfg, RecorderTermCfg
from arcgym.managers.recorder_files import Episode, RecordingError, count_episodes, episode_paths, load_episodes
from arcgym.managers.recorder_joining import export_hdf5
from arcgym.managers.recorder_manager import RecorderManager
from arcgym.managers.recorder_term import RecorderTerm
from arcgym.managers.recorder_writer import save_episode
from arcgym.managers.reward_manager import RewardManager
from arcgym.managers.scene_entity_cfg import SceneEntityCfg
from arcgym.managers.sensor_use import reads_no_sensor
from arcgym.managers.term_base import ManagerTermBase
from arcgym.managers.term_cfg import (
    ActionTermCfg,
    CostTermCfg,
    CurriculumTermCfg,
    EventTermCfg,
    ManagerTermBaseCfg,
    MetricsTermCfg,
    ObservationGroupCfg,
    ObservationTermCfg,
    RewardTermCfg,
    TerminationTermCfg,
)
from arcgym.managers.termination_manager import TerminationManager

__all__ = [
    "ActionManager",
    "ActionTerm",
    "ActionTermCfg",
    "ConstantNoiseCfg",
    "CostManager",
    "CostTermCfg",
    "CurriculumManager",
    "CurriculumTermCfg",
    "Episode",
    "EventManager",
    "EventTermCfg",
    "GaussianNoiseCfg",
    "ManagerBase",
    "ManagerTermBase",
    "ManagerTermBaseCfg",
    "MetricsManager",
    "MetricsTermCfg",
    "NoiseCfg",
    "ObservationGroupCfg",
    "ObservationManager",
    "ObservationTermCfg",
    "RecorderManager",
    "RecorderManagerBaseCfg",
    "RecorderTerm",
    "RecorderTermCfg",
    "RecordingError",
    "RewardManager",
    "RewardTermCfg",
    "SceneEntityCfg",
    "TerminationManager",
    "TerminationTermCfg",
    "UniformNoiseCfg",
    "count_episodes",
    "episode_paths",
    "export_hdf5",
    "load_episodes",
    "reads_no_sensor",
    "save_episode",
]
