# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Colon anatomy: generate, import, validate, write and read stages. Needs NumPy, SciPy, scikit-image, Pillow, usd-core.

In reading order:

- :mod:`segments` and :mod:`landmarks` name the parts; :mod:`stage` holds a colon as arrays, and reads and writes files;
- :mod:`generator` makes colons from specifications, :mod:`importing` from CT; :mod:`validation` checks any;
- both build on :mod:`curve`, a centerline with frames, on :mod:`meshing` and :mod:`mucosa`, and on
  :mod:`polyline`, :mod:`blending` and :mod:`measures`; :mod:`head_drawing` makes room for a scope's stiff head, with
  :mod:`tubes` on a :mod:`voxel_grid`;
- :mod:`bends` counts acute bends, :mod:`shell` gives the wall's mid-surface to the simulation.

What reads stages alone imports no SciPy, which takes 0.7 s: the generator is imported when it is asked for.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from arcgym.anatomy.generator.spec import ColonSpec, FoldSpec, SegmentSpec
from arcgym.anatomy.measures import inner_faces
from arcgym.anatomy.segments import ANCHOR_ELASTIC, ANCHOR_FIXED, ANCHOR_FREE, RETROPERITONEAL, SEGMENTS, segment_index
from arcgym.anatomy.stage import (
    Centerline,
    ColonStage,
    ContactSurface,
    StageError,
    TissueMaterial,
    VisualMesh,
    WallMesh,
    read_colon,
    write_colon,
)
from arcgym.utils.lazy import lazy_names

if TYPE_CHECKING:
    from arcgym.anatomy.generator.generate import AnatomyError, make_colon

__all__ = [
    "ANCHOR_ELASTIC",
    "ANCHOR_FIXED",
    "ANCHOR_FREE",
    "RETROPERITONEAL",
    "SEGMENTS",
    "AnatomyError",
    "Centerline",
    "ColonSpec",
    "ColonStage",
    "ContactSurface",
    "FoldSpec",
    "SegmentSpec",
    "StageError",
    "TissueMaterial",
    "VisualMesh",
    "WallMesh",
    "inner_faces",
    "make_colon",
    "read_colon",
    "segment_index",
    "write_colon",
]

__getattr__ = lazy_names(
    __name__,
    {"AnatomyError": "arcgym.anatomy.generator.generate", "make_colon": "arcgym.anatomy.generator.generate"},
)
