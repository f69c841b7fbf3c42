# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Pauses of the garbage collector."""

from __future__ import annotations

import gc

import pytest

from arcgym.utils.garbage import paused_collection


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
