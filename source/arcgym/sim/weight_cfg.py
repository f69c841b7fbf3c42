# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of weight and of the patient's posture."""

from __future__ import annotations

from typing import Literal

from arcgym.utils.configclass import configclass
from arcgym.utils.validation import Range, require, require_fraction

POSTURES: dict[str, tuple[float, float, float]] = {
    "supine": (0.0, -1.0, 0.0),
    "prone": (0.0, 1.0, 0.0),
    "left_lateral": (-1.0, 0.0, 0.0),
    "right_lateral": (1.0, 0.0, 0.0),
}
"""Where down is in the patient's axes (+X right, +Y anterior, +Z cranial): lying on the back, the belly, the left and
the right side."""


@configclass
class WeightCfg:
    """Weight of scope, wall and contents along the patient's posture. See docs/clinical.md, Weight."""

    enabled: bool = False
    """Whether things weigh. Switch it on for patients who lie on a side or are turned, with
    :func:`arcgym.envs.mdp.change_posture`. Off, nothing weighs but what ``SimulationCfg.gravity`` puts on the scope."""
    posture: Literal["supine", "prone", "left_lateral", "right_lateral"] = "supine"
    """How the patient lies at first, in all worlds. On the back by default, as the stages were imaged, so that the
    wall is at rest; colonoscopies mostly begin on the left side."""
    imaged: Literal["supine", "prone", "left_lateral", "right_lateral", "weightless"] = "supine"
    """How the patient lay when the stage's shape was imaged: that shape already bears the weight of then, and a wall in
    that posture is at rest. CT colonography images supine and prone. ``weightless`` for a shape without weight."""
    acceleration: float = 9.81
    """Acceleration of free fall [m/s^2]. Change it to compare."""
    wall_share: float = 1.0
    """Share of the wall's weight that its attachments bear; the rest rests on what lies around it. 1 by default, as the
    slack mesentery of ``in_situ`` has it: nothing is known of how much neighbors carry, and in a fluid as dense as fat
    (950 kg/m^3, ICRU 46) it would be 0.08."""
    contents_per_length: float = 0.05
    """Mass of fluid and stool by length of colon [kg/m], spread evenly. A choice: 0.1 l in 1.9 m, for 0 to 0.2 l are
    left by a good preparation (a choice, too); 0.3 kg unprepared (ICRP 89) is 0.16."""

    @property
    def active(self) -> bool:
        """Whether it is on."""
        return self.enabled

    def validate_config(self) -> None:
        """Check names and bounds.

        Raises:
            ValueError: If a value is out of its bounds or a name is unknown.
        """
        require(self, "posture", POSTURES)
        require(self, "imaged", (*POSTURES, "weightless"))
        require(self, "acceleration", Range(0.0, 30.0), unit="m/s^2")
        require_fraction(self, "wall_share")
        require(self, "contents_per_length", Range(0.0, 2.0), unit="kg/m")

    def gravity(self, posture: str) -> tuple[float, float, float]:
        """Return the acceleration of free fall in a posture, or none for ``weightless`` [m/s^2]."""
        x, y, z = POSTURES.get(posture, (0.0, 0.0, 0.0))
        return self.acceleration * x, self.acceleration * y, self.acceleration * z
