# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration that all actuators share."""

from __future__ import annotations

from typing import Any, ClassVar

from arcgym.utils.configclass import MISSING, configclass


@configclass
class ActuatorBaseCfg:
    """One way in which an endoscope is driven."""

    can_be_none: ClassVar[bool] = True

    class_type: Any = MISSING
    """Class built from this configuration, a subclass of :class:`arcgym.assets.actuators.ActuatorBase`."""
