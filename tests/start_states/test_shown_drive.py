# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

from types import SimpleNamespace

import pytest

from arcgym.start_states import progress


def test_a_drive_is_a_line_every_ten_seconds(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = [0.0]
    monkeypatch.setattr(progress.time, "perf_counter", lambda: now[0])
    routes = [SimpleNamespace(arc=0.0, running=True), SimpleNamespace(arc=0.3, running=False)]
    drive = SimpleNamespace(routes=routes, time=0.0)
    with progress.shown("pill in 2 patients", 0.5) as report:
        for step in range(1, 8):  # 4 s a step: the lines come after 12 and 24 s
            now[0], drive.time, routes[0].arc = 4.0 * step, 0.5 * step, 0.05 * step
            report(drive)
    assert capsys.readouterr().err.splitlines() == [
        "pill in 2 patients: 0.15 of 0.50 m, 2 s simulated, 1 of 2 patients left",
        "pill in 2 patients: 0.30 of 0.50 m, 3 s simulated, 1 of 2 patients left",
    ]
