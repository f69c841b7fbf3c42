# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Check colons.

In reading order:

- :mod:`checks`: a figure and the bound that it has to keep;
- :mod:`wall_checks`: the wall on its own, also of colons in the making;
- :mod:`stage_checks`: everything about a stage, in memory or in a file;
- :mod:`passage`: room for a scope's stiff head;
- :mod:`mesh_checks`: whether a mesh is closed or crosses itself, and what it encloses.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from arcgym.utils.lazy import lazy_names

if TYPE_CHECKING:
    from arcgym.anatomy.validation.checks import Check, failed
    from arcgym.anatomy.validation.stage_checks import inspect_file, inspect_stage

__all__ = ["Check", "failed", "inspect_file", "inspect_stage"]

__getattr__ = lazy_names(
    __name__,
    {
        "Check": "arcgym.anatomy.validation.checks",
        "failed": "arcgym.anatomy.validation.checks",
        "inspect_file": "arcgym.anatomy.validation.stage_checks",
        "inspect_stage": "arcgym.anatomy.validation.stage_checks",
    },
)
