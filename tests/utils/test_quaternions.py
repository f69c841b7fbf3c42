# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Quaternion arithmetic on turns of 90 degrees."""

from __future__ import annotations

import math

import torch

from arcgym.utils.math import quat_apply, quat_apply_inverse, quat_mul

HALF = math.sqrt(0.5)
ABOUT_X = torch.tensor([HALF, 0.0, 0.0, HALF])
ABOUT_Z = torch.tensor([0.0, 0.0, HALF, HALF])
X, Y, Z = torch.eye(3)


def test_quarter_turn_about_z_takes_x_to_y() -> None:
    torch.testing.assert_close(quat_apply(ABOUT_Z, X), Y)
    torch.testing.assert_close(quat_apply_inverse(ABOUT_Z, Y), X)


def test_product_turns_by_the_second_first() -> None:
    both = quat_mul(ABOUT_X, ABOUT_Z)
    torch.testing.assert_close(quat_apply(both, X), quat_apply(ABOUT_X, quat_apply(ABOUT_Z, X)))
    torch.testing.assert_close(quat_apply(both, X), Z)


def test_one_quaternion_turns_many_vectors() -> None:
    quats = torch.stack([ABOUT_X, ABOUT_Z])[:, None]
    vectors = torch.stack([X, Y])
    expected = torch.stack([torch.stack([X, Z]), torch.stack([Y, -X])])
    torch.testing.assert_close(quat_apply(quats, vectors), expected)
