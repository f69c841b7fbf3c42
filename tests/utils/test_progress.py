# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

from arcgym.utils import progress
from arcgym.utils.progress import counted, report, shown


def test_stages_are_lines_where_there_is_no_terminal(capsys):
    report("before")
    with shown("worlds"):
        report("reading")
        report("building")
    report("after")
    first, second, last = capsys.readouterr().out.splitlines()
    assert (first, second) == ("worlds: reading", "worlds: building")
    assert last.startswith("worlds: ready after ")


def test_every_tenth_is_a_line(capsys):
    with counted("playing", 40) as show:
        for done in range(1, 41):
            show(done)
    lines = capsys.readouterr().out.splitlines()
    assert lines == [f"playing: {done} of 40" for done in range(4, 41, 4)]


def test_nothing_to_count_is_no_error(capsys):
    with counted("playing", 0) as show:
        show(0)
    assert capsys.readouterr().out == ""


def test_ten_seconds_without_a_tenth_are_a_line(capsys, monkeypatch):
    now = [0.0]
    monkeypatch.setattr(progress.time, "perf_counter", lambda: now[0])
    with counted("playing", 1000) as show:
        for done in range(1, 8):  # 4 s a step: the lines come after 12 and 24 s
            now[0] = 4.0 * done
            show(done)
    assert capsys.readouterr().out.splitlines() == ["playing: 3 of 1000", "playing: 6 of 1000"]
