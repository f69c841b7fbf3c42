# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of environments made of managers."""

from __future__ import annotations

from typing import Any

from arcgym.managers import RecorderManagerBaseCfg
from arcgym.scene import InteractiveSceneCfg
from arcgym.sim import SimulationCfg
from arcgym.utils import MISSING, configclass
from arcgym.utils.validation import FieldError, require_at_least
from arcgym.viewers.viewer_cfg import ViewerCfg


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
    """Records and where they go, such as :class:`arcgym.envs.mdp.TrajectoryRecorderCfg`; None for nothing, which
    costs nothing."""

    viewer: ViewerCfg = ViewerCfg()
    """Picture of ``env.render()`` and of videos: which world, from where, in which colors."""

    decimation: int = 24
    """Physics steps in a control step. With ``sim.dt`` = 1/240 s, 24 gives control at 10 Hz."""

    seed: int | None = None
    """Seed of all random numbers, set before the scene is built. None leaves the generators as they are, -1 draws
    one."""

    log_dir: str | None = None
    """Folder for files that terms write; set by the training script."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require_at_least(self, 1, "decimation")
        require_at_least(self, -1, "seed")
        if self.scene.num_envs < 1:  # a scene of one's own may lack this check
            raise FieldError(self, "scene.num_envs", f"is {self.scene.num_envs}, expected 1 or more worlds.")
        if self.viewer.env_id >= self.scene.num_envs:
            text = f"is {self.viewer.env_id}, but scene.num_envs is {self.scene.num_envs}: worlds count from 0."
            raise FieldError(self, "viewer.env_id", text)

    def resolve(self) -> None:
        """Write what follows from other fields; called once, when an environment is built of the checked fields."""
