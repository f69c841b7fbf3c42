# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

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
