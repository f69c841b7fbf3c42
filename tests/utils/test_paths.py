# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

from pathlib import Path

import pytest

from arcgym.utils.paths import assets_dir, resolve_stage


def test_a_stage_is_named_by_file_folder_or_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stage = tmp_path / "mine" / "colon.usda"
    stage.parent.mkdir()
    stage.touch()
    monkeypatch.chdir(tmp_path)
    assert resolve_stage("mine") == resolve_stage("mine/colon.usda") == Path("mine/colon.usda")
    assert resolve_stage(stage) == stage
    assert resolve_stage("colon_1") == assets_dir() / "colon_1" / "colon.usda"
    assert resolve_stage("colon_9") == assets_dir() / "colon_9"  # is not there: reading it says so
