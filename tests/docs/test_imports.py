# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Imports point one way, down the table of packages in architecture.md."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "architecture.md").read_text()
PACKAGES = re.findall(r"^\| `(arcgym\.\w+)` \|", PAGE, re.MULTILINE)
ALLOWED = {("arcgym.benchmarks.fidelity.checks.commands", "arcgym_tasks")}
"""Benchmarks of tasks load their configurations, as the page says."""


def modules() -> Iterator[tuple[str, Path]]:
    """Dotted name and file of every module of the package."""
    for path in sorted((ROOT / "source" / "arcgym").rglob("*.py")):
        yield ".".join(path.relative_to(ROOT / "source").with_suffix("").parts).removesuffix(".__init__"), path


def imports(tree: ast.AST) -> Iterator[str]:
    """Names of the modules that are imported at run time, anywhere in a file."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        else:
            yield from imports(node)


def package(name: str) -> str:
    return ".".join(name.split(".")[:2])


def test_imports_are_found_at_any_depth_but_for_type_checking() -> None:
    code = "if TYPE_CHECKING:\n    import a\ndef f():\n    from b.c import d\nclass C:\n    import e.g"
    assert list(imports(ast.parse(code))) == ["b.c.d", "e.g"]


def test_table_names_every_room() -> None:
    folders = {f"arcgym.{path.parent.name}" for path in (ROOT / "source" / "arcgym").glob("*/__init__.py")}
    assert set(PACKAGES) == folders and len(PACKAGES) == len(folders)


@pytest.mark.parametrize("here", PACKAGES)
def test_room_imports_no_room_below_it(here: str) -> None:
    below = PACKAGES[PACKAGES.index(here) + 1 :]
    files = [(name, path) for name, path in modules() if package(name) == here]
    assert files
    wrong = [
        (name, used) for name, path in files for used in imports(ast.parse(path.read_text())) if package(used) in below
    ]
    assert wrong == []


def test_the_package_names_no_task() -> None:
    found = {
        (name, used.split(".")[0])
        for name, path in modules()
        for used in imports(ast.parse(path.read_text()))
        if used.startswith("arcgym_tasks")
    }
    assert found == ALLOWED
