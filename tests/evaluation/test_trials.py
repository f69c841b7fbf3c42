# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from pathlib import Path

import pytest
import torch

from arcgym.evaluation.suites import FOLDER, read_suites
from arcgym.evaluation.trial_queue import TrialQueue
from arcgym.evaluation.trials import Trial, read_conditions, write_conditions
from arcgym.utils.errors import UsageError

TRIALS = (Trial(0, "colon_1", 11), Trial(1, "colon_2", 12, group=1))


def test_a_file_gives_back_its_trials(tmp_path: Path) -> None:
    write_conditions(tmp_path / "two_v1.csv", TRIALS, "Two trials.\nFor a test.")
    read = read_conditions(tmp_path / "two_v1.csv")
    assert (read.name, read.trials) == ("two_v1", TRIALS)


def test_a_changed_file_has_another_hash(tmp_path: Path) -> None:
    hashes = set()
    for trials in (TRIALS, TRIALS[:1]):
        write_conditions(tmp_path / "a.csv", trials, "")
        hashes.add(read_conditions(tmp_path / "a.csv").sha256)
    assert len(hashes) == 2


SHIPPED = {
    "cross_colon_v1": "706111bebfea0af9",
    "ct_v1": "f40797aec41e4c2e",
    "five_colons_v1": "2958c330008314b4",
    "paper_v1": "9daf4c1f73ff953c",
    "population_v2": "f9905f1ea7b45e90",
    "population_v3": "16b2cfef73a358ce",
    "population_v4": "92c60d0bb93fbbb9",
    "robustness_v2": "5c7867ef5b36f05c",
    "robustness_v3": "9429e1232e5e1d14",
    "robustness_v4": "99dbefcdf27c7e30",
    "withdrawal_population_v1": "1720de6d55c0da78",
    "withdrawal_population_v2": "7a919689f268b7a7",
    "withdrawal_population_v3": "10ad3fe98a421b35",
}
"""Begins of the hashes of the shipped files: a changed one gets another name, and a line here."""


def test_the_shipped_files_are_never_changed() -> None:
    files = sorted((FOLDER / "conditions").glob("*.csv"))
    assert {path.stem: read_conditions(path).sha256[:16] for path in files} == SHIPPED


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "has no trial"),
        ("trial,patient,seed\n0,colon_1,1\n", "expected trial, patient, seed, group"),
        ("trial,patient,seed,group\n0,colon_1,x,0\n", "is no trial"),
        ("trial,patient,seed,group\n0,colon_1,-1,0\n", "expected 0 to 2\\^31"),
        ("trial,patient,seed,group\n0,colon_1,1,0\n0,colon_1,2,0\n", "twice"),
    ],
)
def test_a_wrong_file_is_refused_in_one_line(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "bad.csv").write_text(text)
    with pytest.raises(UsageError, match=message) as refusal:
        read_conditions(tmp_path / "bad.csv")
    assert "\n" not in str(refusal.value)


def test_a_missing_file_names_its_neighbors(tmp_path: Path) -> None:
    write_conditions(tmp_path / "two_v1.csv", TRIALS, "")
    with pytest.raises(UsageError, match="two_v1"):
        read_conditions(tmp_path / "two_v2.csv")


@pytest.mark.parametrize(
    ("suite", "count", "shares"),
    [("paper", 3, [10, 10, 10]), ("paper", 2, [15, 15]), ("population", 3, [67, 67, 66]), ("population", 1, [200])],
)
def test_checkpoints_get_as_many_trials_each(suite: str, count: int, shares: list[int]) -> None:
    conditions = read_conditions(read_suites()[suite].conditions_path)
    numbers = [conditions.checkpoint_number(trial, count) for trial in conditions.trials]
    assert [numbers.count(number) for number in range(count)] == shares
    if count == conditions.groups:
        assert numbers == [trial.group for trial in conditions.trials]


def test_worlds_take_the_next_trial_until_none_is_left() -> None:
    queue = TrialQueue(TRIALS, num_envs=3)
    assert queue(torch.tensor([0, 2])).tolist() == [11, 12]
    assert queue.running == [TRIALS[0], None, TRIALS[1]] and queue.left == 2
    queue(torch.tensor([0]))
    assert queue.running == [None, None, TRIALS[1]] and queue.left == 1
