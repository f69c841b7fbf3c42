# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""An environment reduced to what managers need: worlds, a device, a scene of named entities, two clocks."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch

from arcgym.utils.world_random import WorldRandom

JOINTS = ["root_slide", "root_roll", "hinge_1", "hinge_2", "hinge_3"]


class Scene(dict):
    """Entities by name."""

    device = "cpu"


@pytest.fixture
def env() -> Any:
    """Two worlds with ``value`` (2,), a scope with five joints and a colon with four wall nodes."""
    scope = SimpleNamespace(joint_names=JOINTS, body_names=["link_0", "link_1", "tip"])
    wall = SimpleNamespace(segment=np.array([0, 1, 1, 2]))
    colon = SimpleNamespace(patients=[SimpleNamespace(wall=wall)])
    return SimpleNamespace(
        num_envs=2,
        device="cpu",
        scene=Scene(endoscope=scope, colon=colon),
        step_dt=0.1,
        max_episode_length_s=2.0,
        value=torch.tensor([1.0, 3.0]),
        sim=SimpleNamespace(non_finite=torch.zeros(2, dtype=torch.bool)),
        random=WorldRandom(2, "cpu", seed=0),
        host_ids=lambda env_ids: env_ids,
    )
