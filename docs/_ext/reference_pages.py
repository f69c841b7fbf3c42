# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the pages of docs/reference from the code, when the documentation is built."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import reference_configs
import reference_tasks
import reference_terms
from sphinx.application import Sphinx

PAGES = {
    "terms": reference_terms.page,
    "tasks": reference_tasks.tasks_page,
    "actions": reference_tasks.actions_page,
    "observations": reference_tasks.observations_page,
    "configuration": reference_configs.classes_page,
    "paths": reference_configs.paths_page,
}
"""Pages by name; each function returns Markdown."""


def write(folder: Path, names: Iterable[str] = tuple(PAGES)) -> None:
    """Write pages into ``folder``; one that has not changed keeps its time."""
    folder.mkdir(exist_ok=True)
    for name in names:
        path, text = folder / f"{name}.md", PAGES[name]()
        if not path.exists() or path.read_text() != text:
            path.write_text(text)


def setup(app: Sphinx) -> dict[str, Any]:
    """Write all pages before Sphinx looks for its sources."""
    write(Path(app.srcdir) / "reference")
    return {"parallel_read_safe": True}
