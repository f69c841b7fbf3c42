# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The page of results, from result folders with made-up trials."""

from __future__ import annotations

import gzip
import shutil
from pathlib import Path
from typing import Any

import pytest
from result_folders import PPO, write_result_folder

from arcgym.cli.main import main
from arcgym.evaluation.baselines import baselines_of
from arcgym.evaluation.results import find_results, method_of
from arcgym.evaluation.results_page import SECTIONS_FILE, read_sections, results_page
from arcgym.evaluation.suites import read_suites

ROOT = Path(__file__).parents[2]
TASK = "ARC-Rectum-Magnetic"
LAGRANGIAN = "rsl_rl_ppo_lagrangian_cfg_entry_point"
REWARD = {"reward": ["shaped", "paper"]}
VELOCITY = {"actions.tip.forward_velocity": [None, 0.04]}


def page(folders: list[Path], tmp_path: Path, *more: str) -> str:
    out = tmp_path / "results.md"
    assert main(["results", "summary", *map(str, folders), "--out", str(out), *more]) == 0
    return out.read_text()


def test_a_cell_has_success_interval_and_the_papers_figure_and_the_others_their_command(tmp_path: Path) -> None:
    """27 of 30: Wilson 74 to 97 %."""
    ours = write_result_folder(tmp_path / "ours", 27, changes={TASK: REWARD | VELOCITY})
    text = page([ours], tmp_path)
    label = "PPO, the paper's reward and constant velocity"
    assert f"| Magnetic | {label} | 90 (74–97) [20] | – [0] | – [40] | – [0] |" in text
    assert "arcgym study paper_table seed=1 algorithm=ppo_paper robot=Magnetic task=sigmoid,descending,splenic" in text
    assert "arcgym study paper_table seed=1 algorithm=ppo robot=Magnetic task=rectum,sigmoid,descending,splenic" in text
    last = "| ppo_paper | 30 | 6 144 | abcdef012345 | 1/240 s | abc1234 | a machine | ours |"
    assert f"| paper | paper_v1 | `ARC-Rectum-Magnetic` {last}" in text


def test_the_committed_page_is_made_of_the_committed_folders(monkeypatch: pytest.MonkeyPatch) -> None:
    """By the command that its first lines name."""
    monkeypatch.chdir(ROOT)
    text = (ROOT / "docs" / "results.md").read_text()
    command = text.partition("Made by `")[2].partition("`")[0]
    assert command == "arcgym results summary docs/data/results --out docs/results.md --figure docs/images/results.png"
    results, left_out = find_results([Path("docs/data/results")])
    assert results_page(results, command, read_sections(), "images/results.png") == text and not left_out


def test_a_roll_to_and_fro_is_named_and_takes_no_other_row(tmp_path: Path) -> None:
    """The same checkpoint with and without, 20 and 10 of 200; an expert that rolls is no baseline."""
    task = "ARC-LeftColon-Magnetic"
    roll = {"changes": {task: {"actions.tip.roll_amplitude": [0.0, 9.0]}}}
    expert = {"agent": "expert", "checkpoint": [], "checkpoint_sha256": [], "training": []}
    folders = [
        write_result_folder(tmp_path / "plain", 10, task, "population"),
        write_result_folder(tmp_path / "rolls", 20, task, "population", **roll),
        write_result_folder(tmp_path / "expert", 30, task, "population", **roll | expert),
    ]
    pushed = {"changes": {task: VELOCITY}, "agent": "zero", "checkpoint": [], "checkpoint_sha256": [], "training": []}
    folders.append(write_result_folder(tmp_path / "zero", 0, task, "population", **pushed))
    text = page(folders, tmp_path)
    assert f"| `{task}` | zero_velocity | 200 | 0 (0–2) |" in text
    assert f"| `{task}` | ppo `abcdef01` | 200 | 5 (3–9) |" in text
    assert f"| `{task}` | ppo_roll9 `abcdef01` | 200 | 10 (7–15) |" in text
    assert f"| `{task}` | expert_roll9 | 200 | 15 (11–21) |" in text
    assert [one.agent for one in baselines_of(find_results(folders)[0])] == []


