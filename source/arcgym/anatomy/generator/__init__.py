# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Generate colons from specifications.

In reading order:

- :mod:`spec` (its bounds: :mod:`spec_checks`) is the input; :mod:`spec_file` reads it from YAML, :mod:`population`
  draws random patients, :mod:`patients` holds the five of the benchmark;
- :mod:`generate` runs the stages in between;
- :mod:`centerline` makes the course: :mod:`courses` and :mod:`routes` give control points, :mod:`relaxation` and
  :mod:`acute_bends` move them; :mod:`posture` lays the same wall along another course;
- :mod:`surface` is the lumen's radius by arc length and angle, with its :mod:`folds`; :mod:`lumen_field` the lumen as a
  field in space;
- :mod:`lesions` places diverticula and polyps, :mod:`lesion_shapes` gives them their form;
- :mod:`fitting` makes wall and surfaces of the field, as for any lumen;
- :mod:`acceptance` rejects what is not as the spec asks.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from arcgym.anatomy.generator.spec import ColonSpec, FoldSpec, PolypSpec, SegmentSpec
from arcgym.utils.lazy import lazy_names

if TYPE_CHECKING:
    from arcgym.anatomy.generator.generate import AnatomyError, make_colon
    from arcgym.anatomy.generator.patients import PATIENTS
    from arcgym.anatomy.generator.population import draw_spec
    from arcgym.anatomy.generator.spec_file import read_spec

__all__ = [
    "PATIENTS",
    "AnatomyError",
    "ColonSpec",
    "FoldSpec",
    "PolypSpec",
    "SegmentSpec",
    "draw_spec",
    "make_colon",
    "read_spec",
]

__getattr__ = lazy_names(
    __name__,
    {
        "AnatomyError": "arcgym.anatomy.generator.generate",
        "make_colon": "arcgym.anatomy.generator.generate",
        "PATIENTS": "arcgym.anatomy.generator.patients",
        "draw_spec": "arcgym.anatomy.generator.population",
        "read_spec": "arcgym.anatomy.generator.spec_file",
    },
)
