# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A scope laid along the centerline of a tube."""

from __future__ import annotations

from typing import Any

import numpy as np

from arcgym.benchmarks.fidelity.tubes import Tube


def follow(sim: Any, tube: Tube, inserted: float) -> None:
    """Lay the shaft along the centerline of a tube, inserted by a length [m]."""
    stage, data = sim.endoscope.stage, sim.endoscope.data
    ends = inserted - sim.endoscope.tip_offset + 0.5 * stage.link_length[-1]
    place = ends - stage.total_length + np.cumsum(stage.link_length)[:-1]
    edges = np.r_[-1.0, 0.5 * (place[1:] + place[:-1]), tube.length]
    turn = np.diff(tube.frame(np.maximum(edges, 0.0))[1])
    for coordinate in (data.joint_pos, data.joint_pos_target):
        coordinate[:, 0] = inserted - sim.endoscope.rest_insertion
    data.joint_pos[:, stage.bend_coords[:, 0]] = data.joint_pos.new_tensor(-turn)
    sim.contact.ring.fill_(-1)
    sim.forward()