def test_going_back_is_named_and_is_no_constant_velocity(tmp_path: Path) -> None:
    """45 mm/s; times are named where they are not the task's."""
    task = "ARC-LeftColon-Magnetic"
    back = {"actions.tip.back_off_velocity": [0.0, 0.045]}
    times = {"actions.tip.back_off_after": [4.0, 6.0], "actions.tip.back_off_time": [1.5, 3.0]}
    roll = {"actions.tip.roll_amplitude": [0.0, 9.0]}
    changes = {"": {}, "_back45": back, "_back45_3s_after6s": back | times, "_roll9_back45": back | roll}
    changes |= {"_off": times}  # times of nothing are no name
    folders = [
        write_result_folder(tmp_path / f"run{name}", count, task, "population", changes={task: fields})
        for count, (name, fields) in zip((10, 20, 30, 40, 50), changes.items(), strict=True)
    ]
    text = page(folders, tmp_path)
    for name, share in (("", 5), ("_back45", 10), ("_back45_3s_after6s", 15), ("_roll9_back45", 20), ("", 25)):
        assert f"| `{task}` | ppo{name} `abcdef01` | 200 | {share} (" in text
    assert "`_back45` goes back at 45 mm/s" in text and "velocity" not in text.partition("ppo_back45")[2][:200]


def test_slower_commands_than_the_tasks_are_named(tmp_path: Path) -> None:
    task = "ARC-Withdrawal-Capsule"
    slow = {"changes": {task: {"actions.capsule.linear_scale": [0.05, 0.0065]}}}
    folder = write_result_folder(tmp_path / "slow", 25, task, "withdrawal", **slow)
    assert f"| `{task}` | ppo_slow6.5 `abcdef01` | 50 | 50 (37–63) |" in page([folder], tmp_path)


def test_the_robustness_of_a_policy_that_rolls_is_a_table_of_its_own(tmp_path: Path) -> None:
    task = "ARC-LeftColon-Magnetic:blur_2"
    of = {"robustness": ["none", "blur_2"]}
    roll = of | {"actions.tip.roll_amplitude": [0.0, 9.0]}
    folders = [
        write_result_folder(tmp_path / name, count, task, "robustness", changes={task: fields})
        for name, count, fields in (("plain", 5, of), ("rolls", 10, roll))
    ]
    text = page(folders, tmp_path)
    for name, figure in (("model_3.pt", "25 (11–47)"), ("model_3.pt_roll9", "50 (30–70)")):
        table = text.partition(f"run_1/{name}: ")[2]
        assert f"| blur | no trial | {figure} |" in table[: table.index("blur") + 60]


def test_the_page_names_the_command_that_made_it(tmp_path: Path) -> None:
    ours = write_result_folder(tmp_path / "ours", 3)
    assert f"Made by `arcgym results summary {ours} --out {tmp_path / 'results.md'}`" in page([ours], tmp_path)


def test_other_metrics_have_tables_of_their_own(tmp_path: Path) -> None:
    """15 of 30 arrive, and the others come half the way: the middle half of the trials is 0.5 and 1 in equal parts."""
    text = page([write_result_folder(tmp_path / "ours", 15)], tmp_path)
    centered = text.partition("how well the lumen is centered")[2].partition("\n## ")[0]
    way = text.partition("share of the way")[2].partition("\n## ")[0]
    assert "| Magnetic | PPO, shipped reward | 0.50 (0.50–0.50) | – | – | – |" in centered
    assert "| Magnetic | PPO, shipped reward | 0.75 (0.5" in way


