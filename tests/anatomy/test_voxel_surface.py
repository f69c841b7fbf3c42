# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Walls between loops that were segmented as one: a hairpin of voxels whose legs overlap."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from arcgym.anatomy.meshing.triangle_surface import TriangleSurface
from arcgym.anatomy.meshing.voxel_surface import voxel_surface
from arcgym.anatomy.validation.mesh_checks import edge_uses

H = 0.001


def hairpin(gap: float, leg: float = 0.12) -> np.ndarray:
    """Two legs along y that come as near as ``gap`` halfway, apart before and after, joined by half a circle."""
    y = np.arange(0.0, leg, H)
    x = 0.5 * gap + 0.015 * np.abs(2 * y / leg - 1.0) ** 2
    angle = np.linspace(0.0, np.pi, 60)
    turn = np.stack([x[-1] * np.cos(angle), leg + x[-1] * np.sin(angle), 0 * angle], 1)
    up = np.stack([x, y, 0 * y], 1)
    return np.concatenate([up, turn[1:-1], up[::-1] * [-1, 1, 1]])


def voxels(line: np.ndarray, radius: float = 0.008) -> tuple[np.ndarray, np.ndarray]:
    """A tube round a line as voxels of 1 mm, and the first one's position."""
    low = line.min(0) - radius - 0.004
    count = np.ceil((line.max(0) + radius + 0.004 - low) / H).astype(int)
    at = low + H * np.stack(np.meshgrid(*map(np.arange, count), indexing="ij"), -1).reshape(-1, 3)
    return (cKDTree(line).query(at)[0] < radius).reshape(count).astype(np.float32), low


def euler(surface: TriangleSurface) -> int:
    edges, _ = edge_uses(surface.faces)
    return len(surface.points) - len(edges) + len(surface.faces)


def test_legs_that_overlap_are_parted() -> None:
    """Legs of 8 mm radius 14 mm apart overlap by 2 mm halfway, at 60 mm and as far from the other end."""
    line = hairpin(0.014)
    values, low = voxels(line)
    made = voxel_surface(values, low, H, line)
    (window,) = made.windows
    length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    assert window.arcs == pytest.approx((0.06, length - 0.06), abs=0.01)
    assert window.position == pytest.approx([0.0, 0.06, 0.0], abs=0.003)
    assert 1e-4 < window.area < 8e-4
    assert euler(made.surface) == 2 and made.lost < 1e-8
    across = np.abs(made.surface.points[:, 0])[np.abs(made.surface.points[:, 1] - 0.06) < 0.005]
    assert across.min() > 0.0003


def test_legs_apart_stay_as_they_are() -> None:
    line = hairpin(0.020)
    values, low = voxels(line)
    made = voxel_surface(values, low, H, line)
    assert made.windows == [] and made.lost == 0.0
    assert euler(made.surface) == 2
    distance = cKDTree(line).query(made.surface.points)[0]
    assert np.median(distance) == pytest.approx(0.008, abs=3e-4)


def test_line_outside_of_the_lumen_is_named() -> None:
    line = hairpin(0.020)
    values, low = voxels(line)
    with pytest.raises(ValueError, match="100 % of the centerline is outside"):
        voxel_surface(values, low, H, line + [0.0, 0.0, 0.05])


def test_empty_lumen_is_named() -> None:
    with pytest.raises(ValueError, match="no voxel is above 0.5"):
        voxel_surface(np.zeros((5, 5, 5)), np.zeros(3), H, hairpin(0.02))
