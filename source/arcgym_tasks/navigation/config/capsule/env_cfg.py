# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Navigation with a capsule of 10 x 20 mm that a magnet moves."""

from __future__ import annotations

from arcgym.assets import CAPSULE_CFG, EndoscopeCfg
from arcgym.envs import mdp
from arcgym.utils.configclass import configclass
from arcgym_tasks.navigation.navigation_env_cfg import HORIZON_S, NavigationEnvCfg, NavigationSceneCfg


@configclass
class CapsuleSceneCfg(NavigationSceneCfg):
    """Colon 1 with the magnetically moved capsule."""

    endoscope: EndoscopeCfg = CAPSULE_CFG
    """The robot."""


@configclass
class CapsuleActionsCfg:
    """Six velocities of the capsule in its own frame."""

    capsule = mdp.TipVelocityActionCfg(linear_scale=0.05)


@configclass
class CapsuleEnvCfg(NavigationEnvCfg):
    """Any segment with the magnetically moved capsule."""

    scene: CapsuleSceneCfg = CapsuleSceneCfg()
    """Colon, endoscope, camera."""

    actions: CapsuleActionsCfg = CapsuleActionsCfg()
    """Action term."""


@configclass
class RectumCapsuleEnvCfg(CapsuleEnvCfg):
    """``ARC-Rectum-Capsule``."""

    segment: str = "rectum"
    episode_length_s: float = HORIZON_S["rectum"]


@configclass
class RectumCapsuleEnvCfg_PLAY(RectumCapsuleEnvCfg):
    """``ARC-Rectum-Capsule-Play``."""

    def __post_init__(self) -> None:
        """Switch to play mode."""
        super().__post_init__()
        self.play()


@configclass
class SigmoidCapsuleEnvCfg(CapsuleEnvCfg):
    """``ARC-Sigmoid-Capsule``."""

    segment: str = "sigmoid"
    episode_length_s: float = HORIZON_S["sigmoid"]


@configclass
class SigmoidCapsuleEnvCfg_PLAY(SigmoidCapsuleEnvCfg):
    """``ARC-Sigmoid-Capsule-Play``."""

    def __post_init__(self) -> None:
        """Switch to play mode."""
        super().__post_init__()
        self.play()


@configclass
class DescendingCapsuleEnvCfg(CapsuleEnvCfg):
    """``ARC-Descending-Capsule``."""

    segment: str = "descending"
    episode_length_s: float = HORIZON_S["descending"]


@configclass
class DescendingCapsuleEnvCfg_PLAY(DescendingCapsuleEnvCfg):
    """``ARC-Descending-Capsule-Play``."""

    def __post_init__(self) -> None:
        """Switch to play mode."""
        super().__post_init__()
        self.play()


@configclass
class SplenicCapsuleEnvCfg(CapsuleEnvCfg):
    """``ARC-Splenic-Capsule``."""

    segment: str = "splenic"
    episode_length_s: float = HORIZON_S["splenic"]


@configclass
class SplenicCapsuleEnvCfg_PLAY(SplenicCapsuleEnvCfg):
    """``ARC-Splenic-Capsule-Play``."""

    def __post_init__(self) -> None:
        """Switch to play mode."""
        super().__post_init__()
        self.play()
