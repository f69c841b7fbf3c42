# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Quaternions (x, y, z, w) on torch tensors; leading dimensions broadcast."""

from __future__ import annotations

import torch


def quat_mul(a: torch.Tensor, b: torch.Tensor) -> torch.Tensor:
    """Product of quaternions, shape (..., 4): the rotation by ``b``, then by ``a``."""
    av, aw, bv, bw = a[..., :3], a[..., 3:], b[..., :3], b[..., 3:]
    av, bv = torch.broadcast_tensors(av, bv)
    vector = aw * bv + bw * av + torch.linalg.cross(av, bv)
    return torch.cat((vector, aw * bw - (av * bv).sum(-1, keepdim=True)), dim=-1)


def quat_conjugate(quat: torch.Tensor) -> torch.Tensor:
    """Inverse of unit quaternions, shape (..., 4)."""
    return torch.cat((-quat[..., :3], quat[..., 3:]), dim=-1)


def quat_apply(quat: torch.Tensor, vector: torch.Tensor) -> torch.Tensor:
    """Vectors, shape (..., 3), rotated by unit quaternions, shape (..., 4)."""
    axis, vector = torch.broadcast_tensors(quat[..., :3], vector)
    twice = 2.0 * torch.linalg.cross(axis, vector)
    return vector + quat[..., 3:] * twice + torch.linalg.cross(axis, twice)


def quat_apply_inverse(quat: torch.Tensor, vector: torch.Tensor) -> torch.Tensor:
    """Vectors, shape (..., 3), rotated back: from the world into the frame of ``quat``, shape (..., 4)."""
    return quat_apply(quat_conjugate(quat), vector)
