# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Batched vectors and rotations in torch. Quaternions are (x, y, z, w), as in Newton; `...` is any batch shape.

Sums over the last dimension have a fixed order. Torch's own reductions on a GPU choose theirs by the size of the batch,
so that a world's result would depend, in the last digit, on how many others there are.
"""

from __future__ import annotations

from functools import reduce
from itertools import accumulate

import torch


def normalize(vectors: torch.Tensor, eps: float = 1.0e-9) -> torch.Tensor:
    """Scale vectors to unit length; those shorter than `eps` become (nearly) zero. Shape (..., D) to (..., D)."""
    return vectors / norm(vectors).unsqueeze(-1).clamp(min=eps)


def row_sum(values: torch.Tensor) -> torch.Tensor:
    """Add up a few values, in their order. Shape (..., D) to (...)."""
    return reduce(torch.add, values.unbind(dim=-1))


def row_cumsum(values: torch.Tensor) -> torch.Tensor:
    """Return the sums of the first one, two, ... of a few values, shape (..., D)."""
    return torch.stack(list(accumulate(values.unbind(dim=-1))), dim=-1)


def norm(vectors: torch.Tensor) -> torch.Tensor:
    """Return the lengths of vectors. Shape (..., D) to (...)."""
    return row_sum(vectors.square()).sqrt()


def quat_apply(quat: torch.Tensor, vectors: torch.Tensor) -> torch.Tensor:
    """Rotate `vectors`, shape (..., 3), by unit quaternions, shape (..., 4)."""
    xyz, vectors = torch.broadcast_tensors(quat[..., :3], vectors)
    across = 2.0 * torch.linalg.cross(xyz, vectors)
    return torch.addcmul(vectors, quat[..., 3:], across) + torch.linalg.cross(xyz, across)


def quat_apply_inverse(quat: torch.Tensor, vectors: torch.Tensor) -> torch.Tensor:
    """Rotate `vectors`, shape (..., 3), by the inverse of unit quaternions, shape (..., 4)."""
    xyz, vectors = torch.broadcast_tensors(quat[..., :3], vectors)
    across = 2.0 * torch.linalg.cross(xyz, vectors)
    return torch.addcmul(vectors, quat[..., 3:], across, value=-1.0) + torch.linalg.cross(xyz, across)


def quat_from_axis_angle(axis: torch.Tensor, angle: torch.Tensor) -> torch.Tensor:
    """Return quaternions that rotate by `angle` [rad], shape (...), about the unit vectors `axis`, shape (..., 3)."""
    half = 0.5 * angle.unsqueeze(-1)
    return torch.cat((axis * torch.sin(half), torch.cos(half).expand(*axis.shape[:-1], 1)), dim=-1)


def quat_from_matrix(matrix: torch.Tensor) -> torch.Tensor:
    """Return unit quaternions with w >= 0, shape (..., 4), of rotation matrices, shape (..., 3, 3).

    Of the four equivalent formulas (one for each component to divide by) each rotation takes the one that divides by
    its largest component (Shepperd 1978, "Quaternion from rotation matrix").
    """
    m = matrix
    xx, yy, zz = m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]
    xy, xz, yz = m[..., 0, 1] + m[..., 1, 0], m[..., 0, 2] + m[..., 2, 0], m[..., 1, 2] + m[..., 2, 1]
    x, y, z = m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]
    # Row k holds 4 q_k q: every row is parallel to the quaternion, the one with the largest diagonal is best.
    rows = torch.stack(
        [
            torch.stack([1.0 + xx - yy - zz, xy, xz, x], -1),
            torch.stack([xy, 1.0 - xx + yy - zz, yz, y], -1),
            torch.stack([xz, yz, 1.0 - xx - yy + zz, z], -1),
            torch.stack([x, y, z, 1.0 + xx + yy + zz], -1),
        ],
        -2,
    )
    best = rows.diagonal(dim1=-2, dim2=-1).argmax(-1)
    quat = normalize(rows.gather(-2, best[..., None, None].expand(*best.shape, 1, 4)).squeeze(-2))
    return torch.where(quat[..., 3:] < 0.0, -quat, quat)


def points_at(points: torch.Tensor, arc: torch.Tensor, at: torch.Tensor) -> torch.Tensor:
    """Return points of each world's polyline at given arc lengths, linear between its vertices.

    Args:
        points: Vertices [m], shape (N, R, 3).
        arc: Arc length of each vertex, ascending [m], shape (N, R).
        at: Arc lengths wanted, clamped to the polyline [m], shape (N, K).

    Returns:
        Points [m], shape (N, K, 3).
    """
    at = at.clamp(arc[:, :1], arc[:, -1:])
    right = torch.searchsorted(arc, at).clamp(1, arc.shape[1] - 1)
    before = arc.gather(1, right - 1)
    fraction = ((at - before) / (arc.gather(1, right) - before)).unsqueeze(-1)
    index = right.unsqueeze(-1).expand(-1, -1, 3)
    return torch.lerp(points.gather(1, index - 1), points.gather(1, index), fraction)
