# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Sizes that no colon has, found before the work: grids that do not fit into memory, and solid bodies."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy import ndimage

from arcgym.anatomy.importing.errors import ColonImportError

_MOST_VOXELS = 2.5e8
"""Largest number of voxels that are worked on; a large patient at 1 mm has 1.2e8."""

_MOST_FILE_VOXELS = 2.0e9
"""Largest number of voxels that are read from a file, of one byte or more."""

_BYTES = 30
"""Memory that an import takes at its peak for each voxel [B]; 28 were measured (docs/importing.md, "How well")."""

_MEMORY_SHARE = 0.8
"""Largest share of the machine's memory that is planned with."""

_LARGEST_FILLING = 0.45
"""Largest share of the box round a lumen that it fills; a colon fills 5 to 20 %, a ball 52 %."""


def check_voxels(extent: np.ndarray, voxel: float) -> None:
    """Check that a grid over an extent fits into memory.

    Args:
        extent: Size of the lumen along the axes [m], shape (3,).
        voxel: Edge of the voxels [m].

    Raises:
        ColonImportError: It does not.
    """
    count = float(np.prod(np.ceil(np.asarray(extent, float) / voxel) + 1.0))
    memory = float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    if count <= _MOST_VOXELS and count * _BYTES <= _MEMORY_SHARE * memory:
        return
    size = " x ".join(f"{1e3 * value:.0f}" for value in extent)
    raise ColonImportError(
        f"A lumen of {size} mm takes {1e-6 * count:.0f} million voxels of {1e3 * voxel:g} mm, about "
        f"{1e-9 * count * _BYTES:.1f} GB; {1e-6 * _MOST_VOXELS:.0f} million and {_MEMORY_SHARE:.0%} of the machine's "
        f"{1e-9 * memory:.1f} GB are the limit",
        "Check the units (--spacing, --units), or pass a larger --voxel.",
    )


def check_file_voxels(path: Path, size: Sequence[int]) -> None:
    """Check that the voxels that a file's header announces can be read.

    Args:
        path: Label volume.
        size: Voxels along each axis.

    Raises:
        ColonImportError: They are more than :data:`_MOST_FILE_VOXELS`.
    """
    count = math.prod(size)
    if count > _MOST_FILE_VOXELS:
        raise ColonImportError(
            f"The header of {path} says {' x '.join(map(str, size))} voxels, {1e-9 * count:.1f} billion; the limit is "
            f"{1e-9 * _MOST_FILE_VOXELS:g} billion, and a CT has up to 1024 x 1024 x 1500",
            "Check that the file is complete, or resample it.",
        )


def check_filling(mask: np.ndarray) -> None:
    """Check that a lumen is a tube and not a solid body.

    Args:
        mask: Lumen, above 0, shape (X, Y, Z).

    Raises:
        ColonImportError: It fills too much of its box.
    """
    box = ndimage.find_objects((mask > 0).astype(np.uint8))
    share = float((mask[box[0]] > 0).mean()) if box else 0.0
    if share > _LARGEST_FILLING:
        raise ColonImportError(
            f"No colon-like component: the lumen fills {share:.0%} of the box round it; a colon fills 5 to 20 %",
            "Pass the mask of the colon's lumen, and --label if it has several labels.",
        )
