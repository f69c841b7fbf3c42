# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Numbers of rings, sectors, rows and columns of a colon."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class GridShape:
    """Numbers of rows and columns, the same for every patient, so that a batch can hold any."""

    rings: int = 160
    """Rings of the wall: 11.9 mm apart in the mean colon of 1.9 m, 15 mm in the longest (2.4 m)."""
    sectors: int = 14
    """Wall vertices of a ring: 10 mm apart in a lumen of 46 mm. With 12 the soft wall dents by a sixth too little under
    the tip (row ``indentation_solid_in_situ``); more cost time in proportion."""
    contact: int = 3
    """Rows and columns of the contact surface for each of the wall's."""
    visual: int = 6
    """Rows and columns of the visual surface for each of the wall's; a multiple of :attr:`contact`."""

    @property
    def rows(self) -> int:
        """Rows of the visual surface up to the last ring of the wall."""
        return (self.rings - 1) * self.visual + 1

    @property
    def columns(self) -> int:
        """Columns of the visual surface."""
        return self.sectors * self.visual

    @property
    def dome_rows(self) -> int:
        """Rows of the visual surface beyond the last ring, the last one at the pole."""
        return 2 * self.visual