def test_more_training_seeds_are_shown_in_place_of_one(tmp_path: Path) -> None:
    write_result_folder(tmp_path / "all" / "one", 30)
    three = {"checkpoint": ["a", "b", "c"], "checkpoint_sha256": ["1", "2", "3"]}
    write_result_folder(tmp_path / "all" / "three", 3, agents=three["checkpoint"], **three)
    assert "| Magnetic | PPO, shipped reward | 10 (3–26), 3 seeds | – | – | – |" in page([tmp_path / "all"], tmp_path)


def test_a_small_copy_makes_the_same_page(tmp_path: Path) -> None:
    write_result_folder(tmp_path / "all" / "rectum", 27)
    write_result_folder(
        tmp_path / "all" / "left", 7, "ARC-LeftColon-Magnetic", "left_colon", training=[{"agent": LAGRANGIAN}]
    )
    keep = tmp_path / "keep"
    text = page([tmp_path / "all"], tmp_path, "--keep", str(keep))
    assert text == page([keep], tmp_path)
    rows = gzip.decompress((keep / "rectum" / "trials.csv.gz").read_bytes()).decode().splitlines()
    assert ",abcdef012345," in rows[1] and "/far/away" not in rows[1] and ",0.33333," in rows[1]
    assert (keep / "left" / "trials.csv.gz").is_file() and not (keep / "left" / "trials.csv").exists()
    assert "away/cell" not in (keep / "rectum" / "run.json").read_text()
    assert "| `ARC-LeftColon-Magnetic` | ppo_lagrangian `abcdef01` | 50 | 14 (7–26) |" in text


def test_trials_of_an_earlier_version_say_so_and_give_way_to_the_present_ones(tmp_path: Path) -> None:
    run: dict[str, Any] = {"agent": "expert", "checkpoint_sha256": []}
    run |= {"task": "ARC-LeftColon-Magnetic", "suite": "population"}
    old = write_result_folder(tmp_path / "old", 100, **run, conditions_name="population_v2")
    text = page([old], tmp_path)
    assert "| `ARC-LeftColon-Magnetic` | expert, population_v2 | 200 | 50 (43–57) |" in text
    assert "Trials of `population_v2` are of an earlier version of the population" in text
    assert "--suite population --robot Magnetic --agent expert --out" in text
    assert "| population | population_v2 | `ARC-LeftColon-Magnetic` | expert | 200 |" in text
    new = write_result_folder(tmp_path / "new", 20, **run)
    text = page([old, new], tmp_path)
    assert "| expert | 200 | 10 (7–15) |" in text and "population_v2" not in text
    assert "--suite population --robot Magnetic --agent expert --out" not in text


def test_trials_of_another_physics_step_are_marked_and_give_way_to_the_present_ones(tmp_path: Path) -> None:
    """What does not say its step, all that ran before it was written down, had steps of 1/480 s."""
    run: dict[str, Any] = {"agent": "expert", "checkpoint_sha256": [], "task": "ARC-LeftColon-Magnetic"}
    old = write_result_folder(tmp_path / "old", 100, **run, suite="population", physics_hz={})
    cell = write_result_folder(tmp_path / "cell", 27, physics_hz={})
    text = page([old, cell], tmp_path)
    assert "| `ARC-LeftColon-Magnetic` | expert‡ | 200 | 50 (43–57) |" in text
    assert text.count("‡ ran with physics steps of 1/480 s, an earlier default") == 4
    assert "| Magnetic | PPO, shipped reward | 90 (74–97)‡ |" in text
    assert "| 1/480 s | abc1234 | a machine | old |" in text
    assert "--suite population --robot Magnetic --agent expert --out" in text
    new = write_result_folder(tmp_path / "new", 20, **run, suite="population")
    text = page([old, new], tmp_path)
    assert "| expert | 200 | 10 (7–15) |" in text and "| 1/240 s | abc1234 |" in text and "1/480 s | abc" not in text


