# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Leaves the importer's tests out where its optional dependencies (arcgym[importer]) are not installed."""

from __future__ import annotations

from importlib.util import find_spec

if not all(find_spec(name) for name in ("SimpleITK", "skimage", "vtkmodules", "matplotlib")):
    collect_ignore_glob = ["test_*.py"]
