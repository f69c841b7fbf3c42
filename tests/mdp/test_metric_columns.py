# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Every metric of the insertion tasks over one episode of four steps whose readings are set by hand."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import torch
from drawn_shafts import up_and_round, zigzag

from arcgym.anatomy.segments import SEGMENTS
from arcgym.managers import MetricsManager
from arcgym_tasks.navigation.metrics import MetricsCfg
from arcgym_tasks.navigation.withdrawal_cfg import WithdrawalMetricsCfg

ROOT = Path(__file__).parents[2]

STRAIGHT = torch.stack([torch.zeros(41), torch.zeros(41), torch.linspace(0.0, 0.4, 41)], 1)
STEPS = (
    {"arc": 0.10, "inserted": 0.10, "tip": (1, 2), "shaft": (3, 5), "base": 2, "view": "flat"},
    {"arc": 0.20, "inserted": 0.20, "tip": (3, 4), "shaft": (1, 6), "base": -7, "view": "flat"},
    {"arc": 0.30, "inserted": 0.25, "tip": (6, 9), "shaft": (20, 25), "base": 3, "view": "corner"},
    {"arc": 0.28, "inserted": 0.30, "tip": (4, 5), "shaft": (4, 8), "base": 1, "view": "red"},
)
SHAPES = (STRAIGHT, zigzag(0.05), up_and_round(0.06), up_and_round(-0.06))
EXPECTED = {
    "success": 0.0,
    "patient_index": 0.0,
    "progress": (0.30 - 0.10) / 0.40,  # the largest, through the sigmoid from 0.1 to 0.5 m
    "time_to_success": 10.0,  # the time limit
    "s_c": (1.0 + 1.0 + 0.0 + 1.0) / 4,  # a deep corner has none
    "s_o": (-1.0 - 1.0 + 0.2 - 1.0) / 4,
    "centered_rate": 0.75,
    "visible_rate": 0.25,
    "red_out_rate": 0.25,
    "centerline_distance": (1.0 + 2.0 + 3.0 + 4.0) / 4 * 1e-3,
    "max_tip_force": 6.0,
    "mean_tip_force": (1.0 + 3.0 + 6.0 + 4.0) / 4,
    "p95_tip_force": 6.0,  # of four steps the largest
    "peak_tip_force": 9.0,
    "tip_impulse": (1.0 + 3.0 + 6.0 + 4.0) * 0.1,
    "tip_time_above_comfort": 0.3,  # 2 N
    "tip_time_above_unsafe": 0.1,  # 5 N
    "tip_time_above_perforation": 0.0,  # 14.1 N
    "max_shaft_force": 20.0,
    "mean_shaft_force": (3.0 + 1.0 + 20.0 + 4.0) / 4,
    "p95_shaft_force": 20.0,
    "peak_shaft_force": 25.0,
    "shaft_impulse": (3.0 + 1.0 + 20.0 + 4.0) * 0.1,
    "shaft_time_above_comfort": 0.3,
    "shaft_time_above_unsafe": 0.1,
    "shaft_time_above_perforation": 0.1,
    "max_base_force": 7.0,  # a pull
    "max_wall_strain": 0.4,
    "max_anchor_tension": 1.5,
    "inserted_length": 0.30,
    "max_mesentery_stretch": 0.02,  # 8 cm with 6 of slack
    "looping_ratio": 0.30 / 0.28,
    "loop_type": 3.0,  # a reverse alpha at the end
    "n_loop_rate": 0.25,
    "alpha_rate": 0.25,
    "reverse_alpha_rate": 0.25,
    "paradoxical_motion": 0.05,  # pushed in while the tip slid back from 0.30 to 0.28 m
    "path_efficiency": 0.18 / 0.22,  # 18 cm of way in 20 cm up and 2 down
}


