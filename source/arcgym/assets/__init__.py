# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Colons and endoscopes: their USD stages, their parameters and their state."""

from typing import TYPE_CHECKING

from arcgym.assets.abdomen_cfg import AbdomenCfg
from arcgym.assets.actuators import ActuatorBaseCfg, BaseDriveCfg, BendingDriveCfg, TipPullCfg
from arcgym.assets.colon_cfg import ColonCfg
from arcgym.assets.endoscope_cfg import (
    CAPSULE_CFG,
    MAGNETIC_CFG,
    PROXIMAL_CFG,
    EndoscopeCfg,
    GradingCfg,
    IntroducerCfg,
)
from arcgym.assets.force_tiers import FORCE_TIERS, ForceTiersCfg
from arcgym.assets.gas_cfg import GasCfg
from arcgym.assets.mesentery_cfg import MesenteryCfg
from arcgym.assets.wall_law_cfg import WallLawCfg
from arcgym.utils.lazy import lazy_names

if TYPE_CHECKING:
    from arcgym.assets.colon import Colon
    from arcgym.assets.colon_data import ColonData
    from arcgym.assets.endoscope import Endoscope
    from arcgym.assets.endoscope_data import EndoscopeData

_LAZY = {
    "Colon": "arcgym.assets.colon",
    "ColonData": "arcgym.assets.colon_data",
    "Endoscope": "arcgym.assets.endoscope",
    "EndoscopeData": "arcgym.assets.endoscope_data",
}

__all__ = [
    "AbdomenCfg",
    "ActuatorBaseCfg",
    "BaseDriveCfg",
    "BendingDriveCfg",
    "CAPSULE_CFG",
    "Colon",
    "ColonCfg",
    "ColonData",
    "Endoscope",
    "EndoscopeCfg",
    "EndoscopeData",
    "FORCE_TIERS",
    "ForceTiersCfg",
    "GasCfg",
    "GradingCfg",
    "IntroducerCfg",
    "MAGNETIC_CFG",
    "MesenteryCfg",
    "PROXIMAL_CFG",
    "TipPullCfg",
    "WallLawCfg",
]

__getattr__ = lazy_names(__name__, _LAZY)