def test_studies_of_a_fixed_policy_do_not_mix_steps(tmp_path: Path) -> None:
    task = "ARC-Rectum-Magnetic:dense"
    old = write_result_folder(tmp_path / "old", 0, task, "anchors", physics_hz={})
    text = page([old, write_result_folder(tmp_path / "new", 30, task, "anchors")], tmp_path)
    table = text.partition("ablations: anchors")[2].partition("\n## ")[0]
    assert "‡" not in table and "success [%], dense | 100 " in table
    assert "‡ ppo `abcdef01` ran with physics steps of 1/480 s" in page([old], tmp_path)


def test_a_copy_that_grew_keeps_no_rows_of_the_smaller_one(tmp_path: Path) -> None:
    """20 trials are written plainly, 50 are packed, and 20 again are plain again."""
    keep, source = tmp_path / "keep", tmp_path / "all" / "one"
    for task, suite, name in (
        ("ARC-Withdrawal-Capsule", "population_withdrawal", "trials.csv"),
        ("ARC-LeftColon-Magnetic", "left_colon", "trials.csv.gz"),
        ("ARC-Withdrawal-Capsule", "population_withdrawal", "trials.csv"),
    ):
        shutil.rmtree(source, ignore_errors=True)
        write_result_folder(source, 20, task, suite)
        page([tmp_path / "all"], tmp_path, "--keep", str(keep))
        assert [path.name for path in (keep / "one").glob("trials*")] == [name]


def test_limits_stand_beside_a_safe_one(tmp_path: Path) -> None:
    """A policy that learnt under limits with a roll to and fro; another robot's stands elsewhere."""
    training, task = [{"agent": LAGRANGIAN, "limits": {"tip_force": 0.3}}], "ARC-LeftColon-Proximal"
    changes = {task: {"actions.base.roll_amplitude": [0.0, 8.0], "actions.base.roll_period": [4.0, 2.0]}}
    folders = [
        write_result_folder(tmp_path / "safe", 200, task, "population", training=training, changes=changes),
        write_result_folder(tmp_path / "other", 200, "ARC-LeftColon-Magnetic", "population", training=training),
    ]
    table = page(folders, tmp_path).partition("## Safe ones")[2].partition("## Robust")[0]
    assert (
        "| ppo_lagrangian_roll8_2s `abcdef01`, limit tip_force 0.3 | 200 | 100 (98–100) | 1.00 (1.00–1.00) |" in table
    )
    assert "| 0.25 |" in table
    assert "Magnetic" not in table


def test_rules_on_actions_are_marked(tmp_path: Path) -> None:
    inputs = {TASK: {"sees": ["policy"], "simulator_depth": True}}
    training = [{"agent": "rsl_rl_ppo_masked_cfg_entry_point"}]
    text = page([write_result_folder(tmp_path / "masked", 30, inputs=inputs, training=training)], tmp_path)
    assert "| PPO with rules on actions, shipped reward | 100 (89–100)† |" in text


@pytest.mark.parametrize(("sees", "mark"), [(["policy", "critic"], "¶"), (["policy", "force"], "")])
def test_policies_that_see_the_state_are_marked(tmp_path: Path, sees: list[str], mark: str) -> None:
    """In tables of methods and of agents; what a robot can sense is no state."""
    inputs = {"sees": sees, "simulator_depth": False}
    folders = [
        write_result_folder(tmp_path / "sigmoid", 30, inputs={TASK: inputs}),
        write_result_folder(
            tmp_path / "all", 200, "ARC-LeftColon-Magnetic", "population", inputs={"ARC-LeftColon-Magnetic": inputs}
        ),
    ]
    text = page(folders, tmp_path)
    assert f"| PPO, shipped reward | 100 (89–100){mark} |" in text
    assert f"ppo `abcdef01`{mark} | 200 | 100 (98–100) |" in text


