# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Colon stages: data classes, and the functions that write and read them as USD.

In reading order: :mod:`types`, the arrays of a colon; :mod:`layout`, their names in a file; :mod:`writer`;
:mod:`opening` and :mod:`reader`, which say what is wrong with a file.
"""

from __future__ import annotations

from arcgym.anatomy.stage.layout import (
    CENTERLINE_PATH,
    CONTACT_PATH,
    LANDMARKS_PATH,
    PROXY_PATH,
    ROOT_PATH,
    TISSUE_PATH,
    VISUAL_PATH,
    WALL_PATH,
)
from arcgym.anatomy.stage.opening import open_stage
from arcgym.anatomy.stage.reader import read_colon
from arcgym.anatomy.stage.types import (
    Centerline,
    ColonStage,
    ContactSurface,
    StageError,
    TissueMaterial,
    VisualMesh,
    WallMesh,
)
from arcgym.anatomy.stage.writer import write_colon

__all__ = [
    "CENTERLINE_PATH",
    "CONTACT_PATH",
    "LANDMARKS_PATH",
    "PROXY_PATH",
    "ROOT_PATH",
    "TISSUE_PATH",
    "VISUAL_PATH",
    "WALL_PATH",
    "Centerline",
    "ColonStage",
    "ContactSurface",
    "StageError",
    "TissueMaterial",
    "VisualMesh",
    "WallMesh",
    "open_stage",
    "read_colon",
    "write_colon",
]
