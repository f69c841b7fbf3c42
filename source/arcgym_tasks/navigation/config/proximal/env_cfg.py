# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Navigation with a colonoscope that is pushed and rolled from outside, with a bending section."""

from __future__ import annotations

from arcgym.assets import PROXIMAL_CFG, EndoscopeCfg
from arcgym.envs import mdp
from arcgym.utils.configclass import configclass
from arcgym_tasks.navigation.navigation_env_cfg import HORIZON_S, NavigationEnvCfg, NavigationSceneCfg


@configclass
class ProximalSceneCfg(NavigationSceneCfg):
    """Colon 1 with the colonoscope pushed from outside."""

    endoscope: EndoscopeCfg = PROXIMAL_CFG
    """The robot."""


@configclass
class ProximalActionsCfg:
    """Insertion and roll of the base, pitch and yaw of the bending section."""

    base = mdp.InsertionActionCfg()


@configclass
class ProximalEnvCfg(NavigationEnvCfg):
    """Any segment with the colonoscope pushed from outside."""

    scene: ProximalSceneCfg = ProximalSceneCfg()
    """Colon, endoscope, camera."""

    actions: ProximalActionsCfg = ProximalActionsCfg()
    """Action term."""


@configclass
class RectumProximalEnvCfg(ProximalEnvCfg):
    """``ARC-Rectum-Proximal``."""

    segment: str = "rectum"
    episode_length_s: float = HORIZON_S["rectum"]


@configclass
class RectumProximalEnvCfg_PLAY(RectumProximalEnvCfg):
    """``ARC-Rectum-Proximal-Play``."""

    def __post_init__(self) -> None:
        """Switch to play mode."""
        super().__post_init__()
        self.play()


@configclass
class SigmoidProximalEnvCfg(ProximalEnvCfg):
    """``ARC-Sigmoid-Proximal``."""

    segment: str = "sigmoid"
    episode_length_s: float = HORIZON_S["sigmoid"]


@configclass
class SigmoidProximalEnvCfg_PLAY(SigmoidProximalEnvCfg):
    """``ARC-Sigmoid-Proximal-Play``."""

    def __post_init__(self) -> None:
        """Switch to play mode."""
        super().__post_init__()
        self.play()


@configclass
class DescendingProximalEnvCfg(ProximalEnvCfg):
    """``ARC-Descending-Proximal``."""

    segment: str = "descending"
    episode_length_s: float = HORIZON_S["descending"]


@configclass
class DescendingProximalEnvCfg_PLAY(DescendingProximalEnvCfg):
    """``ARC-Descending-Proximal-Play``."""

    def __post_init__(self) -> None:
        """Switch to play mode."""
        super().__post_init__()
        self.play()


@configclass
class SplenicProximalEnvCfg(ProximalEnvCfg):
    """``ARC-Splenic-Proximal``."""

    segment: str = "splenic"
    episode_length_s: float = HORIZON_S["splenic"]


@configclass
class SplenicProximalEnvCfg_PLAY(SplenicProximalEnvCfg):
    """``ARC-Splenic-Proximal-Play``."""

    def __post_init__(self) -> None:
        """Switch to play mode."""
        super().__post_init__()
        self.play()
