# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Links between pages: the page is there, and the heading that they name."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = [*(ROOT / name for name in ("README.md", "CONTRIBUTING.md")), *sorted((ROOT / "docs").glob("*.md"))]
EXTENSIONS = ROOT / "docs" / "_ext"
LINK = re.compile(r"\]\(([\w./-]*\.md)?(?:#([^)\s]+))?\)")


def _anchors(page: Path) -> set[str]:
    """Return the names of a page's headings as GitHub makes them, and those given by hand."""
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)
    headings = [
        re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", title) for title in re.findall(r"^#+ +(.+)$", text, re.MULTILINE)
    ]
    named = re.findall(r"^\(([\w-]+)\)=$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).strip().replace(" ", "-") for title in headings} | set(named)


@pytest.fixture(scope="module")
def made() -> Iterator[set[Path]]:
    """Pages that are not in the repository: the build writes them from the code."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(EXTENSIONS))
        import reference_pages

        yield {ROOT / "docs" / "reference" / f"{name}.md" for name in reference_pages.PAGES}
    for file in EXTENSIONS.glob("*.py"):
        sys.modules.pop(file.stem, None)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path, made: set[Path]) -> None:
    lost = []
    for file, anchor in LINK.findall(page.read_text()):
        target = page.parent / file if file else page
        if target in made and not anchor:
            continue
        if not target.is_file() or (anchor and anchor not in _anchors(target)):
            lost.append(f"{file}#{anchor}")
    assert not lost
