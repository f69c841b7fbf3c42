# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Operations on tensors with one entry a world."""

from __future__ import annotations

import pytest
import torch

from arcgym.utils.worlds import fill_worlds


@pytest.mark.parametrize("dtype", [torch.float32, torch.int32, torch.long, torch.bool])
def test_some_worlds_are_filled(dtype: torch.dtype) -> None:
    values = torch.ones(3, 2, dtype=dtype)
    fill_worlds(values, torch.tensor([0, 2]), 0)
    assert values.tolist() == [[0, 0], [1, 1], [0, 0]]
    fill_worlds(values, None, 1)
    assert values.tolist() == [[1, 1]] * 3
    fill_worlds(values, slice(None), 0)
    assert not values.any()


@pytest.mark.parametrize(
    "worlds", [[1], slice(1, 2), torch.tensor([1], dtype=torch.int32), torch.tensor([False, True, False])]
)
def test_worlds_are_named_in_other_ways(worlds) -> None:
    values = torch.zeros(3, 2)
    fill_worlds(values, worlds, 1.0)
    assert values.tolist() == [[0.0, 0.0], [1.0, 1.0], [0.0, 0.0]]


def test_worlds_along_another_dimension() -> None:
    values = torch.zeros(2, 3)
    fill_worlds(values, torch.tensor([1]), -torch.inf, dim=1)
    assert values.tolist() == [[0.0, -torch.inf, 0.0]] * 2
