# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The shipped scopes in other lengths: their stages are written into the cache folder."""

from __future__ import annotations

import os
from pathlib import Path

from arcgym.assets.endoscope_spec import magnetic_spec, proximal_spec
from arcgym.assets.endoscope_stage import write_endoscope
from arcgym.utils.paths import cache_dir
from arcgym.utils.string import did_you_mean

SPECS = {"magnetic": magnetic_spec, "proximal": proximal_spec}
"""Specification of each scope with a shaft as a function of its length [m]."""


def has_lengths(usd_path: str) -> bool:
    """Return whether a stage is that of a shipped scope with a shaft, which can be had in other lengths."""
    return Path(usd_path).stem in SPECS


def stage_of_length(stage: Path, length: float) -> Path:
    """Return the stage of a shipped scope in another length.

    Args:
        stage: Stage of the shipped scope.
        length: Length of the whole scope, with the base link, which stays outside [m].

    Raises:
        ValueError: If it is none of the shipped scopes with a shaft.
    """
    if not has_lengths(str(stage)):
        raise ValueError(
            f"EndoscopeCfg.length is {length:g} m, but {stage.name} is no shipped scope with a shaft. "
            f"{did_you_mean(stage.stem, SPECS)} Write a stage of your own with arcgym.assets.endoscope_stage."
        )
    path = cache_dir() / "endoscopes" / f"{stage.stem}_{1000.0 * length:.0f}mm.usda"
    partial = path.with_name(f".{path.stem}.{os.getpid()}.usda")
    path.parent.mkdir(parents=True, exist_ok=True)
    write_endoscope(SPECS[stage.stem](length), partial)
    os.replace(partial, path)
    return path
