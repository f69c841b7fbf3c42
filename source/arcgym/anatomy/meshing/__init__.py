# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Build wall and visual meshes on grids of rings; generator and importer share them.

- :mod:`wall`: the tetrahedral wall of rings and sectors;
- :mod:`surface_grid`: triangles, normals, texture coordinates and skin weights of a visual surface.
"""
