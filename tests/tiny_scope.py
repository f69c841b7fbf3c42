# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A short endoscope for tests: the shipped one of its kind, cut to a few links, its shaft's twice as long."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from arcgym.assets.endoscope_spec import TIP_LINKS, EndoscopeSpec, capsule_spec, magnetic_spec, proximal_spec
from arcgym.assets.endoscope_stage import write_endoscope


def tiny_scope_spec(kind: str = "proximal", links: int = 6) -> EndoscopeSpec:
    """Returns the last shaft links and the last tip links of the shipped scope, half each; a capsule stays whole."""
    spec = {"capsule": capsule_spec, "magnetic": magnetic_spec, "proximal": proximal_spec}[kind]()
    if kind == "capsule":
        return spec
    end, tip = len(spec.link_length), links // 2
    kept = np.r_[end - TIP_LINKS - (links - tip) : end - TIP_LINKS, end - tip : end]
    hinges = kept[1:] - 1
    stretch = np.where(kept < end - TIP_LINKS, 2.0, 1.0)
    return replace(
        spec,
        link_length=spec.link_length[kept] * stretch,
        link_radius=spec.link_radius[kept],
        link_mass=spec.link_mass[kept] * stretch,
        bending_rigidity=spec.bending_rigidity[hinges],
        torsional_rigidity=spec.torsional_rigidity[hinges],
        hinge_limit=spec.hinge_limit[hinges],
        bending_links=min(spec.bending_links, tip),
    )


def write_tiny_scope(path: Path, kind: str = "proximal", links: int = 6) -> Path:
    """Writes the stage of :func:`tiny_scope_spec` to ``path`` and returns the path."""
    return write_endoscope(tiny_scope_spec(kind, links), path)
