# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Gas in the lumen: insufflation and suction as an action, pressure as an observation, other bellies by an event.

Pressure is also a load, ``lumen_pressure`` of :data:`arcgym.envs.mdp.LOADS`: its metrics and costs are those of loads.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from arcgym.assets.gas_cfg import MMHG
from arcgym.envs.mdp.actions import VelocityAction
from arcgym.managers import ActionTerm, ActionTermCfg
from arcgym.utils.configclass import configclass
from arcgym.utils.validation import NON_NEGATIVE, POSITIVE, Range, expects, require

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv

__all__ = ["RUPTURE_PRESSURE", "GasFlowAction", "GasFlowActionCfg", "lumen_pressure", "randomize_gas"]

RUPTURE_PRESSURE = 81.0 * MMHG
"""Pressure at which the cecum of cadavers ruptured, the first part of the colon to do so; the sigmoid at 169 mmHg [Pa]
(Kozarek et al., Gastroenterology 78:7, 1980, who also measured the pressure at the tip in 34 patients)."""
LITRES_PER_MINUTE = 1.0 / 60000.0
"""One litre a minute [m^3/s]."""


class GasFlowAction(VelocityAction):
    """Insufflation, and suction below zero; D = 1."""

    cfg: GasFlowActionCfg
    axes = ("insufflation",)
    units = ("l/min",)

    def __init__(self, cfg: GasFlowActionCfg, env: ManagerBasedEnv) -> None:
        """Check that there is gas.

        Raises:
            ValueError: If no gas is simulated.
        """
        super().__init__(cfg, env, [cfg.insufflation], {})
        _ = self._asset.data.lumen_pressure

    def process_actions(self, actions: torch.Tensor) -> None:
        """Clip and scale ``actions``, shape (N, 1)."""
        super().process_actions(actions)
        suction = self.cfg.suction / self.cfg.insufflation
        self._processed.mul_(torch.where(self._processed < 0.0, suction, 1.0))

    def apply_actions(self) -> None:
        """Command the flow."""
        self._asset.set_gas_flow(LITRES_PER_MINUTE * self._processed[:, 0])

    def commanded_actions(self) -> torch.Tensor:
        """Return zeros, shape (N, 1): no expert commands gas."""
        return torch.zeros_like(self._raw)


@configclass
class GasFlowActionCfg(ActionTermCfg):
    """Configuration of :class:`GasFlowAction`."""

    class_type: type[ActionTerm] | str = GasFlowAction
    """The term's class."""

    asset_name: str = "colon"
    """Scene element whose lumen is insufflated."""

    insufflation: float = 1.5
    """Flow at a raw action of one [l/min], at the pressure of the room. With the valve closed endoscopes give 1 to 3
    l/min; on average 0.25 l/min are used (Norway 2003, 218 colonoscopies)."""

    suction: float = 3.0
    """Flow at a raw action of minus one [l/min], out of the lumen. 1 to 10 l/min are common."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        for name in ("insufflation", "suction"):
            require(self, name, Range(0.0, 20.0, above=True), unit="l/min")


@expects(scale=POSITIVE)
def lumen_pressure(env: ManagerBasedEnv, scale: float = 20.0 * MMHG) -> torch.Tensor:
    """Pressure of the gas in the lumen above the room's, at the end of the step, over a scale, shape (N, 1).

    Args:
        env: The environment; its colon has gas.
        scale: Pressure that counts as one [Pa]; the default is that of the imaged shape.
    """
    return env.scene["colon"].data.lumen_pressure[:, None] / scale


@expects(abdominal_pressure=NON_NEGATIVE, start_pressure=NON_NEGATIVE, leak_conductance=NON_NEGATIVE)
def randomize_gas(
    env: ManagerBasedEnv,
    env_ids: torch.Tensor,
    abdominal_pressure: tuple[float, float] | None = (5.0 * MMHG, 12.0 * MMHG),
    start_pressure: tuple[float, float] | None = None,
    leak_conductance: tuple[float, float] | None = None,
) -> None:
    """Give each world a belly and an anus of its own, uniform between bounds; needs ``env.gas``.

    Args:
        abdominal_pressure: Least and largest pressure around the colon [Pa]; None leaves it as it is. 5 to 12 mmHg were
            found lying on the back.
        start_pressure: Of the lumen when an episode starts [Pa].
        leak_conductance: Of the anus [m^3/(s Pa)].
    """
    given = {
        "abdominal_pressure": abdominal_pressure,
        "start_pressure": start_pressure,
        "leak_conductance": leak_conductance,
    }
    drawn = {
        name: bounds[0] + (bounds[1] - bounds[0]) * env.random.uniform(f"gas: {name}", env_ids=env_ids)
        for name, bounds in given.items()
        if bounds is not None
    }
    env.scene["colon"].write_gas_to_sim(**drawn, env_ids=env_ids)
