# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import pytest
import torch

from arcgym.utils.world_rows import WorldRows, packed

DEVICES = ["cpu", *(["cuda:0"] if torch.cuda.is_available() else [])]
IDS = [3, 1]


def tensors(count: int, device: str) -> list[torch.Tensor]:
    """Some of each kind: one number a world, several, worlds along another dimension in memory, many dimensions."""
    flags = torch.arange(1, 1 + count, dtype=torch.int32, device=device)
    shapes = ((count, 3), (5, count, 3), (4, 2, count, 3))
    plain, points, deep = (torch.randn(shape, device=device) for shape in shapes)
    return [flags, plain, points.transpose(0, 1), deep.permute(2, 1, 0, 3)]


@pytest.mark.parametrize("device", DEVICES)
def test_entries_of_some_worlds_become_zero(device: str) -> None:
    values = tensors(6, device)
    expected = [value.clone() for value in values]
    for value in expected:
        value[IDS] = 0
    WorldRows(values).clear(torch.tensor(IDS, device=device))
    assert all(torch.equal(a, b) for a, b in zip(values, expected, strict=True))


@pytest.mark.parametrize("device", DEVICES)
def test_rows_of_a_table_are_copied_into_some_worlds(device: str) -> None:
    values, stored = tensors(6, device), tensors(4, device)
    expected = [value.clone() for value in values]
    for value, new in zip(expected, stored, strict=True):
        value[IDS] = new[[0, 2]]
    row = torch.tensor([0, 2], dtype=torch.int32, device=device)
    WorldRows(values).copy(packed([new.contiguous() for new in stored]), row, torch.tensor(IDS, device=device))
    assert all(torch.equal(a, b) for a, b in zip(values, expected, strict=True))


def test_numbers_of_another_size_are_refused() -> None:
    with pytest.raises(ValueError, match="four bytes"):
        WorldRows([torch.zeros(2, dtype=torch.bool)])
