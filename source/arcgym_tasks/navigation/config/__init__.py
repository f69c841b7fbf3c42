# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""The robots, one module each; importing this package registers their tasks and loads none of them."""

from __future__ import annotations

from arcgym_tasks.navigation.registration import register_robot

ROBOTS = {
    "Capsule": "arcgym_tasks.navigation.config.capsule:CapsuleEnvCfg",
    "Magnetic": "arcgym_tasks.navigation.config.magnetic:MagneticEnvCfg",
    "Proximal": "arcgym_tasks.navigation.config.proximal:ProximalEnvCfg",
}
"""Environment configuration by robot, as written in task names."""

for _robot, _env_cfg in ROBOTS.items():
    register_robot(_robot, _env_cfg)
