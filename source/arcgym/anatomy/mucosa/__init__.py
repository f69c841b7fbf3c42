# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Draw the mucosa's textures; generator and importer share them.

- :mod:`spec`: how it looks;
- :mod:`texture`: color, relief and wetness;
- :mod:`vessels`: the vessels in it, which :mod:`vessel_styles` gives each stretch of the colon.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from arcgym.anatomy.mucosa.spec import MucosaSpec
from arcgym.utils.lazy import lazy_names

if TYPE_CHECKING:
    from arcgym.anatomy.mucosa.texture import make_textures, write_textures

__all__ = ["MucosaSpec", "make_textures", "write_textures"]

__getattr__ = lazy_names(
    __name__,
    {"make_textures": "arcgym.anatomy.mucosa.texture", "write_textures": "arcgym.anatomy.mucosa.texture"},
)
