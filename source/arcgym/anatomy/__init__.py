# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Colon anatomy: generating, validating, writing and reading stages. Needs numpy, scipy, pillow and usd-core only."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from arcgym.anatomy.generator.spec import ColonSpec, FoldSpec, SegmentSpec
from arcgym.anatomy.measures import inner_faces
from arcgym.anatomy.segments import ANCHOR_ELASTIC, ANCHOR_FIXED, ANCHOR_FREE, RETROPERITONEAL, SEGMENTS, segment_index
from arcgym.anatomy.stage import (
    Centerline,
    ColonStage,
    StageError,
    TissueMaterial,
    VisualMesh,
    WallMesh,
    read_colon,
    write_colon,
)

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


def __getattr__(name: str) -> Any:
    """Imports the generator when it is asked for: what reads stages alone starts 0.7 s earlier without SciPy."""
    if name not in ("AnatomyError", "make_colon"):
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    from arcgym.anatomy.generator import generate

    return getattr(generate, name)
