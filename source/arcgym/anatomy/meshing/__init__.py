# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Build wall and visual meshes on grids of rings; generator and importer share them.

From any lumen's surface, in reading order:

- :mod:`triangle_surface`: a closed surface, cut from a field; :mod:`voxel_surface`: from the voxels of an image, with
  walls between loops that touch; :mod:`conformal_map`: coordinates along and round it;
- :mod:`level_curves`: rings on it; :mod:`lumen_grid`: a grid of them, of a fixed :mod:`arcgym.anatomy.grid_shape`;
- :mod:`coarse_wall`: the wall's two layers from the grid; :mod:`mending`: mends them where they are bad;
- :mod:`grid_surfaces`: what the scope touches and what the camera sees, from the grid, finer near lesions
  (:mod:`refine`);
- :mod:`quantize`: rounds surfaces for small files;
- :mod:`colon_fitting`: all of it, :func:`arcgym.anatomy.meshing.colon_fitting.fit_colon`;

and for surfaces swept along a centerline:

- :mod:`wall`: the tetrahedral wall of rings and sectors;
- :mod:`surface_grid`: triangles, normals, texture coordinates and skin weights of a visual surface.
"""

from __future__ import annotations

from arcgym.anatomy.meshing.surface_grid import (
    dome_texture,
    grid_triangles,
    skin_to_rings,
    smooth_normals,
    tube_texture,
)
from arcgym.anatomy.meshing.wall import build_wall, ring_arcs, wall_layers

__all__ = [
    "build_wall",
    "dome_texture",
    "grid_triangles",
    "ring_arcs",
    "skin_to_rings",
    "smooth_normals",
    "tube_texture",
    "wall_layers",
]
