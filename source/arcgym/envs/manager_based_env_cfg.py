# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of environments made of managers."""

from __future__ import annotations

from typing import Any, Literal

from arcgym.managers import RecorderManagerBaseCfg
from arcgym.scene import InteractiveSceneCfg
from arcgym.sim import SimulationCfg
from arcgym.utils import MISSING, configclass


@configclass
class ViewerCfg:
    """What videos show."""

    env_id: int = 0
    """World to look at."""

    wall_color: Literal["displacement", "strain", "tension", "force"] = "displacement"
    """What the wall's colour shows in the outside view: how far it has moved, its strain, the pull of its anchors, or
    the force of the links beside it."""

    wall_full_scale: float | None = None
    """Value of the wall that gets the last colour [m, strain or N]; None for one that suits a pushed colonoscope."""

    scope_color: Literal["force", "plain"] = "force"
    """Whether the scope is coloured by the force of the wall on each link."""


@configclass
class ManagerBasedEnvCfg:
    """An environment that observes and acts, without a reward."""

    scene: InteractiveSceneCfg = MISSING
    """Worlds, colon, endoscope and camera."""

    sim: SimulationCfg = SimulationCfg()
    """Physics."""

    observations: Any = MISSING
    """Observation groups: a configuration class, or a dict, of :class:`ObservationGroupCfg`."""

    actions: Any = MISSING
    """Action terms: a configuration class, or a dict, of :class:`ActionTermCfg`."""

    events: Any = None
    """Event terms: a configuration class, or a dict, of :class:`EventTermCfg`; None for none."""

    recorders: RecorderManagerBaseCfg | None = None
    """What to record and where to, such as :class:`arcgym.envs.mdp.TrajectoryRecorderCfg`; None for nothing, which
    costs nothing."""

    viewer: ViewerCfg = ViewerCfg()
    """What videos show."""

    decimation: int = 48
    """Physics steps in a control step. With ``sim.dt`` = 1/480 s, 48 gives control at 10 Hz."""

    seed: int | None = None
    """Seed of all random numbers, set before the scene is built. None leaves the generators as they are, -1 draws
    one."""

    log_dir: str | None = None
    """Folder for files that terms write; set by the training script."""

    def validate_config(self) -> None:
        """Checks numbers.

        Raises:
            ValueError: If the decimation is below one.
        """
        if self.decimation < 1:
            raise ValueError(
                f"decimation is the number of physics steps in a control step: >= 1, got {self.decimation}."
            )
