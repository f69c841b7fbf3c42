# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Check colons.

In reading order:

- :mod:`validate`: a check with its bound, and the checks of wall, course and visual surfaces that a colon has to pass;
- :mod:`stage_checks`: all of them, and those of topology, anchors and file, for any stage;
- :mod:`mesh_checks`: whether a mesh is closed or crosses itself, and what it encloses.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from arcgym.utils.lazy import lazy_names

if TYPE_CHECKING:
    from arcgym.anatomy.validation.stage_checks import inspect_file, inspect_stage
    from arcgym.anatomy.validation.validate import Check, failed

__all__ = ["Check", "failed", "inspect_file", "inspect_stage"]

__getattr__ = lazy_names(
    __name__,
    {
        "Check": "arcgym.anatomy.validation.validate",
        "failed": "arcgym.anatomy.validation.validate",
        "inspect_file": "arcgym.anatomy.validation.stage_checks",
        "inspect_stage": "arcgym.anatomy.validation.stage_checks",
    },
)
