# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Draw the mucosa's textures; generator and importer share them.

- :mod:`spec`: how it looks;
- :mod:`texture`: color, relief and wetness;
- :mod:`vessels`: the vessels in it, which :mod:`vessel_styles` gives each stretch of the colon.
"""
