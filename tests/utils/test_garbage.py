# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Pauses of the garbage collector."""

from __future__ import annotations

import gc
import sys
import types

import pytest

from arcgym.utils.garbage import MANY_MODULES, importing, paused_collection


def test_collector_is_off_meanwhile_and_on_again_after_a_failure() -> None:
    with pytest.raises(RuntimeError), paused_collection():
        assert not gc.isenabled()
        raise RuntimeError
    assert gc.isenabled()


def test_collector_that_was_off_stays_off() -> None:
    gc.disable()
    try:
        with paused_collection():
            pass
        assert not gc.isenabled()
    finally:
        gc.enable()


def age(found: object) -> int:
    """Return the generation of an object, 2 for the oldest."""
    return next(n for n in range(3) if any(thing is found for thing in gc.get_objects(n)))


@pytest.mark.parametrize(("count", "expected"), [(MANY_MODULES, 2), (MANY_MODULES - 1, 0)])
def test_what_many_imports_make_joins_the_oldest(monkeypatch: pytest.MonkeyPatch, count: int, expected: int) -> None:
    with paused_collection():
        with importing():
            made = [[]]
            for index in range(count):
                monkeypatch.setitem(sys.modules, f"arcgym_made_{index}", types.ModuleType("made"))
        assert age(made) == expected
    assert gc.get_freeze_count() == 0
