# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

import subprocess
import sys
from pathlib import Path

import pytest

from arcgym.evaluation.result_folder import ResultFolder, alone_in, read_run, read_trial_rows
from arcgym.evaluation.sharing import gather
from arcgym.evaluation.summary import summarize, to_markdown
from arcgym.utils.errors import UsageError

RUN = {"agent": "zero", "checkpoint_sha256": [], "suite": "paper", "conditions_sha256": "abc", "overrides": []}


def row(trial: int, success: int, task: str = "ARC-A", progress: float = 0.5) -> dict:
    return {
        "task": task,
        "agent": "zero",
        "trial": trial,
        "group": 0,
        "success": success,
        "end": "success",
        "progress": progress,
    }


def test_rows_are_on_the_disk_as_they_come(tmp_path: Path) -> None:
    folder = ResultFolder(tmp_path, RUN)
    folder.add(row(0, 1))
    assert read_trial_rows(tmp_path) == [row(0, 1)]


def test_a_run_goes_on_after_a_torn_line(tmp_path: Path) -> None:
    ResultFolder(tmp_path, RUN).add(row(0, 1))
    with (tmp_path / "trials.csv").open("a") as file:
        file.write("ARC-A,1,0,")
    again = ResultFolder(tmp_path, RUN)
    again.add(row(1, 0))
    assert again.done("ARC-A") == {0, 1} and read_trial_rows(tmp_path) == [row(0, 1), row(1, 0)]


def test_another_evaluation_does_not_go_on(tmp_path: Path) -> None:
    ResultFolder(tmp_path, RUN)
    with pytest.raises(UsageError, match="agent is 'zero' there and 'random' now"):
        ResultFolder(tmp_path, {**RUN, "agent": "random"})


def test_other_code_does_not_go_on(tmp_path: Path) -> None:
    versions = {"arcgym commit": "abc", "python": "3.11", "torch": "2.13.0"}
    ResultFolder(tmp_path, {**RUN, "versions": versions})
    ResultFolder(tmp_path, {**RUN, "versions": {**versions, "python": "3.12"}})
    with pytest.raises(UsageError, match="was begun with arcgym commit abc, and now it is def"):
        ResultFolder(tmp_path, {**RUN, "versions": {**versions, "arcgym commit": "def"}})


def test_two_evaluations_do_not_write_to_one_folder(tmp_path: Path) -> None:
    """Each would write a heading and all trials. A process that was killed holds nothing."""
    script = "import sys, time\nfrom pathlib import Path\nfrom arcgym.evaluation.result_folder import alone_in\n"
    script += "with alone_in(Path(sys.argv[1])):\n    print('held', flush=True)\n    time.sleep(60)\n"
    with subprocess.Popen([sys.executable, "-c", script, str(tmp_path / "a")], stdout=subprocess.PIPE) as other:
        assert other.stdout is not None and other.stdout.readline() == b"held\n"
        with pytest.raises(UsageError, match="Another evaluation writes to .*/a: wait for it, or give another --out"):
            with alone_in(tmp_path / "a"):
                pass
        with alone_in(tmp_path / "b"), alone_in(tmp_path / "b" / "parts" / "1_of_2"):
            pass
        other.kill()
    with alone_in(tmp_path / "a"):
        pass
    with alone_in(tmp_path / "a"):
        assert list((tmp_path / "a").iterdir()) == []


def test_another_device_does_not_go_on(tmp_path: Path) -> None:
    ResultFolder(tmp_path, {**RUN, "machine": "x86_64, NVIDIA H200"})
    ResultFolder(tmp_path, {**RUN, "machine": "x86_64, NVIDIA H200"})
    with pytest.raises(UsageError, match="was begun on x86_64, NVIDIA H200, and now it is x86_64, no GPU"):
        ResultFolder(tmp_path, {**RUN, "machine": "x86_64, no GPU"})


def test_rows_of_processes_that_were_cut_off_are_gathered(tmp_path: Path) -> None:
    """Two of three shares had begun, one of them after an earlier call that had shared by two."""
    gather(tmp_path)
    assert not (tmp_path / "run.json").exists()
    for name, trial in (("1_of_2", 0), ("1_of_3", 0), ("2_of_3", 1)):
        ResultFolder(tmp_path / "parts" / name, RUN).add(row(trial, 1))
    (tmp_path / "parts" / "3_of_3").mkdir()
    gather(tmp_path)
    assert read_trial_rows(tmp_path) == [row(0, 1), row(1, 1)]
    ResultFolder(tmp_path / "parts" / "3_of_3", {**RUN, "suite": "cecum"})
    with pytest.raises(UsageError, match="suite is 'paper' there and 'cecum' now"):
        gather(tmp_path)


def test_rows_with_other_columns_are_refused(tmp_path: Path) -> None:
    folder = ResultFolder(tmp_path, RUN)
    folder.add(row(0, 1))
    with pytest.raises(ValueError, match="extra"):
        folder.add({**row(1, 1), "extra": 1.0})


def test_a_folder_without_a_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no folder of an evaluation"):
        read_run(tmp_path)


def test_no_finished_trial_is_an_error() -> None:
    with pytest.raises(UsageError, match="No trial was finished"):
        summarize([])


def test_summary_counts_each_task() -> None:
    rows = [row(0, 1), row(1, 1), row(2, 0), row(0, 0, task="ARC-B", progress=0.25)]
    summaries = summarize(rows)
    assert summaries["ARC-A"]["success"].value == pytest.approx(2 / 3)
    assert (summaries["ARC-B"]["trials"], summaries["ARC-B"]["progress"].value) == (1, 0.25)
    assert "| `ARC-A` | 3 | 67 (21–94) | 0.50 (0.50–0.50) |" in to_markdown(summaries)


def test_a_run_goes_on_after_a_first_row_that_was_torn(tmp_path: Path) -> None:
    """The disk is full while head and first row are written: only the head is whole."""
    ResultFolder(tmp_path, RUN)
    (tmp_path / "trials.csv").write_text(",".join(row(0, 1)) + "\nARC-A,0,")
    ResultFolder(tmp_path, RUN).add(row(0, 1))
    assert read_trial_rows(tmp_path) == [row(0, 1)]


def test_an_agent_whose_hash_looks_like_a_number_keeps_its_name(tmp_path: Path) -> None:
    """12345e678901 is a number to Python, and infinite."""
    for agent in ("12345e678901", "123456789012"):
        folder = ResultFolder(tmp_path / agent, RUN)
        folder.add({**row(0, 1), "agent": agent})
        assert read_trial_rows(tmp_path / agent)[0]["agent"] == agent
