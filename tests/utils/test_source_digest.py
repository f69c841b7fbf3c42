# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Hashes of code: the same wherever it lies, another when a file of it changes."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest

from arcgym.utils.source_digest import source_digest


def digest_in(folder: Path, monkeypatch: pytest.MonkeyPatch, *modules: str) -> str:
    """Return the hash of modules that lie in a folder."""
    with monkeypatch.context() as patch:
        patch.syspath_prepend(str(folder))
        importlib.invalidate_caches()
        source_digest.cache_clear()
        found = source_digest(*modules)
    source_digest.cache_clear()
    return found


def test_a_package_has_the_hash_of_all_its_files_wherever_it_lies(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for place in ("one", "two"):
        inner = tmp_path / place / "digested" / "inner"
        inner.mkdir(parents=True)
        for file in (inner.parent / "__init__.py", inner / "part.py"):
            file.write_text("number = 1\n")
    first = digest_in(tmp_path / "one", monkeypatch, "digested")
    (tmp_path / "two" / "other.py").write_text("not of it")
    assert digest_in(tmp_path / "two", monkeypatch, "digested") == first
    (tmp_path / "two" / "digested" / "inner" / "part.py").write_text("number = 2\n")
    assert digest_in(tmp_path / "two", monkeypatch, "digested") != first


def test_a_module_that_is_not_there_is_named() -> None:
    with pytest.raises(ModuleNotFoundError, match="no_such_module"):
        source_digest("no_such_module")
