# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Dataclasses of arrays written to a file and read again."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from arcgym.assets.anchors import AnchorSprings
from arcgym.utils.array_files import load_arrays, save_arrays


def test_a_file_gives_back_what_was_saved(tmp_path: Path) -> None:
    springs = AnchorSprings.linear(np.array([1.0, 2.0]))
    value = {"springs": springs, "places": [Path("a/b.usda"), None], "pair": (0.1, "text"), "name": 3}
    save_arrays(value, tmp_path / "new" / "file.npz")
    found = load_arrays(tmp_path / "new" / "file.npz")
    np.testing.assert_array_equal(found["springs"].stiffness, [1.0, 2.0])
    np.testing.assert_array_equal(found["springs"].slack, [0.0, 0.0])
    assert (found["places"], found["pair"], found["name"]) == ([Path("a/b.usda"), None], (0.1, "text"), 3)
    assert [path.name for path in (tmp_path / "new").iterdir()] == ["file.npz"]


def test_what_cannot_be_read_is_none(tmp_path: Path) -> None:
    assert load_arrays(tmp_path / "missing.npz") is None
    (tmp_path / "cut.npz").write_bytes(b"PK\x03\x04 half a file")
    assert load_arrays(tmp_path / "cut.npz") is None


def test_objects_of_other_packages_are_refused(tmp_path: Path) -> None:
    with pytest.raises(TypeError, match="A set cannot be written"):
        save_arrays({"names": {1, 2}}, tmp_path / "file.npz")
    assert not list(tmp_path.iterdir())
