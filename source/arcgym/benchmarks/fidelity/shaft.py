# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A length of the shipped colonoscope's shaft in free air, and its measures as a beam.

Its base is held by the drive, far below the colon. The first link is that base, rigid as the hand that holds it: the
beam of the chain is all that follows it.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import torch

from arcgym.assets.endoscope_cfg import IntroducerCfg
from arcgym.benchmarks.fidelity.loads import LinkLoads
from arcgym.benchmarks.fidelity.models import build, shaft_spec
from arcgym.benchmarks.fidelity.rows import Run
from arcgym.benchmarks.fidelity.tubes import FREE, Tube
from arcgym.utils.math import quat_apply

IN_AIR = {"stiffness_per_length": 0.0, "damping_per_length": 0.0}
"""Introducer that does nothing."""
DEPTH = 0.4
"""How far the tip is below the colon [m]; the base may be withdrawn by half a meter."""
LINKS = 40
"""Links of the shaft."""


def shaft_in_air(
    run: Run,
    num_envs: int,
    links: int = LINKS,
    settings: dict[str, Any] | None = None,
    endoscope: dict[str, Any] | None = None,
    **spec: Any,
) -> tuple[Any, LinkLoads]:
    """Return worlds with a straight shaft below a short tube, and the loads on it.

    Args:
        run: Device and folder.
        num_envs: Worlds.
        links: Links of the shaft.
        settings: Changes of ``SimulationCfg``.
        endoscope: Changes of ``EndoscopeCfg``.
        spec: Changes of the scope's spec.
    """
    cfg = {"introducer": IntroducerCfg(**IN_AIR), **(endoscope or {})}
    sim = build(run, shaft_spec(links, **spec), Tube(0.15), num_envs, {"anchor_stiffness": FREE}, cfg, **settings or {})
    for coordinate in (sim.endoscope.data.joint_pos, sim.endoscope.data.joint_pos_target):
        coordinate[:, 0] = -DEPTH
    sim.forward()
    return sim, LinkLoads(sim)


def beam(sim: Any) -> tuple[float, float]:
    """Return the length of the chain's beam [m] and its end's place in the frame of the last link [m]."""
    length = sim.endoscope.stage.link_length
    return float(length[1:].sum()), 0.5 * float(length[-1])


def rigidity(sim: Any) -> float:
    """Return EI of the shaft's hinges [N m^2]."""
    stage = sim.endoscope.stage
    return float(stage.hinge_stiffness[0, 0] * stage.lever[0])


def end_places(sim: Any, offset: float) -> np.ndarray:
    """Return the places on the last links' axes, an offset [m] from their centers [m], shape (N, 3)."""
    data = sim.endoscope.data
    local = torch.tensor([0.0, 0.0, offset], device=sim.device).expand(sim.num_envs, 3)
    return (data.body_pos_w[:, -1] + quat_apply(data.body_quat_w[:, -1], local)).cpu().numpy()


def twist_angle(sim: Any, link: int) -> float:
    """Return the rotation of a link about the Z axis [rad]."""
    x, y, z, w = sim.endoscope.data.body_quat_w[0, link].tolist()
    return 2.0 * math.atan2(z, w)
