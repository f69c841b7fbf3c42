# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Learning with rsl_rl: agent configurations, wrapper, networks that take bytes, runner, export.

Names are loaded on first use, so that configurations can be read without torch.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from arcgym.utils.lazy import lazy_names

if TYPE_CHECKING:
    from arcgym.rl.device import place as place
    from arcgym.rl.exporter import export_policy_as_jit as export_policy_as_jit
    from arcgym.rl.exporter import export_policy_as_onnx as export_policy_as_onnx
    from arcgym.rl.interrupt import TrainingInterrupted as TrainingInterrupted
    from arcgym.rl.make_env import VideoOptions as VideoOptions
    from arcgym.rl.make_env import make_env as make_env
    from arcgym.rl.model_cfg import BetaDistributionCfg as BetaDistributionCfg
    from arcgym.rl.model_cfg import CnnCfg as CnnCfg
    from arcgym.rl.model_cfg import GaussianDistributionCfg as GaussianDistributionCfg
    from arcgym.rl.model_cfg import RslRlCnnModelCfg as RslRlCnnModelCfg
    from arcgym.rl.model_cfg import RslRlMlpModelCfg as RslRlMlpModelCfg
    from arcgym.rl.models import ByteCnnModel as ByteCnnModel
    from arcgym.rl.periodic_video import PeriodicVideo as PeriodicVideo
    from arcgym.rl.run_folder import create_run_folder as create_run_folder
    from arcgym.rl.run_folder import find_checkpoint as find_checkpoint
    from arcgym.rl.run_folder import write_params as write_params
    from arcgym.rl.runner import OnPolicyRunner as OnPolicyRunner
    from arcgym.rl.runner_cfg import RslRlOnPolicyRunnerCfg as RslRlOnPolicyRunnerCfg
    from arcgym.rl.runner_cfg import RslRlPpoAlgorithmCfg as RslRlPpoAlgorithmCfg
    from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper as RslRlVecEnvWrapper

_MODULES = {
    "device": ("place",),
    "exporter": ("export_policy_as_jit", "export_policy_as_onnx"),
    "interrupt": ("TrainingInterrupted",),
    "make_env": ("VideoOptions", "make_env"),
    "model_cfg": (
        "BetaDistributionCfg",
        "CnnCfg",
        "GaussianDistributionCfg",
        "RslRlCnnModelCfg",
        "RslRlMlpModelCfg",
    ),
    "models": ("ByteCnnModel",),
    "periodic_video": ("PeriodicVideo",),
    "rollout_memory": ("describe_rollout", "rollout_bytes"),
    "run_folder": ("create_run_folder", "find_checkpoint", "write_params"),
    "runner": ("OnPolicyRunner",),
    "runner_cfg": ("RslRlOnPolicyRunnerCfg", "RslRlPpoAlgorithmCfg"),
    "vecenv_wrapper": ("RslRlVecEnvWrapper",),
}
_HOME = {name: f"arcgym.rl.{module}" for module, names in _MODULES.items() for name in names}

# rsl_rl imports GitPython, which otherwise refuses to load on a machine without git.
os.environ.setdefault("GIT_PYTHON_REFRESH", "quiet")


__getattr__ = lazy_names(__name__, _HOME)


def __dir__() -> list[str]:
    return sorted(_HOME)
