# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A result folder as one page of HTML."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest
from paper_results import RUN, result

from arcgym.cli.main import main
from arcgym.evaluation.result_folder import ResultFolder
from arcgym.evaluation.suites import read_suites
from arcgym.evaluation.trials import read_conditions


def test_the_page_holds_tables_and_pictures_in_one_file(tmp_path: Path) -> None:
    path = result(tmp_path / "mine", end="time_out", success=0, progress=0.25)
    assert main(["results", "page", str(path)]) == 0
    page = (path / "page.html").read_text()
    assert page.count("data:image/png;base64,") == 2 and "http" not in page
    assert "<td>97 (83–99)</td>" in page  # 29 of 30, Wilson
    assert "<td>ARC-Rectum-Magnetic</td><td>time_out</td><td>1</td>" in page


def test_a_page_of_trials_that_all_succeed(tmp_path: Path) -> None:
    suite = read_suites()["left_colon"]
    conditions = read_conditions(suite.conditions_path)
    run = {**RUN, "agent": "expert", "suite": "left_colon", "conditions_sha256": conditions.sha256}
    folder = ResultFolder(tmp_path / "a", run)
    for trial in conditions.trials:  # 50
        row = {"task": suite.tasks("Magnetic")[0], "agent": "expert", **vars(trial), "success": 1, "end": "success"}
        folder.add({**row, "reward": 1.0, "seconds": 20.0, "progress": 1.0})
    assert main(["results", "page", str(folder.path)]) == 0
    assert "<td>100 (93–100)</td>" in (folder.path / "page.html").read_text()


@pytest.mark.parametrize("words", [["page", "mine"], ["summary", "mine", "--out", "a.md", "--figure", "a.png"]])
def test_pictures_without_their_package_are_refused(tmp_path: Path, monkeypatch, capsys, words: list[str]) -> None:
    monkeypatch.chdir(tmp_path)
    result(tmp_path / "mine")
    monkeypatch.setattr(importlib.util, "find_spec", lambda name, *_: None)
    with pytest.raises(SystemExit):
        main(["results", *words])
    assert (
        "needs the package 'matplotlib', which is not installed: pip install 'arcgym[study]'" in capsys.readouterr().err
    )


def test_the_page_says_what_was_run_in_words(tmp_path: Path) -> None:
    training = [{"task": "T", "seconds": 6.512866989000031}]
    path = result(tmp_path / "mine", run={**RUN, "training": training, "changes": {"T": {}}})
    assert main(["results", "page", str(path)]) == 0
    page = (path / "page.html").read_text()
    assert "<td>seconds 6.51287, task T</td>" in page and "<td>T: none</td>" in page and "{&#x27;" not in page


def test_a_folder_without_trials_has_no_page(tmp_path: Path) -> None:
    ResultFolder(tmp_path / "mine", RUN)
    with pytest.raises(SystemExit):
        main(["results", "page", str(tmp_path / "mine")])
