# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A folder is of one maker."""

from __future__ import annotations

from pathlib import Path

import pytest

from arcgym.utils.errors import UsageError
from arcgym.utils.made_by import check_made_by


def test_another_maker_is_refused_once_something_is_made(tmp_path: Path) -> None:
    folder = tmp_path / "rows"
    check_made_by(folder, {"seed": 1, "overrides": ("a",)}, "*.jsonl")
    check_made_by(folder, {"seed": 2, "overrides": ("a",)}, "*.jsonl")  # nothing was made with the first
    (folder / "rows.jsonl").touch()
    check_made_by(folder, {"seed": 2, "overrides": ["a"]}, "*.jsonl")
    with pytest.raises(UsageError, match="was made with seed 2, and now it is 3: both would count as one"):
        check_made_by(folder, {"seed": 3, "overrides": ["a"]}, "*.jsonl")


def test_what_was_made_before_there_was_such_a_file_is_taken_over(tmp_path: Path) -> None:
    (tmp_path / "rows.jsonl").touch()
    check_made_by(tmp_path, {"seed": 1}, "*.jsonl")
    with pytest.raises(UsageError, match="seed 1, and now it is 2"):
        check_made_by(tmp_path, {"seed": 2}, "*.jsonl")
