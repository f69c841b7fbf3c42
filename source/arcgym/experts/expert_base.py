# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What every scripted expert has, and how a robot's expert is found."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import torch

from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.utils.string import resolve_callable


class ExpertBase(ABC):
    """Commands the endoscopes of all worlds, each on its own. N worlds."""

    def __init__(self, scene: InteractiveScene, speed: float = 0.04):
        """Keep the scene.

        Args:
            scene: The scene; its state is read anew at every :meth:`act`.
            speed: Speed where the way is free [m/s].
        """
        self.scene, self.speed = scene, speed

    @abstractmethod
    def act(self) -> None:
        """Look at the scene and set the commands of every world; called once a control step of 0.1 s."""

    def reset(self, env_ids: torch.Tensor) -> None:  # noqa: B027 - an expert without memory needs none
        """Forget the past of the worlds ``env_ids``, int64, shape (n,), which start anew; nothing by default."""


def make_expert(scene: InteractiveScene, **settings: Any) -> ExpertBase:
    """Return the expert that the scene's ``EndoscopeCfg.expert`` names.

    Args:
        scene: The scene.
        settings: Arguments of the expert, such as ``speed`` [m/s].

    Raises:
        ValueError: If the configuration names none.
    """
    expert = scene["endoscope"].cfg.expert
    if expert is None:
        raise ValueError(
            f"The robot {scene['endoscope'].path.name} has no scripted expert: set EndoscopeCfg.expert to one, such as "
            "'arcgym.experts.pull_expert:PullExpert', or start from rest with env.start=rest."
        )
    return (resolve_callable(expert) if isinstance(expert, str) else expert)(scene, **settings)
