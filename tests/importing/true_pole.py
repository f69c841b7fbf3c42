# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Where the cecum of a generated colon ends."""

from __future__ import annotations

import numpy as np

from arcgym.anatomy import ColonStage

_BEAM = 0.003
"""Distance from the straight way on within which the wall's vertices are looked for [m]; they lie about 2 mm apart."""


def true_pole(stage: ColonStage) -> np.ndarray:
    """Return where the centerline, gone straight on, meets the wall [m], shape (3,).

    Lines of generated colons end 10 to 24 mm before it (docs/patients.md, "Known flaws").
    """
    line = stage.centerline.points.astype(float)
    ahead = (line[-1] - line[-3]) / np.linalg.norm(line[-1] - line[-3])
    offset = stage.visual.points - line[-1]
    along = offset @ ahead
    aside = np.linalg.norm(offset - np.outer(along, ahead), axis=1)
    return line[-1] + along[(along > -_BEAM) & (aside < _BEAM)].min() * ahead
