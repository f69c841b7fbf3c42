# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Environments: scene and managers under Gymnasium's interface."""

from arcgym.envs.manager_based_env import ManagerBasedEnv
from arcgym.envs.manager_based_env_cfg import ManagerBasedEnvCfg
from arcgym.envs.manager_based_rl_env import ManagerBasedRLEnv
from arcgym.envs.manager_based_rl_env_cfg import ManagerBasedRLEnvCfg
from arcgym.envs.numpy_vector_env import NumpyVectorEnv
from arcgym.viewers.viewer_cfg import ViewerCfg

__all__ = [
    "ManagerBasedEnv",
    "ManagerBasedEnvCfg",
    "ManagerBasedRLEnv",
    "ManagerBasedRLEnvCfg",
    "NumpyVectorEnv",
    "ViewerCfg",
]
