# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Files that an import reads: their endings, units and axes."""

from __future__ import annotations

import numpy as np

VOLUME_SUFFIXES = (".mha", ".mha.gz", ".nii", ".nii.gz", ".nrrd")
"""File names that are read as label volumes."""

SURFACE_SUFFIXES = (".stl", ".obj", ".ply", ".vtk", ".vtp", ".glb")
"""File names that are read as surfaces."""

UNITS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}
"""Meters in a unit of a surface."""

FRAMES = {
    "ras": np.diag([1.0, 1.0, 1.0]),
    "lps": np.diag([-1.0, -1.0, 1.0]),
    "y-up": np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]]),
    "y-up-lps": np.array([[-1.0, 0, 0], [0, 0, 1.0], [0, 1.0, 0]]),
}
"""Rotation from a surface's axes to right, anterior, cranial."""

GRAVITY = {"supine": [0.0, -1.0, 0.0], "prone": [0.0, 1.0, 0.0]}
"""Direction of gravity in a scan by the patient's posture, on the axes right, anterior, cranial."""
