# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The leaderboard: made of the trials of folders that were handed in, or refused with the reason."""

from __future__ import annotations

from pathlib import Path

import pytest
from paper_results import RUN, TASKS, changed, result

from arcgym.cli.main import main
from arcgym.evaluation.leaderboard import entries_table, submissions
from arcgym.evaluation.result_folder import result_folders

ROOT = Path(__file__).resolve().parents[2]
ENTRY = "name: Mine\nby: A. Author\nsees: policy\ntrained_on: colon 1\ntransitions: 2.0e+6\ngpu_hours: 1.5\n"


def test_the_leaderboard_is_computed_from_the_trials_and_refuses_with_the_reason(tmp_path: Path, capsys) -> None:
    for name, more in (("good", ""), ("again", "reproduced: B. Other 2026-12\n")):
        (result(tmp_path / "all" / name) / "entry.yaml").write_text(ENTRY + more)
    page = tmp_path / "page.md"
    page.write_text("# Page\n<!-- entries -->\nold\n<!-- end of entries -->\nend\n")
    assert main(["results", "leaderboard", str(tmp_path / "all"), "--page", str(page)]) == 0
    text = page.read_text()
    assert "old" not in text and text.endswith("<!-- end of entries -->\nend\n")
    line = next(line for line in text.splitlines() if line.startswith(f"| `{TASKS[0]}`"))
    assert line.startswith(f"| `{TASKS[0]}` | Mine | A. Author | 100 (89–100) | 1.00 (1.00–1.00) |")
    assert "| 2e+06 | 1.5 | abc, def, fed | ? | 1/240 s | reproduced: B. Other 2026-12 |" in text
    assert "| abc, def, fed | ? | 1/240 s | self-reported |" in text
    (result(tmp_path / "all" / "wrong", seed=5) / "entry.yaml").write_text(ENTRY)
    result(tmp_path / "all" / "nameless", progress=0.5)
    (tmp_path / "all" / "nameless" / "entry.yaml").write_text("name: Mine\ncost: 3\n")
    assert main(["results", "leaderboard", str(tmp_path / "all"), "--page", str(page)]) == 1
    out = capsys.readouterr().out
    assert "wrong: trial 0 of ARC-Rectum-Magnetic has another patient, seed or group" in out
    assert "nameless: trial 0 of ARC-Rectum-Magnetic succeeded with a progress of 0.5" in out
    assert "lacks by, sees, trained_on, transitions, gpu_hours and has the unknown cost" in out
    assert page.read_text() == text


def test_the_committed_page_has_the_committed_entries() -> None:
    good, refused = submissions(ROOT / "docs" / "leaderboard")
    page = (ROOT / "docs" / "leaderboard.md").read_text()
    assert good and not refused
    assert page.partition("<!-- entries -->\n")[2].partition("<!-- end of entries -->")[0] == entries_table(good)


def test_a_leaderboard_needs_no_page_but_a_page_needs_marks(tmp_path: Path, capsys) -> None:
    (result(tmp_path / "all" / "good") / "entry.yaml").write_text(ENTRY)
    words, page = ["results", "leaderboard", str(tmp_path / "all"), "--page"], tmp_path / "page.md"
    assert main([*words, str(page)]) == main([*words, str(page)]) == 0
    assert page.read_text().startswith("# Leaderboard") and page.read_text().count("## paper") == 1
    page.write_text("# Mine\n")
    with pytest.raises(SystemExit):
        main([*words, str(page)])
    assert "page.md has no place for the tables; expected the lines '<!-- entries -->'" in capsys.readouterr().err


def test_an_entry_that_saw_more_than_it_says_is_refused(tmp_path: Path) -> None:
    inputs = RUN["inputs"] | {TASKS[0]: {"sees": ["policy", "force"], "simulator_depth": False}}
    path = result(tmp_path / "all" / "mine", run={**RUN, "inputs": inputs})
    (path / "entry.yaml").write_text(ENTRY)
    assert submissions(tmp_path / "all") == ([], {path: ["says that it sees policy, and saw force, policy"]})
    (path / "entry.yaml").write_text(ENTRY.replace("sees: policy", "sees: policy, force"))
    assert submissions(tmp_path / "all") == ([path], {})


