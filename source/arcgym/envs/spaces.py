# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Gymnasium spaces of observations and actions."""

from __future__ import annotations

import gymnasium as gym
import numpy as np
import torch

from arcgym.managers import ObservationManager
from arcgym.managers.observation_group import ObservationPipeline


def observation_space(manager: ObservationManager) -> gym.spaces.Dict:
    """Return the space of one world: a box for each group, or a dict of boxes where terms are not concatenated."""
    spaces: dict[str, gym.Space] = {}
    for name, group in manager.groups.items():
        first = next(iter(group.pipelines.values()))
        if group.cfg.concatenate_terms:
            spaces[name] = _box(group.shape, first.dtype)
        else:
            spaces[name] = gym.spaces.Dict({term: _term_box(pipeline) for term, pipeline in group.pipelines.items()})
    return gym.spaces.Dict(spaces)


def batched(space: gym.Space, num_envs: int) -> gym.Space:
    """Return the space of all worlds."""
    return gym.vector.utils.batch_space(space, num_envs)


def _term_box(pipeline: ObservationPipeline) -> gym.spaces.Box:
    return _box(pipeline.shape, pipeline.dtype)


def _box(shape: tuple[int, ...], dtype: torch.dtype) -> gym.spaces.Box:
    """Bounds are those of the type for integers, infinite for the rest."""
    numpy_type = torch.empty(0, dtype=dtype).numpy().dtype
    if np.issubdtype(numpy_type, np.integer):
        limits = np.iinfo(numpy_type)
        return gym.spaces.Box(limits.min, limits.max, shape, numpy_type.type)
    return gym.spaces.Box(-np.inf, np.inf, shape, numpy_type.type)
