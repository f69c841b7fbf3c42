# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of the gas in a colon."""

from __future__ import annotations

from arcgym.utils.configclass import configclass
from arcgym.utils.validation import FieldError, Range, require, require_non_negative, require_positive

MMHG = 133.322
"""One millimeter of mercury [Pa]."""


@configclass
class GasCfg:
    """Gas that fills the lumen; pressures are above the surrounding air's. See docs/clinical.md, Gas."""

    enabled: bool = False
    """Whether gas is simulated. Switch it on for insufflation, suction and a lumen that collapses. Off, the wall keeps
    the shape in which it was imaged without a pressure, as in every figure measured without gas."""
    pretension: bool = False
    """Whether the wall of a lumen at rest is under the tension that bears the imaging pressure, as an inflated wall is.
    Off, what the two do together is left out at and above that pressure: the wall is as limp there as an empty one,
    and kinks over what pulls in it."""
    imaging_pressure: float = 20.0 * MMHG
    """Pressure in the lumen when the stage's shape was imaged [Pa]: the shape is that of a wall under it. CT
    colonography stops insufflating at 20 to 25 mmHg (McLaughlin et al., ARRS). Change it with the stages."""
    abdominal_pressure: float = 6.5 * MMHG
    """Pressure around the colon [Pa], when it was imaged and now. 6.5 mmHg lying on the back, 5 to 12 in intensive
    care; about 4 mmHg more on the side (De Keulenaer et al. 2009). Another one for now, world by world, is set by
    :meth:`arcgym.assets.Colon.write_gas_to_sim`."""
    start_pressure: float | None = None
    """Pressure at the start of an episode [Pa]; ``None`` takes the imaging pressure, at which the wall is at rest. Tips
    that are free measure 15 mmHg (9 to 57) during colonoscopy (Kozarek et al., Gastroenterology 78:7, 1980)."""
    ambient_pressure: float = 101325.0
    """Absolute pressure of the surrounding air [Pa]. Lower it on a mountain: gas then gives more easily."""
    leak_opening: float = 20.0 * MMHG
    """Pressure that the anus holds around the shaft [Pa]; beyond it gas leaks out. A choice: the imaging pressure, so
    that a colon at rest loses nothing."""
    leak_conductance: float = 5.1e-9
    """Flow out of the anus over the pressure beyond ``leak_opening`` [m^3/(s Pa)], at the lumen's pressure. 0.04 l/min
    for each mmHg: 1.5 l/min of insufflation without an end then come to 57 mmHg, the highest pressure measured at a
    free tip. A choice; 0 closes the anus."""
    suction_depth: float = 1000.0
    """How far below the abdominal pressure suction draws [Pa]: the wall then closes the tip's opening. From half of it
    on the flow falls. A choice; more crumples a soft wall further."""
    least_opening: float = 0.25
    """Share of its imaged volume to which a slice of lumen narrows before its opposite sides touch and prop each other.
    An elastic ring that does not stretch touches itself at 0.271 of its area, in two lobes (Flaherty, Keller and
    Rubinow, SIAM J. Appl. Math. 23:446, 1972). Lower it for a flatter lumen; 0 lets opposite sides pass through each
    other."""
    prop_pressure: float = 1000.0
    """Pressure of the props at half the least opening [Pa]; at a quarter of it three times as much. A choice: as much
    as suction draws. Raise it if a collapsed lumen is to stay nearer to ``least_opening``."""

    @property
    def active(self) -> bool:
        """Whether it is on."""
        return self.enabled

    @property
    def tense(self) -> bool:
        """Whether the wall is under tension at rest."""
        return self.enabled and self.pretension

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require(self, "imaging_pressure", Range(0.0, 2.0e4), unit="Pa")
        require(self, "abdominal_pressure", Range(0.0, 1.0e4), unit="Pa")
        require(self, "start_pressure", Range(-2.0e4, 2.0e4), unit="Pa")
        require_positive(self, "ambient_pressure", unit="Pa")
        require_non_negative(self, "leak_opening", unit="Pa")
        require(self, "leak_conductance", Range(0.0, 1.0e-6), unit="m^3/(s Pa)")
        require(self, "suction_depth", Range(0.0, 2.0e4, above=True), unit="Pa")
        require(self, "least_opening", Range(0.0, 1.0))
        require(self, "prop_pressure", Range(0.0, 1.0e4), unit="Pa")
        if self.imaging_pressure < self.abdominal_pressure:
            raise FieldError(
                self,
                "imaging_pressure",
                f"is {self.imaging_pressure:g} Pa, expected at least the abdominal pressure, "
                f"{self.abdominal_pressure:g} Pa: a colon is imaged open.",
            )
