# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Open a USD file that ARCGym is to read, and check its units."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

from pxr import Tf, Usd, UsdGeom

from arcgym.anatomy.stage.types import StageError


def open_stage(path: Path, missing: Callable[[], str], meters: str, up: str) -> Usd.Stage:
    """Open a stage in meters with Z up.

    Args:
        path: The file.
        missing: Returns advice where there is no such file.
        meters: Advice where it has other units.
        up: Advice where another axis points up.

    Raises:
        StageError: There is no such file, it is no USD, or has other units.
    """
    if not path.is_file():
        raise StageError(path, "", "", "no such file", missing())
    try:
        usd = Usd.Stage.Open(str(path))
    except Tf.ErrorException as error:
        cause = error.args[0].commentary.strip()
        raise StageError(path, "", "", f"not a USD file ({cause})", "Pass a .usda, .usdc or .usd file") from error
    units = UsdGeom.GetStageMetersPerUnit(usd)
    if not math.isclose(units, 1.0, rel_tol=1e-5):
        found = f"found {units:g}" if UsdGeom.StageHasAuthoredMetersPerUnit(usd) else "not set, which means 0.01"
        raise StageError(path, "/", "metersPerUnit", f"{found}, expected 1", meters)
    axis = UsdGeom.GetStageUpAxis(usd)
    if axis != UsdGeom.Tokens.z:
        raise StageError(path, "/", "upAxis", f"found {axis}, expected Z", up)
    return usd
