# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of how a shell's wall stretches, beyond its modulus."""

from __future__ import annotations

from arcgym.utils.configclass import configclass
from arcgym.utils.validation import FieldError, Range, require


@configclass
class WallLawCfg:
    """Stiffening, thickness and relaxation of the wall; each is off by default. See docs/clinical.md, Wall law."""

    stiffening: float | None = None
    """Factor b of the term b mu / 6 (I - 2)^3 that stiffens stretches; ``None`` keeps 2.75, by which a strip bears at
    63 % what human colon tears at. Change it with the modulus: 1.5 goes with the 95 kPa of a wall that gas has
    stretched already."""
    thickness_by_diameter: bool = False
    """Whether the wall is the thinner the wider the colon is, so that a length of colon has the same mass everywhere.
    Off, it has the thickness of the preset or the stage everywhere."""
    thickness_times_diameter: float = 60.0e-6
    """Thickness times diameter of the middle of the wall [m^2]: 370 g of colon (ICRP 89) of 1030 kg/m^3 (ICRU 46) over
    1.9 m. 1.6 mm where the colon is 38 mm wide, 0.9 mm at 65 mm. 30 % either way between patients, our guess."""
    thickness_range: tuple[float, float] = (0.5e-3, 5.0e-3)
    """Least and largest thickness of it [m]: a blind end's last ring is narrow, not thick. CT sees up to 5 mm where the
    colon is 1 to 2 cm wide."""
    relaxation: bool = False
    """Whether the tension of a stretched wall fades: G(t) = 1 - sum of share * (1 - exp(-t / time)), times the tension
    at once. The modulus is then the one at once."""
    relaxing_share: tuple[float, float] = (0.25, 0.20)
    """Shares of the tension that fade, quickly and slowly. A choice: 20 to 40 % are lost in a cycle. A third term of 15
    % in 100 s, longer than most episodes, is left out."""
    relaxing_time: tuple[float, float] = (1.0, 10.0)
    """Time constants of the two [s]. A choice, as there is no measurement; one relaxation function serves all
    regions and ages (Watters et al. 1985)."""

    cell_strain: bool = False
    """Whether the two triangles between two rings and two sectors share one strain, their mean, so that a coarse wall
    locks less (docs/clinical.md, Wall law). Off, each triangle has its own. Try it with ``mean_surface`` where contacts
    are light; it does not make the tip's force of a pushed scope independent of the mesh."""
    mean_surface: bool = False
    """Whether the wall's faces lie on the colon's surface on average. Off, its vertices lie there, and the faces
    between them cut the bends, so that a lumen of 17 mm is narrower by 0.3 mm. Try it with ``cell_strain``."""

    @property
    def active(self) -> bool:
        """Whether any of it is on."""
        parts = (self.thickness_by_diameter, self.relaxation, self.cell_strain, self.mean_surface)
        return self.stiffening is not None or any(parts)

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require(self, "stiffening", Range(0.0, 100.0))
        require(self, "thickness_times_diameter", Range(1.0e-6, 1.0e-3), unit="m^2")
        require(self, "thickness_range", Range(1.0e-4, 2.0e-2), unit="m")
        require(self, "relaxing_share", Range(0.0, 0.9))
        require(self, "relaxing_time", Range(0.01, 1.0e4), unit="s")
        if self.thickness_range[0] > self.thickness_range[1]:
            raise FieldError(self, "thickness_range", f"is {self.thickness_range}, expected the least one first.")
        if sum(self.relaxing_share) > 0.9:
            raise FieldError(self, "relaxing_share", f"is {self.relaxing_share}, expected a sum of at most 0.9.")
