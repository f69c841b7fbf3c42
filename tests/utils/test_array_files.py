# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Dataclasses of arrays written to a file and read again."""

from __future__ import annotations

import gc
import itertools
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from arcgym.assets.anchors import AnchorSprings
from arcgym.utils.array_files import load_arrays, save_arrays


@pytest.fixture
def threads_that_change_often() -> Iterator[None]:
    """Collect garbage often, and let other threads run at every seventh time."""
    times = itertools.count()

    def pause(*_: object) -> None:
        if next(times) % 7 == 0:
            time.sleep(1e-4)

    threshold = gc.get_threshold()
    gc.set_threshold(3)
    gc.callbacks.append(pause)
    yield
    gc.callbacks.remove(pause)
    gc.set_threshold(*threshold)


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


@pytest.mark.usefixtures("threads_that_change_often")
def test_several_threads_read_at_once(tmp_path: Path) -> None:
    save_arrays([np.full((2, 3), float(k)) for k in range(50)], tmp_path / "file.npz")
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda _: load_arrays(tmp_path / "file.npz"), range(100)))
    assert all(arrays[49].sum() == 6 * 49 for arrays in found)
