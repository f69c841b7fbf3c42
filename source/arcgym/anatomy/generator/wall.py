# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The wall of a generated colon: its surface sampled on the rings of :mod:`arcgym.anatomy.meshing.wall`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from arcgym.anatomy.generator.lesion_shapes import wall_bulge
from arcgym.anatomy.generator.lesions import Lesion
from arcgym.anatomy.generator.surface import Surface
from arcgym.anatomy.meshing.wall import build_wall, wall_layers
from arcgym.anatomy.stage.types import WallMesh


def sample_wall(surface: Surface, lesions: Sequence[Lesion] = ()) -> WallMesh:
    """Sample a surface on the ring grid of its spec and give it thickness.

    Args:
        surface: The colon.
        lesions: Lesions of the surface; of them, wide diverticula are in the wall.
    """
    spec = surface.spec
    arc = surface.ring_arc()
    theta = np.arange(spec.sectors) * 2 * np.pi / spec.sectors
    s, angle = np.meshgrid(arc, theta, indexing="ij")
    radius = surface.radius(s, angle, spec.wall_fold_depth, spec.wall_fold_width)
    radius = np.maximum(radius, spec.min_lumen_radius) + wall_bulge(surface, lesions, s, angle)
    return build_wall(wall_layers(surface.curve, arc, radius, spec.wall_thickness), surface.curve.segment(arc), arc)
