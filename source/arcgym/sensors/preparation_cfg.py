# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What bowel preparation leaves in the colon."""

from __future__ import annotations

from arcgym.utils.configclass import configclass
from arcgym.utils.validation import Range, require, require_fraction

Grades = tuple[float, float, float, float]


@configclass
class PreparationCfg:
    """Stool and fluid by the Boston bowel preparation scale, which gives right, transverse and left colon 0 to 3 each.

    3: the whole mucosa is seen well; 2: little stool or opaque liquid, the mucosa is seen well; 1: parts of it are not
    seen; 0: none is seen for solid stool (Lai et al., Gastrointest. Endosc. 69:620, 2009). How much stool and liquid
    that is are our choices, between Aronchick's figures: over 95 % of the surface is seen where the preparation is
    excellent, liquid covers 5 to 25 % of it where it is good.
    """

    scores: tuple[int, int, int] | None = None
    """Scores of right colon (ascending colon and cecum), transverse colon with both flexures, and left colon, in worlds
    for which the event :func:`arcgym.envs.mdp.randomize_preparation` draws none. None, the default, leaves all clean
    and costs nothing; the scores can then not be drawn either."""

    stool: Grades = (1.0, 0.3, 0.05, 0.0)
    """Share s of cells of 2 cm that hold a lump of stool, of 8 to 18 mm radius, for scores 0 to 3; lumps then cover a
    share 1 - exp(-1.32 s) of the wall: 73, 33, 6 and 0 %."""

    liquid: Grades = (0.5, 0.3, 0.15, 0.03)
    """Share of the way around the lumen that liquid covers, at the lowest places, for scores 0 to 3."""

    turbidity: Grades = (1.0, 0.9, 0.5, 0.2)
    """How opaque the liquid is, for scores 0 to 3: 0 is clear water, 1 hides the mucosa."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require_fraction(self, "stool", "liquid", "turbidity")
        require(self, "scores", Range(0, 3))
