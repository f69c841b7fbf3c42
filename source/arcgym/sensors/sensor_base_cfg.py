# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Common part of every sensor's configuration."""

from __future__ import annotations

from typing import Any

from arcgym.utils.configclass import MISSING, configclass
from arcgym.utils.validation import require_non_negative


@configclass
class SensorBaseCfg:
    """Common part of every sensor's configuration."""

    class_type: Any = MISSING
    """Class built from this configuration, or its name as ``module:Class``, imported when the scene is built."""

    update_period: float = 0.0
    """Time between two readings [s]; 0 reads after every control step. Raise it for a sensor slower than control."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require_non_negative(self, "update_period", unit="s")
