# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of what the colon's outside does where it touches itself, besides that loops push each other away."""

from __future__ import annotations

from arcgym.utils.configclass import configclass
from arcgym.utils.validation import Range, require


@configclass
class LoopFrictionCfg:
    """Friction of the colon's outside on itself, and bends that do not fold through themselves, both with
    ``WallSolverCfg.self_contact``. See docs/clinical.md, Loops that rub."""

    enabled: bool = False
    """Whether loops that touch rub on each other. Off, they slide freely: the outside of the bowel is wet and
    smooth."""
    friction: float = 0.05
    """Coulomb coefficient. Abdominal walls of rats slid on glass in saline with 0.078 at 0.4 mm/s, 0.034 at 12 and
    0.045 at 61 mm/s (Loring et al., Lubrication regimes in mesothelial sliding); one number for all speeds is our
    choice, and adhesions are far beyond it. Another one for each world is set by
    :meth:`arcgym.sim.Simulation.write_loop_friction`."""
    stiffness: float = 100.0
    """Stiffness with which two rings that touch hold each other until they slide [N/m]. A choice: pressed by 1 N they
    slide after 0.5 mm. Stiffer, and rings that touch weigh more: by twice this times the squared time step, 0.9 g
    beside some 2 g."""
    bends: bool = False
    """Whether the limbs of one bend push on each other, too, where they lie side by side and would pass through each
    other, as hard as loops do. Switch it on where soft walls are drawn to hairpins. They do not rub."""

    @property
    def active(self) -> bool:
        """Whether anything of it is on."""
        return self.enabled or self.bends

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require(self, "friction", Range(0.0, 2.0))
        require(self, "stiffness", Range(1.0, 2000.0), unit="N/m")
