# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Everything that can be checked before a run: nothing is compiled, and no folder is made, until it has passed."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from arcgym.rl.agent_checks import check_agent
from arcgym.rl.device import choose_device
from arcgym.utils.configclass import validate
from arcgym.utils.errors import UsageError
from arcgym.utils.string import did_you_mean

MOST_STAGES = 3
"""Stages of a list that are read before the run; the environment reads and checks all of them."""


def check_environment(env_cfg: Any, device: str | None, outputs: Sequence[Path] = ()) -> None:
    """Check an environment's configuration, the files that it names, the device, and the folders to write to.

    Args:
        env_cfg: Configuration of the environment.
        device: Device asked for, or None.
        outputs: Files and folders that will be written.

    Raises:
        UsageError: The first thing that is wrong, in one line.
    """
    if env_cfg.scene.num_envs < 1:
        raise UsageError(f"env.scene.num_envs is {env_cfg.scene.num_envs}, expected 1 or more worlds.")
    _in_one_line(validate, env_cfg, "env")
    choose_device(device)
    _check_scene(env_cfg)
    for path in outputs:
        check_writable(path)


def check_run(
    env_cfg: Any, agent_cfg: Any, device: str | None, outputs: Sequence[Path] = (), trains: bool = False
) -> None:
    """Check an environment as :func:`check_environment` does, and the agent that acts in it.

    Raises:
        UsageError: The first thing that is wrong, in one line.
    """
    check_environment(env_cfg, device, outputs)
    _in_one_line(validate, agent_cfg, "agent")
    check_agent(env_cfg, agent_cfg, trains)


def check_values(env_cfg: Any, agent_cfg: Any) -> None:
    """Check the values of both configurations, without reading a stage.

    Raises:
        UsageError: The first thing that is wrong, in one line.
    """
    _in_one_line(validate, env_cfg, "env")
    _in_one_line(validate, agent_cfg, "agent")


def check_writable(path: Path) -> None:
    """Raise unless a file or folder can be made at ``path``, or written where it exists."""
    place = path.resolve()
    while not place.exists():
        place = place.parent
    if place != path.resolve() and not place.is_dir():
        raise UsageError(f"{path} cannot be made: {place} is a file, expected a folder.")
    if not os.access(place, os.W_OK):
        raise UsageError(f"{path} cannot be written: no permission to write in {place}.")


def _check_scene(env_cfg: Any) -> None:
    """Read the stages and look up the presets and the segment that the configuration names."""
    from arcgym.anatomy import read_colon
    from arcgym.assets.endoscope_reader import read_endoscope
    from arcgym.assets.materials import TISSUE_PRESETS
    from arcgym.assets.patient_files import find_stages
    from arcgym.utils.paths import resolve_asset

    colon, endoscope = env_cfg.scene.colon, env_cfg.scene.endoscope
    if colon.material not in TISSUE_PRESETS:
        hint = did_you_mean(colon.material, TISSUE_PRESETS)
        raise UsageError(f"env.scene.colon.material is '{colon.material}', which is no tissue preset. {hint}")
    _in_one_line(read_endoscope, _in_one_line(resolve_asset, endoscope.usd_path))
    segment = getattr(env_cfg, "segment", None)
    count = None if colon.num_patients is None else min(colon.num_patients, MOST_STAGES)
    for path in _in_one_line(find_stages, colon.usd_path, count)[:MOST_STAGES]:
        bounds = _in_one_line(read_colon, path).segment_bounds()
        if segment is not None and segment not in bounds:
            raise UsageError(
                f"env.segment is '{segment}', which the colon {path} does not have. {did_you_mean(segment, bounds)}"
            )


def _in_one_line(check: Callable[..., Any], *args: Any) -> Any:
    """Return what the check returns, and turn its errors into a :class:`UsageError`."""
    try:
        return check(*args)
    except (ValueError, TypeError, LookupError, OSError) as error:
        message = error.args[0] if isinstance(error, KeyError) and error.args else error
        raise UsageError(str(message)) from error
