# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Colon stages: the data classes and the two functions that write and read them as USD."""

from __future__ import annotations

from .layout import CENTERLINE_PATH, LANDMARKS_PATH, PROXY_PATH, ROOT_PATH, TISSUE_PATH, VISUAL_PATH, WALL_PATH
from .stage_reader import read_colon
from .stage_types import Centerline, ColonStage, StageError, TissueMaterial, VisualMesh, WallMesh
from .stage_writer import write_colon

__all__ = [
    "CENTERLINE_PATH",
    "LANDMARKS_PATH",
    "PROXY_PATH",
    "ROOT_PATH",
    "TISSUE_PATH",
    "VISUAL_PATH",
    "WALL_PATH",
    "Centerline",
    "ColonStage",
    "StageError",
    "TissueMaterial",
    "VisualMesh",
    "WallMesh",
    "read_colon",
    "write_colon",
]
