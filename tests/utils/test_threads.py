# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Threads within and after a block."""

from __future__ import annotations

import pytest
import torch

from arcgym.utils.threads import one_thread


def test_the_number_of_threads_comes_back_even_after_an_error() -> None:
    before = torch.get_num_threads()
    with pytest.raises(ValueError), one_thread():
        assert torch.get_num_threads() == 1
        raise ValueError
    assert torch.get_num_threads() == before


def test_it_decorates_functions() -> None:
    assert one_thread()(torch.get_num_threads)() == 1