def hang(env) -> None:
    """A sigmoid of three rings, the middle one with 6 cm of slack."""
    codes = [SEGMENTS.index(name) for name in ("rectum", "sigmoid", "sigmoid")]
    env.scene["colon"].patients[0].wall = SimpleNamespace(
        layer=np.zeros(6, int),
        ring=np.repeat([0, 1, 2], 2),
        ring_arc=np.array([0.0, 0.1, 0.2]),
        points=np.array([[x, 0.0, z] for z in (0.0, 0.1, 0.2) for x in (-0.02, 0.02)]),
        segment=np.repeat(codes, 2),
    )
    env.scene["colon"].anchor_springs = lambda patient: SimpleNamespace(slack=np.repeat([0.0, 0.06, 0.0], 2))
    data = env.scene["colon"].data
    data.centerline_pos_w = torch.tensor([[[0.0, 0.0, z] for z in (0.0, 0.1, 0.2)]] * 2)
    data.centerline_arc = torch.tensor([[0.0, 0.1, 0.2]] * 2)


def set_readings(env, number: int, step: dict) -> None:
    """World 0 reads what the step says; world 1 rests, and is past the sigmoid's end in the last step."""
    scope, colon, depth = env.scope, env.scene["colon"].data, env.scene["camera"].data.output["depth"]
    env.common_step_counter += 1
    env.episode_length_buf += 1
    env.scene["camera"].data.frame += 1
    scope.tip_arc_length = torch.tensor([step["arc"], 0.2 if number < 3 else 0.5])
    scope.inserted_length = torch.tensor([step["inserted"], 0.2])
    scope.tip_pos_w = torch.tensor([[0.0, 0.0, step["arc"]], [0.0, 0.0, 0.2]])
    scope.tip_centerline_distance = torch.tensor([0.001 * (number + 1), 0.0])
    scope.base_force = torch.tensor([float(step["base"]), 0.0])
    scope.tip_force_w[0, 0], scope.tip_force_peak[0] = step["tip"]
    scope.window_force_w[0, 1, 2], scope.window_force_peak[0, 1] = step["shaft"]
    scope.body_pos_w = torch.stack((SHAPES[number], STRAIGHT))
    depth[:] = 0.004 if step["view"] == "red" else 0.05
    depth[0, 0, 0] = 0.2 if step["view"] == "corner" else depth[0, 1, 1]
    colon.wall_strain_peak[0, 2] = (0.1, 0.4, 0.2, 0.3)[number]
    colon.anchor_tension_peak[0, 4] = (0.5, 1.5, 1.0, 0.0)[number]
    colon.centerline_pos_w[0, 1, 0] = (0.0, 0.05, 0.08, 0.07)[number]


@pytest.fixture
def finished(env) -> dict[str, torch.Tensor]:
    hang(env)
    env.scope.body_pos_w = torch.stack((STRAIGHT, STRAIGHT))
    manager = MetricsManager(MetricsCfg(), env)
    manager.reset()
    for number, step in enumerate(STEPS):
        set_readings(env, number, step)
        manager.compute()
    manager.reset()
    return manager.finished


def test_the_table_has_every_metric(finished) -> None:
    assert set(finished) == set(EXPECTED)


def test_every_column_is_defined_in_the_docs() -> None:
    """Figures of tip and shaft share lines: their names are given without the part, and with ``<tier>``."""
    told = set(re.findall(r"`(\w+|\w+<tier>)`", (ROOT / "docs" / "metrics.md").read_text()))
    shared = {f"{kind}_{part}_force" for kind in ("max", "mean", "p95", "peak") for part in ("tip", "shaft")}
    shared |= {
        f"{part}_time_above_{tier}" for part in ("tip", "shaft") for tier in ("comfort", "unsafe", "perforation")
    }
    assert {"max_", "mean_", "p95_", "peak_tip_force", "peak_shaft_force", "tip_time_above_<tier>"} <= told
    columns = {field.name for cfg in (MetricsCfg, WithdrawalMetricsCfg) for field in dataclasses.fields(cfg)}
    assert columns - shared - {"patient_index"} <= told  # a trial names its patient itself


@pytest.mark.parametrize("name", EXPECTED)
def test_a_metric_of_the_episode(finished, name: str) -> None:
    assert float(finished[name][0]) == pytest.approx(EXPECTED[name], abs=1e-6)


def test_an_episode_that_arrives_says_when(finished) -> None:
    arrived = {name: float(finished[name][1]) for name in ("success", "progress", "time_to_success")}
    assert arrived == pytest.approx({"success": 1.0, "progress": 1.0, "time_to_success": 0.4})
