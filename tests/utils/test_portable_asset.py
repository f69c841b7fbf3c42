# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Paths that are written down so that another machine finds the asset."""

from pathlib import Path

import pytest

from arcgym.utils.paths import ASSETS_ENV, portable_asset, resolve_asset


def test_path_inside_the_assets_folder_is_written_without_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stage = tmp_path / "here" / "colon_7" / "colon.usda"
    stage.parent.mkdir(parents=True)
    stage.touch()
    monkeypatch.setenv(ASSETS_ENV, str(tmp_path / "here"))
    assert portable_asset(stage) == "colon_7/colon.usda"
    (tmp_path / "here").rename(tmp_path / "there")
    monkeypatch.setenv(ASSETS_ENV, str(tmp_path / "there"))
    assert resolve_asset("colon_7/colon.usda").is_file()


def test_path_elsewhere_stays_as_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(ASSETS_ENV, str(tmp_path))
    assert portable_asset("/data/patient_3/colon.usda") == "/data/patient_3/colon.usda"
