# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Turns a CT segmentation or a surface into a colon stage. Needs the optional dependencies ``arcgym[importer]``."""

from arcgym.anatomy.importing.errors import ColonImportError
from arcgym.anatomy.importing.output import import_to_folder
from arcgym.anatomy.importing.settings import ImportSettings

__all__ = ["ColonImportError", "ImportSettings", "import_to_folder"]