@pytest.mark.parametrize(
    ("before", "after", "reason"),
    [
        ("2.0e+6", "2e6", None),  # a text in YAML
        ("2.0e+6", "many", "has transitions = 'many', expected a number"),
        ("1.5", "-1", "has gpu_hours = -1, expected a number that is not negative"),
        ("colon 1", "[colon 1, colon 2]", "has trained_on = ['colon 1', 'colon 2'], expected a line of text"),
        ("name: Mine", "name: a|b", None),
    ],
)
def test_what_an_entry_says_has_its_kind(tmp_path: Path, before: str, after: str, reason: str | None) -> None:
    path = result(tmp_path / "all" / "mine")
    (path / "entry.yaml").write_text(ENTRY.replace(before, after))
    good, refused = submissions(tmp_path / "all")
    if reason is None:
        lines = [line for line in entries_table(good).splitlines() if line.startswith("| `")]
        assert len(lines) == len(TASKS) and all("| 2e+06 | 1.5 |" in line and line.count("|") == 16 for line in lines)
    else:
        assert not good and reason in refused[path][0]


def test_a_folder_that_is_not_there_empties_no_page(tmp_path: Path, capsys) -> None:
    page = tmp_path / "page.md"
    page.write_text("<!-- entries -->\nold\n<!-- end of entries -->\n")
    for words in (["leaderboard", "--page", str(page)], ["summary", "--out", str(page)]):
        with pytest.raises(SystemExit):
            main(["results", words[0], str(tmp_path / "nothing"), *words[1:]])
        assert f"There is no folder {tmp_path / 'nothing'}" in capsys.readouterr().err
    assert "old" in page.read_text()


def test_an_entry_of_another_physics_step_is_marked_and_stands_last(tmp_path: Path) -> None:
    for name, run in (("a", {**RUN, "physics_hz": {}}), ("b", RUN)):
        (result(tmp_path / name, run=run) / "entry.yaml").write_text(ENTRY)
    lines = [line for line in entries_table(submissions(tmp_path)[0]).splitlines() if TASKS[0] in line]
    assert "| 1/240 s | self-reported |" in lines[0] and "| 1/480 s‡ | self-reported |" in lines[1]


def test_an_entry_that_rolls_or_goes_back_says_so_in_the_tasks_where_it_does(tmp_path: Path) -> None:
    run = changed(TASKS[0], **{"actions.tip.roll_amplitude": [0.0, 9.0], "actions.tip.back_off_velocity": [0.0, 0.03]})
    (result(tmp_path / "a", run=run) / "entry.yaml").write_text(ENTRY)
    text = entries_table(submissions(tmp_path)[0])
    added = "with a roll to and fro of 9 rad/s, going back at 30 mm/s where its tether no longer comes on"
    assert f"| `{TASKS[0]}` | Mine, {added} | A. Author |" in text
    assert f"| `{TASKS[1]}` | Mine | A. Author |" in text


def test_a_baseline_is_no_entry(tmp_path: Path) -> None:
    """The expert sees the centerline, whatever the entry says."""
    path = result(tmp_path / "all" / "mine", run={**RUN, "agent": "expert", "checkpoint_sha256": []})
    (path / "entry.yaml").write_text(ENTRY)
    reason = "is of the agent 'expert', which is a baseline: an entry has checkpoints"
    assert submissions(tmp_path / "all") == ([], {path: [reason]})


def test_shares_of_processes_are_no_results_of_their_own(tmp_path: Path) -> None:
    path = result(tmp_path / "all" / "mine")
    (path / "entry.yaml").write_text(ENTRY)
    result(path / "parts" / "1_of_2", trials=slice(0, None, 2))
    assert submissions(tmp_path / "all") == ([path], {})
    assert result_folders(tmp_path) == [path] and result_folders(path) == [path]
