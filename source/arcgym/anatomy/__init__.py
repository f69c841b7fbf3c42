# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Colon anatomy: generating, validating, writing and reading stages. Needs numpy, scipy, pillow and usd-core only."""

from .generate import AnatomyError, make_colon
from .segments import ANCHOR_ELASTIC, ANCHOR_FIXED, ANCHOR_FREE, RETROPERITONEAL, SEGMENTS, segment_index
from .spec import ColonSpec, FoldSpec, SegmentSpec
from .stage import (
    Centerline,
    ColonStage,
    StageError,
    TissueMaterial,
    VisualMesh,
    WallMesh,
    read_colon,
    write_colon,
)
from .wall import inner_faces

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
