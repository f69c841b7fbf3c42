# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Arguments of environments, those of ``gymnasium.make`` and the options of ``reset``: checked before they act."""

from __future__ import annotations

import operator
from collections.abc import Collection
from typing import Any

import torch
import warp as wp

from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.configclass import is_config, validate
from arcgym.utils.errors import UsageError
from arcgym.utils.registry import CFG_SUFFIX, load_cfg
from arcgym.utils.string import did_you_mean

ARGUMENTS = ("cfg", "render_mode", "num_envs", "device", "seed")
"""Arguments of environments and of ``gymnasium.make``; ``gymnasium.make_vec`` adds ``to_numpy``."""

RESET_OPTIONS = ("env_ids", "reset_mask")
"""Options of ``reset``."""


class ArgumentError(TypeError):
    """A wrong argument, in one line: what ``gymnasium.make`` adds, the ``repr`` of all arguments, is left out."""

    def __init__(self, message: str) -> None:
        """Keep the message up to the addition."""
        super().__init__(message.partition(" was raised from the environment creator")[0])


def refuse_unknown(arguments: Collection[str]) -> None:
    """Check arguments that no parameter took; further configurations of a registered task pass.

    Raises:
        ArgumentError: If there is an unknown one, naming the nearest.
    """
    for name in arguments:
        if not name.endswith(CFG_SUFFIX):
            raise ArgumentError(f"The environment has no argument '{name}'. {did_you_mean(name, ARGUMENTS)}")


def check_cfg(cfg: Any) -> None:
    """Check a configuration before anything is built of it.

    Raises:
        ValueError: A field is missing, wrong or unknown.
    """
    try:
        validate(cfg)
    except TypeError as error:  # gymnasium.make would add the whole configuration
        raise UsageError(str(error)) from error


def choose_cfg(cfg: Any, entry_point: str | None, *, num_envs: int | None, device: str | None, seed: int | None) -> Any:
    """Return the configuration to build.

    Args:
        cfg: The user's, returned as it is unless one of the others changes it: then a copy is.
        entry_point: ``"module:Class"`` of the registered one, for when ``cfg`` is None.
        num_envs: Number of worlds; None leaves that of the configuration.
        device: Device of the simulation; None leaves that of the configuration.
        seed: Seed of all random numbers; None leaves that of the configuration.

    Raises:
        ArgumentError: If there is no configuration, it is none, or a number is no whole number.
    """
    if cfg is None and entry_point is None:
        raise ArgumentError("An environment needs a cfg, or gymnasium.make with the name of a registered task.")
    if cfg is not None and not is_config(cfg):
        given = f"the class {cfg.__name__}; call it" if isinstance(cfg, type) else f"of type {type(cfg).__name__}"
        raise ArgumentError(f"The environment's cfg is {given}, expected an instance of a configuration class.")
    if cfg is None or not num_envs is device is seed is None:
        cfg = load_cfg(entry_point if cfg is None else cfg)
    if num_envs is not None:
        cfg.scene.num_envs = _whole_number("num_envs", num_envs)
    if device is not None:
        cfg.sim.device = str(device)
    if seed is not None:
        cfg.seed = _whole_number("seed", seed)
    return cfg


def check_device(device: str) -> None:
    """Check that this machine has a device.

    Raises:
        ValueError: If it has not, with those it has.
    """
    known = [str(found.alias) for found in wp.get_devices()]
    if device not in known and not (device == "cuda" and wp.is_cuda_available()):
        raise ValueError(f"The device is '{device}'; this machine has {', '.join(known)}.")


def check_render_mode(mode: str | None, known: Collection[str]) -> None:
    """Check that a render mode is among those of the environment's metadata.

    Raises:
        ValueError: If it is not.
    """
    if mode is not None and mode not in known:
        raise ValueError(f"render_mode is '{mode}', expected None or one of {', '.join(known)}.")


def worlds_to_reset(options: dict[str, Any] | None, num_envs: int, device: str) -> torch.Tensor | None:
    """Return the worlds that the options of a reset name, int64, ascending, shape (n,); None for all.

    Args:
        options: ``env_ids``, world indices, or ``reset_mask``, one bool a world; both as sequence, array or tensor.
        num_envs: Number of worlds N.
        device: Device of the result.

    Raises:
        ValueError: If an option is unknown, both are given, or the mask has another shape or type.
        TypeError: If the indices are no whole numbers.
        IndexError: If a world does not exist.
    """
    for name in options or ():
        if name not in RESET_OPTIONS:
            raise ValueError(f"reset has no option '{name}'. {did_you_mean(name, RESET_OPTIONS)}")
    if not options:
        return None
    if len(options) > 1:
        raise ValueError("reset got both env_ids and reset_mask; give one of them.")
    if "reset_mask" in options:
        return _masked_worlds(torch.as_tensor(options["reset_mask"], device=device), num_envs)
    env_ids = torch.as_tensor(options["env_ids"], device=device).flatten()
    if len(env_ids) and (env_ids.dtype == torch.bool or env_ids.is_floating_point()):
        raise TypeError(f"reset's env_ids are {env_ids.dtype}, expected whole numbers; a bool a world is a reset_mask.")
    env_ids = env_ids.unique().long()
    if len(env_ids) and not 0 <= int(env_ids[0]) <= int(env_ids[-1]) < num_envs:
        raise IndexError(f"reset's env_ids are {env_ids.tolist()}; worlds go from 0 to {num_envs - 1}.")
    return env_ids


def _whole_number(name: str, value: Any) -> int:
    try:
        return operator.index(value)
    except TypeError:
        raise ArgumentError(f"{name} is {value!r} of type {type(value).__name__}, expected a whole number.") from None


def _masked_worlds(mask: torch.Tensor, num_envs: int) -> torch.Tensor:
    if mask.dtype != torch.bool or mask.shape != (num_envs,):
        raise ValueError(
            f"reset_mask is {mask.dtype} of shape {tuple(mask.shape)}, expected torch.bool of shape ({num_envs},)."
        )
    return mask.nonzero().flatten()
