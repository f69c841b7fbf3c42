# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The policies in assets/policies are small, whole and what they say."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from arcgym.evaluation.result_folder import read_run
from arcgym.evaluation.results import find_results
from arcgym.rl.checkpoint import file_sha256
from arcgym.rl.params import read_params
from arcgym.rl.pretrained import ABOUT, FILE, folder_of

POLICIES = sorted(path.parent for path in (Path(__file__).parents[2] / "assets" / "policies").glob(f"*/{FILE}"))


def test_there_is_one_for_the_demo() -> None:
    assert "leftcolon-magnetic" in [path.name for path in POLICIES]


@pytest.mark.parametrize("folder", POLICIES, ids=lambda path: path.name)
def test_a_policy_is_small_and_has_hash_parameters_and_curve(folder: Path) -> None:
    about, params = json.loads((folder / ABOUT).read_text()), read_params(folder)
    assert sum(path.stat().st_size for path in folder.rglob("*") if path.is_file()) < 2_000_000
    assert params is not None and folder_of(params.task) == folder.name and about["task"] == params.task
    assert about["sha256"] == file_sha256(folder / FILE) and about["trained_on"] and about["transitions"] > 0
    assert len((folder / "curves.csv").read_text().splitlines()) > 2


@pytest.mark.parametrize("folder", POLICIES, ids=lambda path: path.name)
def test_its_evaluations_are_whole_and_of_this_very_file(folder: Path) -> None:
    results, left_out = find_results([folder])
    assert left_out == {} and results
    assert all(read_run(one.folder)["checkpoint_sha256"] == [file_sha256(folder / FILE)] for one in results)


@pytest.mark.parametrize("folder", POLICIES, ids=lambda path: path.name)
def test_it_names_no_folder_of_the_machine_that_trained_it_and_says_what_it_began_with(folder: Path) -> None:
    texts = {path.name: path.read_text() for path in (*folder.glob("params/*.yaml"), folder / ABOUT)}
    assert [name for name, text in texts.items() if re.search(r"[\s\"'](/|~|[A-Za-z]:\\)\w", text)] == []
    params, about = read_params(folder), json.loads(texts[ABOUT])
    assert params is not None
    began_with = about["began_with"] and about["began_with"]["policy"]
    assert began_with == params.agent.get("init_policy")
