# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rotations whose results a reader can see: quarter turns about the axes, and round trips."""

from __future__ import annotations

import math

import pytest
import torch

from arcgym.utils.math import (
    normalize,
    quat_apply,
    quat_apply_inverse,
    quat_from_axis_angle,
    quat_from_matrix,
)

X, Y, Z = torch.eye(3)
QUARTER = torch.tensor(math.pi / 2)


def matrices(quats: torch.Tensor) -> torch.Tensor:
    """Return rotation matrices, whose columns are the turned axes."""
    return torch.stack([quat_apply(quats, axis) for axis in (X, Y, Z)], -1)


def random_quats(count: int) -> torch.Tensor:
    return normalize(torch.randn(count, 4, generator=torch.Generator().manual_seed(0)))


def test_quarter_turn_about_z_takes_x_to_y() -> None:
    turn = quat_from_axis_angle(Z, QUARTER)
    torch.testing.assert_close(turn, torch.tensor([0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5)]))
    torch.testing.assert_close(quat_apply(turn, X), Y)
    torch.testing.assert_close(quat_apply_inverse(turn, Y), X)


@pytest.mark.parametrize("quat", [(1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)])
def test_half_turns_survive_the_round_trip(quat: tuple[int, ...]) -> None:
    quat = torch.tensor(quat, dtype=torch.float32)
    torch.testing.assert_close(quat_from_matrix(matrices(quat)), quat)


def test_round_trip_gives_positive_w() -> None:
    quats = random_quats(64).reshape(8, 8, 4)
    positive = torch.where(quats[..., 3:] < 0, -quats, quats)
    torch.testing.assert_close(quat_from_matrix(matrices(quats)), positive, atol=1e-5, rtol=0.0)


def test_one_quaternion_rotates_many_vectors() -> None:
    turned = quat_apply(quat_from_axis_angle(Z, QUARTER), torch.stack([X, Y, Z]))
    torch.testing.assert_close(turned, torch.stack([Y, -X, Z]))


def test_zero_vector_stays_finite() -> None:
    assert torch.equal(normalize(torch.zeros(3)), torch.zeros(3))
