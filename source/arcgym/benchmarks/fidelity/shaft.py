# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A length of the shipped colonoscope's shaft in free air, and its measures as a beam.

Its base is held by the drive, far below the colon. Hinges alternate
between two planes, fifty millimetres apart in either; each stands for the shaft half a distance to both sides. A beam
of the chain's begins and ends there, so its length differs by one link between the planes.
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

IN_AIR = {"stiffness": 0.0, "damping": 0.0}
"""Introducer that does nothing."""
DEPTH = 0.4
"""How far the tip is below the colon [m]; the base may be withdrawn by half a metre."""
LINKS = 20
"""Links of the shaft; even, so that the last hinge bends in the Y-Z plane."""


def shaft_in_air(run: Run, num_envs: int, links: int = LINKS, **spec: Any) -> tuple[Any, LinkLoads]:
    """Return worlds with a straight shaft below a short tube, and the loads on it."""
    cfg = {"introducer": IntroducerCfg(**IN_AIR)}
    sim = build(run, shaft_spec(links, **spec), Tube(0.15), num_envs, {"anchor_stiffness": FREE}, cfg)
    for coordinate in (sim.endoscope.data.joint_pos, sim.endoscope.data.joint_pos_target):
        coordinate[:, 0] = -DEPTH
    sim.forward()
    return sim, LinkLoads(sim)


def beam(sim: Any, plane: int, links: int) -> tuple[float, float]:
    """Return the length of the chain's beam in a plane [m] and its end's place in the frame of the last link [m]."""
    link = float(sim.endoscope.stage.link_length[0])
    last = links - 1
    own = [hinge for hinge in range(1, links) if (hinge % 2 == 0) == (plane == 0)]
    start, end = (own[0] - 1) * link, (own[-1] + 1) * link
    return end - start, end - (last + 0.5) * link


def rigidity(sim: Any) -> float:
    """Return EI of the shaft's hinges [N m^2]."""
    stage = sim.endoscope.stage
    return float(stage.hinge_stiffness[0] * 2.0 * stage.link_length[0])


def end_places(sim: Any, offsets: list[float]) -> np.ndarray:
    """Return the places on the last links' axes [m], shape (N, 3)."""
    data = sim.endoscope.data
    local = torch.tensor([[0.0, 0.0, offset] for offset in offsets], device=sim.device)
    return (data.body_pos_w[:, -1] + quat_apply(data.body_quat_w[:, -1], local)).cpu().numpy()


def twist_angle(sim: Any, link: int) -> float:
    """Return the rotation of a link about the Z axis [rad]."""
    x, y, z, w = sim.endoscope.data.body_quat_w[0, link].tolist()
    return 2.0 * math.atan2(z, w)
