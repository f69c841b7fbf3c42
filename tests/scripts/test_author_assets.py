# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Textures that several colons have are kept once."""

from __future__ import annotations

import importlib.util
from pathlib import Path

from arcgym.anatomy.stage.reader import read_colon

ROOT = Path(__file__).resolve().parents[2]


def test_equal_textures_are_kept_once(tmp_path: Path) -> None:
    """Colons 1 and 3 have the same picture, colon 2 another one."""
    spec = importlib.util.spec_from_file_location("author_assets", ROOT / "scripts" / "tools" / "author_assets.py")
    assert spec is not None and spec.loader is not None
    author = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(author)
    for number, content in ((1, b"red"), (2, b"pale"), (3, b"red")):
        folder = tmp_path / f"colon_{number}"
        folder.mkdir()
        (folder / "mucosa_albedo.jpg").write_bytes(content)
        (folder / "colon.usda").write_text("asset inputs:file = @./mucosa_albedo.jpg@\n")
    assert author.share_textures(tmp_path) == 1
    assert not (tmp_path / "colon_3" / "mucosa_albedo.jpg").exists()
    assert "@../colon_1/mucosa_albedo.jpg@" in (tmp_path / "colon_3" / "colon.usda").read_text()
    assert "@./mucosa_albedo.jpg@" in (tmp_path / "colon_2" / "colon.usda").read_text()


def test_shipped_colons_find_the_textures_of_others() -> None:
    for name in ("colon_2", "colon_3"):
        stage = read_colon(ROOT / "assets" / "usd" / name / "colon.usda")
        assert stage.detail_texture.is_file() and stage.albedo_texture.is_file()
