# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Navigation with a magnetic flexible endoscope, whose tip a magnet pulls on a soft tether."""

from __future__ import annotations

from arcgym.assets import MAGNETIC_CFG, EndoscopeCfg
from arcgym.envs import mdp
from arcgym.utils.configclass import configclass
from arcgym_tasks.navigation.navigation_env_cfg import HORIZON_S, NavigationEnvCfg, NavigationSceneCfg


@configclass
class MagneticSceneCfg(NavigationSceneCfg):
    """Colon 1 with the magnetic flexible endoscope."""

    endoscope: EndoscopeCfg = MAGNETIC_CFG
    """The robot."""


@configclass
class MagneticActionsCfg:
    """Six velocities of the tip in its own frame."""

    tip = mdp.TipVelocityActionCfg()


@configclass
class MagneticEnvCfg(NavigationEnvCfg):
    """Any segment with the magnetic flexible endoscope."""

    scene: MagneticSceneCfg = MagneticSceneCfg()
    """Colon, endoscope, camera."""

    actions: MagneticActionsCfg = MagneticActionsCfg()
    """Action term."""


@configclass
class RectumMagneticEnvCfg(MagneticEnvCfg):
    """``ARC-Rectum-Magnetic``."""

    segment: str = "rectum"
    episode_length_s: float = HORIZON_S["rectum"]


@configclass
class RectumMagneticEnvCfg_PLAY(RectumMagneticEnvCfg):
    """``ARC-Rectum-Magnetic-Play``."""

    def __post_init__(self) -> None:
        """Switch to play mode."""
        super().__post_init__()
        self.play()


@configclass
class SigmoidMagneticEnvCfg(MagneticEnvCfg):
    """``ARC-Sigmoid-Magnetic``."""

    segment: str = "sigmoid"
    episode_length_s: float = HORIZON_S["sigmoid"]


@configclass
class SigmoidMagneticEnvCfg_PLAY(SigmoidMagneticEnvCfg):
    """``ARC-Sigmoid-Magnetic-Play``."""

    def __post_init__(self) -> None:
        """Switch to play mode."""
        super().__post_init__()
        self.play()


@configclass
class DescendingMagneticEnvCfg(MagneticEnvCfg):
    """``ARC-Descending-Magnetic``."""

    segment: str = "descending"
    episode_length_s: float = HORIZON_S["descending"]


@configclass
class DescendingMagneticEnvCfg_PLAY(DescendingMagneticEnvCfg):
    """``ARC-Descending-Magnetic-Play``."""

    def __post_init__(self) -> None:
        """Switch to play mode."""
        super().__post_init__()
        self.play()


@configclass
class SplenicMagneticEnvCfg(MagneticEnvCfg):
    """``ARC-Splenic-Magnetic``."""

    segment: str = "splenic"
    episode_length_s: float = HORIZON_S["splenic"]


@configclass
class SplenicMagneticEnvCfg_PLAY(SplenicMagneticEnvCfg):
    """``ARC-Splenic-Magnetic-Play``."""

    def __post_init__(self) -> None:
        """Switch to play mode."""
        super().__post_init__()
        self.play()
