# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Look of the mucosa: the input of :mod:`arcgym.anatomy.mucosa.texture`."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class MucosaSpec:
    """Look of the mucosa."""

    width: int = 1024
    """Pixels of the textures around the lumen; they are twice as long. Halve it for files a quarter the size."""
    paleness: float = 0.45
    """Share of paler mucosa, 0 to 1."""
    redness: float = 0.20
    """Share of redder mucosa, 0 to 1."""
    vessels: float = 1.0
    """How clearly vessels shine through; 0 hides them."""
    stool: float = 0.0
    """Share of the mucosa under residual stool, 0 to 0.5."""
    fluid: float = 0.0
    """Share of the mucosa under turbid, greenish fluid, 0 to 0.5; 0.05 to 0.25 is a good preparation (Aronchick)."""
    bubbles: float = 0.0
    """Share of the mucosa under foam, 0 to 0.5."""
