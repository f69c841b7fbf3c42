# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of the mesenteries as sheets."""

from __future__ import annotations

from arcgym.anatomy.segments import SEGMENTS
from arcgym.assets.materials import MESOCOLON_HEIGHT
from arcgym.utils.configclass import configclass
from arcgym.utils.string import did_you_mean
from arcgym.utils.validation import FieldError, Range, require


@configclass
class MesenteryCfg:
    """Mesenteries as sheets that swing about their root and stiffen. See docs/clinical.md, Mesentery."""

    enabled: bool = False
    """Whether segments hang on sheets. Switch it on for loops that swing as on a mesentery: freely about its root, and
    not away from it. Off, springs hold them, with a slack that is the same in all directions in some presets."""
    height: dict[str, float] = dict(MESOCOLON_HEIGHT)
    """Way from the root to the colon as imaged, half way along each segment that hangs on a sheet [m]; it falls to
    ``least_height`` at both ends as a sine. 6.3 +- 2.6 and 7.4 +- 3.6 cm in 35 cadavers (Annals of the Royal College of
    Surgeons of England, 2015)."""
    fullness: float = 1.0
    """Length of the sheet over the way from its root to the colon as imaged. 1, taut as imaged, is a choice: gas floats
    the colon to the front. Raise it for a sheet that lies in folds; another one for each world is set by
    :meth:`arcgym.assets.Colon.write_mesentery_to_sim`."""
    root: tuple[float, float, float] = (0.0, -1.0, 0.0)
    """Direction from the colon to the root of the sheet, in the patient's axes (+X right, +Y anterior, +Z cranial). The
    back by default, where both roots are; a choice, as all of a root lies right behind its colon then."""
    least_height: float = 0.03
    """Height at the ends of a segment [m]. A choice, the least that was found for a sigmoid (3.1 to 12 cm): there the
    colon passes to stretches that are held firmly, and a lower sheet would be tight after millimeters."""
    youngs_modulus: float = 0.2e6
    """Young's modulus of the sheet at small strains [Pa]: 0.088 to 6.86 MPa in pigs (White et al., Mechanical
    characterisation of porcine non-intestinal colorectal tissues); 0.2 MPa is near that of rabbits, three times a shear
    modulus of 21 to 186 kPa."""
    thickness: float = 0.7e-3
    """Thickness of the sheet [m]. Our choice, with ``youngs_modulus`` 140 N/m."""
    stiffening: float = 8.0
    """How fast the sheet stiffens: its tension is E t / b (exp(b strain) - 1). In rabbits the shear modulus grows by
    8.2 times the shear stress. 0 for a sheet that does not stiffen."""
    largest_strain: float = 0.5
    """Strain from which the tension grows linearly. A choice, 54 times as stiff as at first; pigs' tore at 0.8 and
    more, and a law that went on would not be solved at the physics step."""

    @property
    def active(self) -> bool:
        """Whether it is on."""
        return self.enabled

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds, or a segment is unknown.
        """
        require(self, "height", Range(0.0, 0.3, above=True), unit="m")
        require(self, "fullness", Range(1.0, 5.0))
        require(self, "root", Range(-1.0, 1.0))
        require(self, "least_height", Range(0.002, 0.1), unit="m")
        require(self, "youngs_modulus", Range(0.0, 1.0e7), unit="Pa")
        require(self, "thickness", Range(0.0, 0.01), unit="m")
        require(self, "stiffening", Range(0.0, 20.0))
        require(self, "largest_strain", Range(0.0, 2.0))
        if not any(self.root):
            raise FieldError(self, "root", f"is {self.root}, expected a direction.")
        for segment in self.height:
            if segment not in SEGMENTS:
                raise FieldError(self, "height", f"names '{segment}'. {did_you_mean(segment, SEGMENTS)}")
