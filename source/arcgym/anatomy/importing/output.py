# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Write an imported colon into a folder that appears when it is whole."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

from arcgym.anatomy.importing.doubts import refuse
from arcgym.anatomy.importing.pipeline import import_colon
from arcgym.anatomy.importing.preflight import check_paths
from arcgym.anatomy.importing.report import write_report
from arcgym.anatomy.importing.settings import ImportSettings
from arcgym.anatomy.stage import write_colon


def import_to_folder(path: Path, out: Path, settings: ImportSettings, overwrite: bool = False) -> dict[str, Any]:
    """Import a colon into a folder with ``colon.usda``, what it refers to, ``report.json`` and ``report.png``.

    Everything is made in a folder beside it that is renamed at the end; when the import fails, nothing stays.

    Args:
        path: Label volume or surface.
        out: Folder to make.
        settings: Import settings.
        overwrite: Replaces a folder that is empty or was made by an import.

    Returns:
        The figures of the report.

    Raises:
        ImportArgumentError: A path cannot be right; nothing has been read or made.
        ColonImportError: The input cannot become a colon, or what came of it is doubtful.
    """
    check_paths(path, out, overwrite)
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=f".{out.name}-", dir=out.parent) as place:
        made = Path(place) / "colon"
        made.mkdir()
        imported = import_colon(path, settings, made)
        write_colon(imported.stage, made / "colon.usda")
        report = write_report(imported, made)
        if not settings.keep_doubtful:
            refuse(report["doubts"])
        if out.exists():
            out.rename(Path(place) / "replaced")
        made.rename(out)
    return report
