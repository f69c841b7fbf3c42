# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A short endoscope for tests: the shipped one of its kind, cut to a few links."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from arcgym.assets.endoscope_spec import EndoscopeSpec, capsule_spec, magnetic_spec, proximal_spec
from arcgym.assets.endoscope_stage import write_endoscope


def tiny_scope_spec(kind: str = "proximal", links: int = 6) -> EndoscopeSpec:
    """Returns the base half and the tip half of the shipped scope; a capsule stays whole."""
    spec = {"capsule": capsule_spec, "magnetic": magnetic_spec, "proximal": proximal_spec}[kind]()
    if kind == "capsule":
        return spec
    keep = lambda values, count: np.r_[values[: count - count // 2], values[len(values) - count // 2 :]]  # noqa: E731
    return replace(
        spec,
        link_length=keep(spec.link_length, links),
        link_radius=keep(spec.link_radius, links),
        link_mass=keep(spec.link_mass, links),
        bending_rigidity=keep(spec.bending_rigidity, links - 1),
        hinge_limit=keep(spec.hinge_limit, links - 1),
        bending_links=min(spec.bending_links, links // 2),
    )


def write_tiny_scope(path: Path, kind: str = "proximal", links: int = 6) -> Path:
    """Writes the stage of :func:`tiny_scope_spec` to ``path`` and returns the path."""
    return write_endoscope(tiny_scope_spec(kind, links), path)
