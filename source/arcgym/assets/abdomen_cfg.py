# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of the abdomen around a colon and of a hand that presses on it."""

from __future__ import annotations

from arcgym.utils.configclass import configclass
from arcgym.utils.validation import Range, require


@configclass
class AbdomenCfg:
    """Inside of the abdomen, which stops loops, and an assistant's hand on its front. See docs/clinical.md, Abdomen."""

    enabled: bool = False
    """Whether there is one. Switch it on for loops that the body stops, and for hand pressure. Off, the colon goes
    wherever its attachments let it."""
    gap: float = 0.01
    """Way from the imaged colon to the inside of the abdomen where they are nearest [m]. A choice: the colon as imaged
    touches nothing. Another one for each world is set by :meth:`arcgym.assets.Colon.write_abdomen_to_sim`."""
    squareness: float = 6.0
    """Exponent of the superellipsoid: 2 is an ellipsoid, 10 nearly a box. A choice: the least one around colon 1 leaves
    7 mm in front of it and 5 mm beside it with 6, 18 and 21 mm with 4, 57 and 82 mm with 2; the transverse colon, full
    of gas, lies right behind the front of the abdomen."""
    stiffness: float = 3.0e5
    """Pressure on the colon over how far it has gone outside [Pa/m]: 3 kPa a cm, a choice, within 2 to 5 kPa a cm. It
    stands for fat, muscles and other bowel that give way."""
    damping: float = 0.02
    """Damping over stiffness [s]: what touches the abdomen comes to rest within some of these. A choice; raise it if
    loops bounce."""
    hand_radius: float = 0.05
    """Radius of what the hand presses in as deep as itself [m]: 10 x 10 cm, a choice. The dent ends at twice that."""
    hand_stiffness: float = 1000.0
    """Force over dent with which the front of the abdomen alone resists the hand [N/m]: 40 N press it in by 4 cm where
    there is no colon. A choice; the firmer the belly, the less of the hand's force reaches the colon."""
    hand_time: float = 0.2
    """Time in which a dent follows the force of the hand [s]. A choice."""
    hand_depth: float = 0.08
    """Largest dent [m]: the spine is behind it. A choice."""
    hand_place: tuple[float, float] = (-0.3, -0.35)
    """Where the hand is at first, to the patient's right and cranial of the middle of the front, over half its width
    and height. Over the sigmoid colon by default, to the left and below, where it is pressed most often."""

    @property
    def active(self) -> bool:
        """Whether it is on."""
        return self.enabled

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require(self, "gap", Range(0.0, 0.2), unit="m")
        require(self, "squareness", Range(2.0, 10.0))
        require(self, "stiffness", Range(0.0, 1.0e6), unit="Pa/m")
        require(self, "damping", Range(0.0, 1.0), unit="s")
        require(self, "hand_radius", Range(0.01, 0.3), unit="m")
        require(self, "hand_stiffness", Range(50.0, 1.0e5), unit="N/m")
        require(self, "hand_time", Range(0.02, 10.0), unit="s")
        require(self, "hand_depth", Range(0.0, 0.2), unit="m")
        require(self, "hand_place", Range(-1.0, 1.0))
