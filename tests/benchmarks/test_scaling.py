# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Scaling is read from logs written here."""

from __future__ import annotations

from pathlib import Path

import pytest
from torch.utils.tensorboard import SummaryWriter

from arcgym.benchmarks.scaling.measure import RATES, Settings, add_factors, command, read_rates

SETTINGS = Settings("ARC-Rectum-Capsule", "ppo", "cuda", 8, 5, ["env.lumen=metric"])


def test_the_first_iterations_do_not_count(tmp_path):
    with SummaryWriter(str(tmp_path)) as log:
        for iteration, value in enumerate([1.0, 2.0, 3.0, 100.0, 300.0, 200.0]):
            for tag in RATES.values():
                log.add_scalar(tag, value, iteration)
    assert read_rates(tmp_path) == {"steps/s": 200.0, "collect s": 200.0, "learn s": 200.0}


def test_the_factor_is_over_the_first_row():
    rows = [{"steps/s": 100.0}, {"error": "no memory"}, {"steps/s": 190.0}]
    add_factors(rows)
    assert [row.get("factor") for row in rows] == [1.0, None, 1.9]


@pytest.mark.parametrize(("processes", "started_by"), [(1, ["-m", "arcgym"]), (2, ["-m", "torch.distributed.run"])])
def test_torchrun_starts_more_than_one_process(processes, started_by):
    words = command(SETTINGS, processes, Path("run"))
    assert words[1:3] == started_by
    assert ("--distributed" in words) == (processes > 1)
    assert words[-1] == "env.lumen=metric"
