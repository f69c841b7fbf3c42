# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Tables in the paper's layout, from a few made-up trials."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from arcgym.cli.main import main
from arcgym.cli.results_paper import study_rows
from arcgym.evaluation.paper_tables import TABLES_FILE, paper_table
from arcgym.evaluation.result_folder import ResultFolder
from arcgym.evaluation.suites import read_suites
from arcgym.evaluation.trials import read_conditions
from arcgym.utils.errors import UsageError


def trial(task: str, **values) -> dict:
    base = {"group": 0, "patient": "colon_1/colon.usda", "end": "success", "reward": 6.0, "seconds": 10.0, "s_c": 0.8}
    return {"task": task, **base, "centered_rate": 0.5, **values}


def test_cells_have_the_mean_of_their_trials_and_the_papers_figure() -> None:
    rows = [trial("ARC-Rectum-Magnetic:soft_nu045", s_c=value) for value in (0.8, 0.9, 1.0)]
    rows.append(trial("ARC-Rectum-Magnetic:stiff_nu049", s_c=0.25))
    lines = paper_table(rows, "material").splitlines()
    assert lines[2].startswith("|  | soft_nu045 | soft_nu049 |")
    cells = lines[4].split(" | ")
    assert cells[0] == "| s_c" and cells[1].startswith("0.900 (0.8") and cells[1].endswith(" [0.855]")
    assert cells[2] == "no trial [0.846]" and cells[6] == "0.250 (0.250 to 0.250) [0.83] |"


def test_rates_count_ends_and_step_rewards_are_the_reward_over_the_time() -> None:
    rows = [trial("ARC-Sigmoid-Magnetic:dense", end=end) for end in ("success", "success", "time_out", "stuck")]
    table = paper_table(rows, "anchors")
    assert "| success [%], dense | no trial [100] | 50 (15 to 85) [80] |" in table
    assert "| step reward, dense | no trial [0.695] | 0.600 (0.600 to 0.600) [0.195] |" in table


def test_colons_are_rows_of_their_own() -> None:
    rows = [trial("ARC-Sigmoid-Magnetic", patient="colon_4/colon.usda", end="stuck")]
    assert "| colon 4 | no trial [100] | 0 (0 to 79) [20] |" in paper_table(rows, "cross_colon")


def test_what_has_no_table_or_no_trial_is_refused() -> None:
    with pytest.raises(UsageError, match="no table 'matter'. Did you mean 'material'"):
        paper_table([trial("ARC-Rectum-Magnetic")], "matter")
    with pytest.raises(UsageError, match="nothing to report"):
        paper_table([], "material")


def test_trials_without_a_column_of_the_table_are_refused() -> None:
    """Small copies of result folders have not all columns."""
    with pytest.raises(UsageError, match="trials of ARC-Rectum-Magnetic have no max_tip_force"):
        paper_table([trial("ARC-Rectum-Magnetic")], "forces")


def test_every_table_fits_its_suite() -> None:
    """As many figures as columns, and only variants, segments and patients that the suite has."""
    suites = read_suites()
    for name, table in yaml.safe_load(TABLES_FILE.read_text()).items():
        ((key, columns),) = table["columns"].items()
        for row in table["rows"]:
            assert len(row["paper"]) == len(columns)
            if name not in suites:  # a study's
                continue
            used = {**row, **({key: columns[0]} if key != "metric" else {})}
            assert used.get("variant", "") in ("", *suites[name].variants)
            assert used.get("segment", "Rectum") in ("Rectum", *suites[name].segments)
            patients = {trial.patient for trial in read_conditions(suites[name].conditions_path).trials}
            assert used.get("patient") in (None, *patients)


def test_the_command_writes_the_table_of_the_folders_suite(tmp_path: Path, capsys) -> None:
    folder = ResultFolder(tmp_path / "run", {"suite": "rigid"})
    folder.add(trial("ARC-Sigmoid-Magnetic:deformable", trial=0, seed=1, success=0, end="time_out", progress=0.05))
    assert main(["results", "paper", str(folder.path)]) in (0, None)
    text = (folder.path / "rigid.md").read_text()
    assert "| deformable | 0 (0 to 79) [0] | 0.050 (0.050 to 0.050) [0.0236] | 100 (21 to 100) [100] |" in text
    assert text in capsys.readouterr().out


def test_tasks_that_were_evaluated_one_by_one_share_a_table(tmp_path: Path, capsys) -> None:
    for segment, s_c in (("Rectum", 0.25), ("Splenic", 0.75)):
        folder = ResultFolder(tmp_path / segment, {"suite": "material"})
        folder.add(trial(f"ARC-{segment}-Magnetic:soft_nu045", trial=0, seed=1, success=1, s_c=s_c))
    folders = [str(tmp_path / "Rectum"), str(tmp_path / "Splenic")]
    assert main(["results", "paper", *folders]) in (0, None)
    text = (tmp_path / "Rectum" / "material.md").read_text()
    assert "| s_c | 0.500 (" in text
    ResultFolder(tmp_path / "other", {"suite": "anchors"})
    with pytest.raises(SystemExit):
        main(["results", "paper", *folders, str(tmp_path / "other")])
    assert "give those of one suite" in capsys.readouterr().err


def test_a_study_has_a_table_of_its_cells(tmp_path: Path) -> None:
    """Two cells of the ablation: constrained PPO with all of the reward has the paper's figure beside it."""
    from arcgym.rl.first_episodes import write_rows
    from arcgym.studies.cell import Cell

    for algorithm, s_c in (("ppo", 0.5), ("ppo_lagrangian", 0.75)):
        cell = Cell(tmp_path, "ARC-Splenic-Magnetic", algorithm, 1, {"env.reward": "paper"})
        (cell.folder / "run_1").mkdir(parents=True)
        cell.write_state("finished")
        write_rows(cell.folder / "run_1" / "episodes.csv", [trial("", s_c=s_c, success=1)])
    rows = study_rows(tmp_path)
    assert [row["trained_with"] for row in rows] == ["paper", "paper"]
    table = paper_table(rows, "reward_ablation")
    assert "| PPO, R | no trial | no trial | no trial | 0.500 (0.500 to 0.500) |" in table
    assert "| 0.750 (0.750 to 0.750) [0.814] |" in table
