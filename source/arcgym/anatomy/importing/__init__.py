# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Import a CT segmentation or a surface as a colon stage. Needs the optional dependencies ``arcgym[importer]``.

In reading order:

- :mod:`settings`, :mod:`formats`, :mod:`arguments`, :mod:`preflight`, :mod:`errors`: settings, files and their checks;
- :mod:`output` makes the folder, :mod:`pipeline` runs the stages in between;
- :mod:`volumes` and :mod:`surfaces` read a file onto a :mod:`arcgym.anatomy.voxel_grid`; :mod:`openings` finds where a
  surface is open;
- :mod:`cleaning` keeps the colon's pieces, with :mod:`bridging` between them;
- :mod:`path_search` finds the path through the lumen on voxels: :mod:`clearance` and :mod:`tree` of the lumen,
  :mod:`colon_path` in the tree with its :mod:`anal_end`, :mod:`cecal_end` and :mod:`attached_lumen`, which
  :mod:`cutting` cuts off, and :mod:`poles`; :mod:`orientation` says which end is the anus;
- :mod:`smooth_centerline` makes a smooth curve of the path, with :mod:`cecum_fit` and :mod:`polar`;
- :mod:`placement` moves it to the stage's frame, :mod:`segment_borders` divides it into segments;
- :mod:`arcgym.anatomy.meshing` fits the meshes, :mod:`report` writes figures and pictures.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from arcgym.anatomy.importing.errors import ColonImportError, ImportArgumentError
from arcgym.anatomy.importing.settings import ImportSettings
from arcgym.utils.lazy import lazy_names

if TYPE_CHECKING:
    from arcgym.anatomy.importing.output import import_to_folder

__all__ = ["ColonImportError", "ImportArgumentError", "ImportSettings", "import_to_folder"]

__getattr__ = lazy_names(__name__, {"import_to_folder": "arcgym.anatomy.importing.output"})
