# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Files that grow by lines."""

from __future__ import annotations

from pathlib import Path

from arcgym.benchmarks.experts.table import read_rows
from arcgym.utils.lines import append_line


def test_lines_follow_each_other_in_a_folder_that_is_made(tmp_path: Path) -> None:
    path = tmp_path / "new" / "rows.jsonl"
    append_line(path, "first")
    append_line(path, "zweite Zeile – länger")
    assert path.read_text(encoding="utf-8") == "first\nzweite Zeile – länger\n"


def test_a_line_after_a_torn_one_is_whole(tmp_path: Path) -> None:
    """A process was killed while it wrote the second row: the next one's row is not lost with it."""
    path = tmp_path / "rows.jsonl"
    path.write_text('{"patient": 1}\n{"patie')
    append_line(path, '{"patient": 3}')
    assert read_rows(path) == [{"patient": 1}, {"patient": 3}]
