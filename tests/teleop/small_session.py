# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What sessions in the tiny colon are started with."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

from arcgym.teleop.choices import Choice

SMALL = ("env.scene.camera.width=36", "env.scene.camera.height=36")


def choice(colon: Path, robot: str = "Proximal", **changes) -> Choice:
    return Choice(f"ARC-Splenic-{robot}", patient=str(colon), start="rest", overrides=SMALL, **changes)


def until(condition: Callable[[], bool], seconds: float = 60.0) -> None:
    """Wait until something is so."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.01)