@pytest.mark.parametrize(
    ("run", "every", "reason"),
    [
        ({"versions": {"newton": "1.8.0"}}, 1, "neither commit nor code is known"),
        ({"versions": {"arcgym commit": "abc with changes"}}, 1, "its code has changes that the commit has not"),
        ({"training": []}, 1, "trained with is not known"),
        ({"conditions_sha256": "other"}, 1, "the hash of the condition file differs"),
        ({"changes": {TASK: {"episode_length_s": [30.0, 60.0]}}}, 1, "episode_length_s = 60.0, which changes the task"),
        ({}, 11, "has 3 trials, neither all nor each n-th of them"),
    ],
)
def test_what_is_not_known_or_another_task_is_left_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], run: dict[str, Any], every: int, reason: str
) -> None:
    text = page([write_result_folder(tmp_path / "ours", 2, every=every, **run)], tmp_path)
    assert reason in capsys.readouterr().out and "PPO, shipped reward | – | – | – | – |" in text


def test_an_installation_without_a_commit_is_named_by_its_code(tmp_path: Path) -> None:
    text = page(
        [write_result_folder(tmp_path / "ours", 30, versions={"arcgym": "0.1.0", "arcgym code": "c0de"})], tmp_path
    )
    assert "| version 0.1.0, code c0de |" in text


def test_settings_of_an_effect_that_is_off_change_nothing(tmp_path: Path) -> None:
    """Unless it is switched on: then its switch is a change, and its settings are changes as well."""
    shape = {"scene.colon.abdomen.squareness": [6.0, 4.0]}
    off = write_result_folder(tmp_path / "off", 3, changes={TASK: shape})
    on = write_result_folder(tmp_path / "on", 3, changes={TASK: shape | {"scene.colon.abdomen.enabled": [False, True]}})
    found, left_out = find_results([off, on])
    assert [one.folder for one in found] == [off]
    named = {text.partition(" = ")[0].rpartition(".")[2] for text in left_out[on]}
    assert named == {"squareness", "enabled"}


def test_each_tenth_trial_is_a_share_and_says_how_many(tmp_path: Path) -> None:
    found, left_out = find_results([write_result_folder(tmp_path / "ours", 3, every=10)])
    assert len(found[0].rows) == 3 and not left_out
    assert "PPO, shipped reward | 100 (44–100) of 3 |" in page([tmp_path / "ours"], tmp_path)


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({}, "ppo"),
        (REWARD, "ppo_paper_free"),
        (VELOCITY, "ppo_velocity"),
        (REWARD | VELOCITY, "ppo_paper"),
        (REWARD | {"actions.capsule.forward_velocity": [None, 0.04]}, "ppo_paper"),
        (REWARD | {"actions.base.insertion_velocity": [None, 0.04]}, "ppo_paper"),
    ],
)
def test_a_method_is_named_after_agent_reward_and_velocity(changes: dict[str, Any], name: str) -> None:
    assert method_of({"agent": "checkpoint", "training": [{"agent": PPO}], "changes": {TASK: changes}}, TASK) == name
    assert method_of({"agent": "expert"}, TASK) == "expert"


def test_sections_ask_for_suites_that_there_are() -> None:
    """And every row of the first has its label; the study has each of its methods."""
    from arcgym.cli.study import SHIPPED

    sections = read_sections()
    assert {section["suite"] for section in sections} <= set(read_suites()), SECTIONS_FILE
    study = (SHIPPED / "paper_table.yaml").read_text()
    for methods in sections[0]["robots"].values():
        for method in methods:
            assert method in sections[0]["labels"] and method in study


def test_the_picture_is_drawn(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    write_result_folder(tmp_path / "ours", 27, changes={TASK: REWARD | VELOCITY})
    text = page([tmp_path / "ours"], tmp_path, "--figure", str(tmp_path / "images" / "results.png"))
    assert "](images/results.png)" in text
    assert (tmp_path / "images" / "results.png").stat().st_size > 5000
