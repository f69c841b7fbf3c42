# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Objects from configurations that name their class."""

from __future__ import annotations

from typing import Any

from arcgym.utils.string import resolve_callable


def construct(cfg: Any, *args: Any) -> Any:
    """Return ``class_type(cfg, *args)``, the class being given itself or as text ``"module:Class"``.

    Raises:
        ValueError: If the text names nothing that can be called.
    """
    class_type = cfg.class_type
    return (resolve_callable(class_type) if isinstance(class_type, str) else class_type)(cfg, *args)
