# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A task's configuration as it is run."""

from __future__ import annotations

from typing import Any

from arcgym.utils.configclass import copy


def resolved(cfg: Any) -> Any:
    """Return a copy of a configuration in which switches such as ``clinical`` have switched on what they stand for.

    A variant of robustness is left out: it switches no effect on, and needs the patients of its trials.
    """
    made = copy(cfg)
    if hasattr(made, "robustness"):
        made.robustness = "none"
    made.resolve()
    return made
