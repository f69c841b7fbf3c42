# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What every scripted expert has, and how a robot's expert is found."""

from __future__ import annotations

import inspect
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar

import torch

from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.utils.string import did_you_mean, resolve_callable
from arcgym.utils.world_random import WorldRandom

CONTROL_STEP = 0.1
"""Time between two decisions of an expert [s]: 10 Hz, as in the tasks."""


class ExpertBase(ABC):
    """Commands the endoscopes of all worlds, each on its own. N worlds.

    Several worlds of one patient can work together: each with other settings (:meth:`vary`), and those that fall behind
    go on from where another one is (:meth:`take_over`), see :class:`arcgym.start_states.Drive`.
    """

    VARIED: ClassVar[dict[str, tuple[float, float]]] = {}
    """Settings that :meth:`vary` draws, with their ranges; each is an attribute of shape (N,)."""
    FREEING: ClassVar[tuple[str, ...]] = ()
    """Those of them that free a scope which friction holds: worlds that keep all others draw these."""
    PERIOD: ClassVar[int] = 25
    """Control steps after which worlds that work together change places."""

    def __init__(self, scene: InteractiveScene, speed: float | torch.Tensor = 0.04):
        """Keep the scene.

        Args:
            scene: The scene; its state is read anew at every :meth:`act`.
            speed: Speed where the way is free [m/s], one or one a world.
        """
        self.scene = scene
        self.speed = self.each(speed)
        """Speed where the way is free [m/s], shape (N,)."""
        self.disturbance = torch.zeros(scene.num_envs, 3, device=scene.device)
        """Added to where the tip is steered, in its frame, as a share of a unit vector, shape (N, 3)."""

        self._own: dict[str, torch.Tensor] = {}
        self.random: WorldRandom | None = None
        """Random numbers of the worlds' episodes, which make an expert's episode repeatable; None takes torch's."""

    @abstractmethod
    def act(self) -> None:
        """Look at the scene and set the commands of every world; called once a control step of 0.1 s."""

    def reset(self, env_ids: torch.Tensor) -> None:  # noqa: B027 - an expert without memory needs none
        """Forget the past of the worlds ``env_ids``, int64, shape (n,), which start anew; nothing by default."""

    def memory(self) -> list[torch.Tensor]:
        """Return what the expert remembers of every world, N entries each; nothing by default."""
        return []

    def merit(self) -> torch.Tensor:
        """How well each world gets on, shape (N,): the arc length of the tip [m]."""
        return self.scene["endoscope"].data.tip_arc_length

    def take_over(self, env_ids: torch.Tensor, sources: torch.Tensor) -> None:
        """Let the worlds ``env_ids`` remember what the worlds ``sources`` do, both int64, shape (n,)."""
        for array in self.memory():
            array[env_ids] = array[sources]

    def uniform(self, tag: str, *shape: int) -> torch.Tensor:
        """Draw from [0, 1) for every world, shape (N, ...); other tags give other numbers."""
        if self.random is None:
            return torch.rand(self.scene.num_envs, *shape, device=self.scene.device)
        return self.random.uniform(f"expert: {tag}", *shape)

    def normal(self, tag: str, *shape: int) -> torch.Tensor:
        """Draw from the standard normal distribution for every world, shape (N, ...); see :meth:`uniform`."""
        if self.random is None:
            return torch.randn(self.scene.num_envs, *shape, device=self.scene.device)
        return self.random.normal(f"expert: {tag}", *shape)

    def vary(
        self, env_ids: torch.Tensor, generator: torch.Generator | None = None, plain: torch.Tensor | None = None
    ) -> None:
        """Draw the settings of some worlds from their ranges.

        Args:
            env_ids: The worlds, int64, shape (n,).
            generator: Random numbers; None takes torch's.
            plain: Which of them take the settings that the expert was made with, shape (n,), bool, but for
                :attr:`FREEING`, which they draw from the upper half of their ranges; None for none.
        """
        for name, (low, high) in self.VARIED.items():
            setting = getattr(self, name)
            own = self._own.setdefault(name, setting.clone())
            share = torch.rand(len(env_ids), generator=generator, device=self.scene.device)
            drawn = low + (high - low) * share
            if plain is not None:
                kept = 0.5 * (high + drawn) if name in self.FREEING else own[env_ids]
                drawn = torch.where(plain, kept, drawn)
            setting[env_ids] = drawn

    def each(self, value: float | torch.Tensor) -> torch.Tensor:
        """Return a setting for every world, shape (N,)."""
        given = torch.as_tensor(value, dtype=torch.float32, device=self.scene.device)
        return given.reshape(-1).expand(self.scene.num_envs).clone()


def setting_names(made: Callable[..., ExpertBase]) -> list[str]:
    """Return the names of an expert's settings; of a class that hands on ``**settings`` its bases' too."""
    names: list[str] = []
    for one in inspect.getmro(made) if inspect.isclass(made) else [made]:
        function = vars(one).get("__init__") if inspect.isclass(one) else one
        if function is None:
            continue
        parameters = list(inspect.signature(function).parameters.values())[2 if inspect.isclass(one) else 1 :]
        names += [parameter.name for parameter in parameters if parameter.kind is not parameter.VAR_KEYWORD]
        if all(parameter.kind is not parameter.VAR_KEYWORD for parameter in parameters):
            break
    return names


def make_expert(scene: InteractiveScene, **settings: Any) -> ExpertBase:
    """Return the expert that the scene's ``EndoscopeCfg.expert`` names.

    Args:
        scene: The scene.
        settings: Arguments of the expert, such as ``speed`` [m/s].

    Raises:
        ValueError: If the configuration names none, or it has no such setting.
    """
    expert = scene["endoscope"].cfg.expert
    if expert is None:
        raise ValueError(
            f"The robot {scene['endoscope'].path.name} has no scripted expert: set EndoscopeCfg.expert to one, such as "
            "'arcgym.experts.pull_expert:PullExpert', or start from rest with env.start=rest."
        )
    made: Any = resolve_callable(expert) if isinstance(expert, str) else expert
    known = setting_names(made)
    for name in settings:
        if name not in known:
            raise ValueError(f"{made.__name__} has no setting '{name}'. {did_you_mean(name, known)}")
    return made(scene, **settings)
