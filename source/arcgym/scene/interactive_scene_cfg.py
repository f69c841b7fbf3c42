# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of a scene."""

from __future__ import annotations

from typing import Any

from arcgym.assets import ColonCfg, EndoscopeCfg
from arcgym.utils.configclass import MISSING, configclass
from arcgym.utils.validation import require_at_least


@configclass
class InteractiveSceneCfg:
    """One colon, one endoscope and the sensors, in every world.

    Subclass it to add sensors: every further field whose value has a ``class_type`` becomes an entry of the scene.
    """

    class_type: Any = "arcgym.scene.interactive_scene:InteractiveScene"
    """Class built from this configuration."""
    num_envs: int = 64
    """Number of worlds, batched in one model. Memory grows in proportion, some MiB a world."""
    colon: ColonCfg = ColonCfg()
    """The patient."""
    endoscope: EndoscopeCfg = MISSING
    """The robot, such as :data:`arcgym.assets.PROXIMAL_CFG`."""
    camera: Any = None
    """Camera at the tip (:class:`arcgym.sensors.EndoscopeCameraCfg`); ``None`` for state-based tasks, which saves its
    time."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require_at_least(self, 1, "num_envs")
