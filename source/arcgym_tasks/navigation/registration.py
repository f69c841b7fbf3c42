# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Names of the navigation tasks and where their configurations are; imports neither torch nor Newton."""

from __future__ import annotations

from arcgym.utils.registry import register_task

SEGMENTS = ("Rectum", "Sigmoid", "Descending", "Splenic")
"""Segments that have a task, as they are written in task and class names."""


def register_robot(robot: str, package: str) -> None:
    """Register the tasks of a robot and their ``-Play`` variants.

    Args:
        robot: Name as written in task and class names, such as ``Proximal``.
        package: Package with ``env_cfg`` (classes ``<Segment><Robot>EnvCfg`` and ``..._PLAY``) and
            ``agents.rsl_rl_cfg`` (classes ``<Segment><Robot>PPORunnerCfg``).
    """
    for segment in SEGMENTS:
        for variant, suffix in (("", ""), ("-Play", "_PLAY")):
            register_task(
                f"ARC-{segment}-{robot}{variant}",
                env_cfg_entry_point=f"{package}.env_cfg:{segment}{robot}EnvCfg{suffix}",
                rsl_rl_cfg_entry_point=f"{package}.agents.rsl_rl_cfg:{segment}{robot}PPORunnerCfg",
            )
