# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Event terms ``(env, env_ids, **params)``: where an episode starts and what differs between worlds."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import torch

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv


def randomize_light(env: ManagerBasedEnv, env_ids: torch.Tensor, gain: tuple[float, float] = (0.7, 1.4)) -> None:
    """Scale the brightness that the automatic exposure aims at by a log-uniform factor within ``gain``."""
    env.scene["camera"].write_light_gain(_log_uniform(env, gain, len(env_ids)), env_ids)


def randomize_color(env: ManagerBasedEnv, env_ids: torch.Tensor, gain: tuple[float, float] = (0.9, 1.1)) -> None:
    """Scale red, green and blue each by a log-uniform factor within ``gain``: white balance and mucosa of a patient."""
    env.scene["camera"].write_color_gain(_log_uniform(env, gain, len(env_ids), 3), env_ids)


def randomize_texture(env: ManagerBasedEnv, env_ids: torch.Tensor) -> None:
    """Shift the mucosa texture by a uniform offset in both directions, so that vessels are no landmarks."""
    env.scene["camera"].write_texture_offset(torch.rand(len(env_ids), 2, device=env.device), env_ids)


def randomize_tissue_stiffness(
    env: ManagerBasedEnv, env_ids: torch.Tensor, scale: tuple[float, float] = (0.5, 2.0)
) -> None:
    """Scale Young's modulus of the wall by a log-uniform factor within ``scale``."""
    env.scene["colon"].write_stiffness_scale_to_sim(_log_uniform(env, scale, len(env_ids)), env_ids)


def randomize_friction(env: ManagerBasedEnv, env_ids: torch.Tensor, friction: tuple[float, float] = (0.05, 0.2)) -> None:
    """Set the friction coefficient between scope and wall, log-uniform within ``friction``."""
    env.scene["endoscope"].write_friction_to_sim(_log_uniform(env, friction, len(env_ids)), env_ids)


def _log_uniform(env: ManagerBasedEnv, bounds: tuple[float, float], *shape: int) -> torch.Tensor:
    """Random numbers whose logarithm is uniform between the logarithms of ``bounds``, which must be positive."""
    low, high = (math.log(bound) for bound in bounds)
    return torch.exp(low + (high - low) * torch.rand(shape, device=env.device))
