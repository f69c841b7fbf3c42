# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The commit that a run says it was made with, in a checkout and in a copy without one."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from arcgym.envs import provenance
from arcgym.evaluation import result_folder
from arcgym.utils.source_digest import source_digest


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A checkout of one file, whose package the versions are asked of."""
    file = tmp_path / "source" / "arcgym" / "envs" / "provenance.py"
    file.parent.mkdir(parents=True)
    file.write_text("one = 1\n")
    for words in ("init -q", "add .", "-c user.name=a -c user.email=a@b commit -q -m one"):
        subprocess.run(["git", "-C", str(tmp_path), *words.split()], check=True)
    monkeypatch.setattr(provenance, "__file__", str(file))
    monkeypatch.delenv("ARCGYM_COMMIT", raising=False)
    return tmp_path


def test_a_checkout_names_its_commit_and_whether_its_code_is_another(root: Path) -> None:
    head = subprocess.run(["git", "-C", str(root), "rev-parse", "HEAD"], capture_output=True, text=True, check=True)
    commit = {result_folder.COMMIT: head.stdout[:12]}
    assert provenance._commit() == commit
    (root / "notes.txt").write_text("not code")
    assert provenance._commit() == commit
    (root / "source" / "new.py").write_text("two = 2\n")
    assert provenance._commit() == {result_folder.COMMIT: head.stdout[:12] + result_folder.CHANGED}


def test_a_copy_without_a_checkout_says_what_it_is_told(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.rmtree(root / ".git")
    assert provenance._commit() == {result_folder.CODE: source_digest("arcgym", "arcgym_tasks")}
    monkeypatch.setenv("ARCGYM_COMMIT", "abc1234")
    assert provenance._commit() == {result_folder.COMMIT: "abc1234"}
