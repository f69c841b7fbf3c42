# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Everything that an environment's future depends on, kept and brought back: for an undo that leaves no trace."""

from __future__ import annotations

import dataclasses
import types
from collections import deque
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
import warp as wp

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv

PLAIN = (type(None), bool, int, float, complex, str, bytes, tuple, frozenset, torch.Size)
"""Types whose values cannot change."""
Place = tuple[Any, Any]
"""A dict, list or deque, and a key or index in it."""


class EnvMemory:
    """State of all worlds, of the managers with their terms, of the sensors, and of torch's random numbers.

    Recorders are left out: a recording is shortened by :meth:`arcgym.managers.RecorderManager.shorten`. Terms are
    found by walking through the attributes of the environment, so that those of one's own are kept too.
    """

    def __init__(self, env: ManagerBasedEnv) -> None:
        """Keep the state as it is now, between two steps."""
        self._env = env
        self._worlds = {name: array.clone() for name, array in env.sim.world_arrays().items()}
        settings = dict(env.sim.world_settings())
        self._settings = [(value, value.clone()) for value in settings.values()]
        self._sensors = [
            (sensor, sensor.time_since_update, [(value, value.clone()) for value in sensor.memory().values()])
            for sensor in env.scene.sensors.values()
        ]
        self._random = torch.get_rng_state()
        self._device_random = torch.cuda.get_rng_state(env.device) if str(env.device).startswith("cuda") else None
        self._arrays: list[tuple[Place, Any, Any]] = []
        self._values: list[tuple[Place, Any]] = []
        self._contents: list[tuple[Any, Any]] = []
        self._keep(vars(env), {id(one) for one in self._left_out()})

    @property
    def worlds(self) -> dict[str, torch.Tensor]:
        """Complete state of the simulation, as of :meth:`arcgym.sim.Simulation.world_arrays`; not to be written to."""
        return self._worlds

    @torch.inference_mode(False)
    @torch.no_grad()
    def restore(self) -> None:
        """Bring the state back; any number of times."""
        env = self._env
        for container, content in self._contents:
            container.clear()
            (container.update if isinstance(container, dict) else container.extend)(content)
        for (container, key), value in self._values:
            container[key] = value
        for (container, key), array, content in self._arrays:
            _copy(array, content)
            container[key] = array
        for value, content in self._settings:
            value.copy_(content)
        env.sim.write_state(self._worlds)
        env.sim.forward()
        for sensor, since_update, pairs in self._sensors:
            sensor.time_since_update = since_update
            for value, content in pairs:
                value.copy_(content)
            if hasattr(sensor.data, "frame"):
                sensor.data.frame += 1
        torch.set_rng_state(self._random)
        if self._device_random is not None:
            torch.cuda.set_rng_state(self._device_random, env.device)

    def _left_out(self) -> Iterator[Any]:
        env: Any = self._env
        yield from (env, env.scene, env.sim, env.cfg, env.spec, env._view, env.recorder_manager)
        yield from (env.scene[name] for name in env.scene.keys())  # noqa: SIM118 - a scene is not a dict

    def _keep(self, container: Any, seen: set[int]) -> None:
        """Keep what a dict, list or deque holds, and what is below it."""
        if id(container) in seen:
            return
        seen.add(id(container))
        items = list(container.items() if isinstance(container, dict) else enumerate(container))
        for key, value in items:
            place = (container, key)
            if isinstance(value, (torch.Tensor, np.ndarray, wp.array)):
                self._arrays.append((place, value, _clone(value)))
            elif isinstance(value, PLAIN):
                self._values.append((place, value))
            elif isinstance(value, (dict, list, deque)):
                if id(value) not in seen and value is not None:
                    self._contents.append((value, dict(value) if isinstance(value, dict) else list(value)))
                self._keep(value, seen)
            else:
                self._keep_object(value, seen)

    def _keep_object(self, value: Any, seen: set[int]) -> None:
        """Keep the attributes of an object; of a term's configuration, those of the object that computes the term."""
        if _is_config(value):
            value = getattr(value, "func", None)
        if _has_state(value) and id(value) not in seen:
            seen.add(id(value))
            self._keep(vars(value), seen)


def _is_config(value: Any) -> bool:
    return dataclasses.is_dataclass(value) and type(value).__name__.endswith("Cfg")


def _has_state(value: Any) -> bool:
    """Whether an object may have attributes that change; configurations, functions, classes and modules have none."""
    fixed = (type, types.ModuleType, types.FunctionType, types.BuiltinFunctionType, types.MethodType)
    return hasattr(value, "__dict__") and not isinstance(value, fixed) and not _is_config(value)


def _clone(value: Any) -> Any:
    if isinstance(value, torch.Tensor):
        return value.detach().clone()
    return wp.clone(value) if isinstance(value, wp.array) else value.copy()


def _copy(value: Any, content: Any) -> None:
    """Write what was kept into the array that it was kept of."""
    if isinstance(value, wp.array):
        wp.copy(value, content)
    elif isinstance(value, torch.Tensor):
        if value.is_inference() or value.requires_grad:
            return
        value.copy_(content)
    elif value.flags.writeable:
        value[...] = content
