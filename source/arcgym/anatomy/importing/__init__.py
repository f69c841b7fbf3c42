# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Turns a CT segmentation or a surface into a colon stage. Needs the optional dependencies ``arcgym[importer]``."""

from .errors import ColonImportError
from .output import import_to_folder
from .settings import ImportSettings

__all__ = ["ColonImportError", "ImportSettings", "import_to_folder"]
