# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Trials in the tiny colon give the same rows in one world and in four."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from tiny import write_tiny_colon

from arcgym.cli.evaluate import load_trial_cfgs
from arcgym.cli.main import main
from arcgym.evaluation.evaluate import _run_batch
from arcgym.evaluation.identity import changes_of
from arcgym.evaluation.options import EvaluationOptions
from arcgym.evaluation.result_folder import ResultFolder, read_run, read_trial_rows
from arcgym.evaluation.trials import Trial, read_conditions, write_conditions
from arcgym.utils.errors import UsageError
from arcgym.utils.hydra import apply_overrides
from arcgym.utils.registry import load_cfg_from_registry


def evaluate(folder: Path, conditions: Path, *more: str) -> list[dict]:
    """Rows of a rectum in which episodes last four control steps."""
    words = f"evaluate --agent random --tasks ARC-Rectum-Capsule --device cpu --out {folder} --conditions {conditions}"
    overrides = [
        "env.start=rest",
        "env.episode_length_s=0.4",
        "env.scene.camera.width=16",
        "env.scene.camera.height=16",
    ]
    main([*words.split(), *more, *overrides])
    return sorted(read_trial_rows(folder), key=lambda row: row["trial"])


@pytest.fixture
def conditions(tmp_path: Path, tiny_colon_path: Path) -> Path:
    path = tmp_path / "five_v1.csv"
    write_conditions(path, [Trial(k, str(tiny_colon_path), 100 + k) for k in range(5)], "Five trials.")
    return path


def test_rows_do_not_depend_on_the_number_of_worlds(tmp_path: Path, conditions: Path) -> None:
    one = evaluate(tmp_path / "one", conditions, "--num_envs", "1")
    assert [row["trial"] for row in one] == [0, 1, 2, 3, 4]
    assert len({row["reward"] for row in one}) == 5
    assert evaluate(tmp_path / "four", conditions, "--num_envs", "4") == one


@pytest.mark.slow
def test_thirty_trials_come_out_alike_in_one_world_in_six_and_in_thirty(tmp_path: Path, tiny_colon_path: Path) -> None:
    path = tmp_path / "thirty_v1.csv"
    write_conditions(path, [Trial(k, str(tiny_colon_path), 100 + k) for k in range(30)], "Thirty trials.")
    one = evaluate(tmp_path / "one", path, "--num_envs", "1")
    assert len({row["reward"] for row in one}) == 30
    for number in ("6", "30"):
        assert evaluate(tmp_path / number, path, "--num_envs", number) == one


@pytest.mark.slow
def test_two_processes_share_the_trials(tmp_path: Path, conditions: Path, capsys) -> None:
    """Rows of both are in one folder, with what was changed; cut off, the same call goes on, alone or not."""
    one = evaluate(tmp_path / "one", conditions)
    (tmp_path / "cut").mkdir()
    for name in ("run.json", "trials.csv"):
        (tmp_path / "cut" / name).write_bytes((tmp_path / "one" / name).read_bytes())
    assert evaluate(tmp_path / "cut", conditions, "--processes", "2") == one
    log = (tmp_path / "cut" / "parts" / "1_of_2.log").read_text()
    assert "ARC-Rectum-Capsule: 0 of 3 trials to run" in log
    assert evaluate(tmp_path / "two", conditions, "--processes", "2") == one
    assert read_run(tmp_path / "two")["changes"] == read_run(tmp_path / "one")["changes"]
    assert [len(read_trial_rows(tmp_path / "two" / "parts" / name)) for name in ("1_of_2", "2_of_2")] == [3, 2]
    (tmp_path / "two" / "trials.csv").unlink()
    assert evaluate(tmp_path / "two", conditions, "--processes", "2") == one
    with pytest.raises(SystemExit):
        evaluate(tmp_path / "wrong", conditions, "--processes", "2", "env.no_such_field=1")
    assert "no_such_field" in capsys.readouterr().err


def test_shares_of_two_machines_make_a_whole(tmp_path: Path, conditions: Path, capsys) -> None:
    shares = [tmp_path / "a", tmp_path / "b"]
    rows = [evaluate(folder, conditions, "--share", f"{k}/2") for k, folder in enumerate(shares, start=1)]
    assert [[row["trial"] for row in of] for of in rows] == [[0, 2, 4], [1, 3]]
    main(["results", "merge", str(tmp_path / "all"), *map(str, shares)])
    assert len(read_trial_rows(tmp_path / "all")) == 5
    with pytest.raises(SystemExit):
        evaluate(tmp_path / "c", conditions, "--share", "3/2")
    assert "'3/2' is no share" in capsys.readouterr().err


def test_the_experts_rows_do_not_depend_on_the_number_of_worlds(tmp_path: Path, conditions: Path) -> None:
    one = evaluate(tmp_path / "one", conditions, "--num_envs", "1", "--agent", "expert")
    assert len({row["reward"] for row in one}) == 5
    assert evaluate(tmp_path / "three", conditions, "--num_envs", "3", "--agent", "expert") == one


def test_rows_do_not_depend_on_the_company_of_patients(tmp_path: Path, tiny_colon_path: Path) -> None:
    """Three patients with two trials each: all in six worlds, in two worlds that change patients, and each alone."""
    stages = [str(tiny_colon_path)]
    for name, bend in (("bent", 0.5), ("turned", 1.0)):
        (tmp_path / name).mkdir()
        stages.append(str(write_tiny_colon(tmp_path / name, bend=bend)))
    path = tmp_path / "three_v1.csv"
    write_conditions(path, [Trial(k, stages[k % 3], 100 + k) for k in range(6)], "Six trials.")
    together = evaluate(tmp_path / "together", path)
    assert [row["patient"] for row in together] == 2 * stages
    # Each row's patient is the world's own one: lengths of tubes are the same, courses are not.
    assert len({row["reward"] for row in together}) == 6
    assert evaluate(tmp_path / "two", path, "--num_envs", "2") == together
    assert evaluate(tmp_path / "alone", path, "--num_patients", "1", "--num_envs", "1") == together


def test_an_evaluation_that_was_cut_off_goes_on(tmp_path: Path, conditions: Path) -> None:
    whole = evaluate(tmp_path / "run", conditions)
    file = tmp_path / "run" / "trials.csv"
    file.write_bytes(b"".join(file.read_bytes().splitlines(keepends=True)[:3]))
    assert evaluate(tmp_path / "run", conditions) == whole


def test_what_processes_had_run_is_not_run_again(tmp_path: Path, conditions: Path, capsys) -> None:
    """The first of two processes had ended two trials of its three when both were stopped; one process goes on."""
    whole = evaluate(tmp_path / "run", conditions)
    part = tmp_path / "cut" / "parts" / "1_of_2"
    evaluate(part, conditions, "--share", "1/2")
    file = part / "trials.csv"
    file.write_bytes(b"".join(file.read_bytes().splitlines(keepends=True)[:3]))
    capsys.readouterr()
    assert evaluate(tmp_path / "cut", conditions) == whole
    assert "ARC-Rectum-Capsule: 3 of 5 trials to run" in capsys.readouterr().out


def test_agents_of_two_kinds_are_no_evaluation(tmp_path: Path, conditions: Path, capsys) -> None:
    """Its rows would name a checkpoint that nothing identifies."""
    with pytest.raises(SystemExit):
        evaluate(tmp_path / "run", conditions, "--agent", "zero,model.pt")
    assert "--agent is zero,model.pt; expected checkpoints" in capsys.readouterr().err


def test_more_training_seeds_than_groups_are_refused(tmp_path: Path) -> None:
    """All fifty trials of the five colons are one group: the second checkpoint would be named and never run."""
    from arcgym.evaluation.identity import run_record
    from arcgym.evaluation.options import EvaluationOptions
    from arcgym.evaluation.suites import read_suites
    from arcgym.evaluation.trials import read_conditions

    conditions = read_conditions(read_suites()["left_colon"].conditions_path)
    with pytest.raises(UsageError, match="has 2 checkpoints, and trials of five_colons_v1 have 1 group"):
        run_record(["ARC-LeftColon-Magnetic"], conditions, EvaluationOptions(("1.pt", "2.pt"), "left_colon"))


@pytest.mark.parametrize(("device", "name"), [("cpu", "no GPU"), ("cuda:1", "GPU cuda:1"), (None, "GPU cuda:0")])
def test_the_machine_is_that_which_ran_the_trials(monkeypatch, device: str | None, name: str) -> None:
    """On a machine with two GPUs."""
    import torch

    from arcgym.evaluation.identity import run_record
    from arcgym.evaluation.options import EvaluationOptions
    from arcgym.evaluation.suites import read_suites
    from arcgym.evaluation.trials import read_conditions

    monkeypatch.setattr(torch.cuda, "is_available", lambda: True)
    monkeypatch.setattr(torch.cuda, "device_count", lambda: 2)
    monkeypatch.setattr(torch.cuda, "get_device_name", lambda device=None: f"GPU {device}")
    conditions = read_conditions(read_suites()["paper"].conditions_path)
    run = run_record(["ARC-Rectum-Magnetic"], conditions, EvaluationOptions(("zero",), "paper", device=device))
    assert run["machine"].endswith(f", {name}")


def test_the_shipped_conditions_are_whole() -> None:
    from arcgym.evaluation.suites import read_suites
    from arcgym.evaluation.trials import read_conditions

    sizes = {name: len(read_conditions(suite.conditions_path).trials) for name, suite in read_suites().items()}
    assert (sizes["paper"], sizes["five_colons"], sizes["population"], sizes["ct"]) == (30, 50, 200, 20)
    assert read_suites()["left_colon_in_situ"].overrides == ("env.scene.colon.material=in_situ",)


def test_the_conditions_are_of_the_present_population() -> None:
    """Another generator makes other patients: it needs a condition file of another name."""
    from arcgym.anatomy.generator.splits import read_splits
    from arcgym.evaluation.suites import read_suites
    from arcgym.evaluation.trials import read_conditions

    splits, path = read_splits(), read_suites()["population"].conditions_path
    assert f"splits {splits.version}, generator {splits.generator}" in path.read_text()
    assert [trial.patient for trial in read_conditions(path).trials] == [
        f"population:{seed}" for seed in splits.seeds["test"]
    ]
    path = read_suites()["population_withdrawal"].conditions_path
    assert f"splits {splits.version}, generator {splits.generator}" in path.read_text()
    assert [trial.patient for trial in read_conditions(path).trials] == [
        f"population:{seed}" for seed in splits.seeds["test"][:20]
    ]


def test_trials_of_an_earlier_version_are_the_same_but_for_the_patients() -> None:
    from arcgym.evaluation.suites import read_suites
    from arcgym.evaluation.trials import read_conditions

    renewed = {suite.conditions: suite for suite in read_suites().values() if suite.earlier}
    assert sorted(renewed) == ["population_v4", "robustness_v4", "withdrawal_population_v3"]
    for suite in renewed.values():
        for name in suite.earlier:
            before = read_conditions(suite.conditions_path.with_stem(name))
            assert before.trials == read_conditions(suite.conditions_path).trials and before.sha256
            assert suite.conditions_of(before.sha256).name == name
        assert suite.conditions_of("unknown").name == suite.conditions


def test_what_was_made_easier_is_written_down(tmp_path: Path, conditions: Path) -> None:
    evaluate(tmp_path / "run", conditions)
    changes = read_run(tmp_path / "run")["changes"]["ARC-Rectum-Capsule"]
    assert changes["start"] == ["segment", "rest"] and changes["episode_length_s"] == [None, 0.4]
    assert not [path for path in changes if path.startswith("scene.colon")]


def test_fields_of_an_effect_that_is_off_change_no_task() -> None:
    """The default of the abdomen's shape changed, and a policy trained before meets the same task, without abdomen."""
    task = "ARC-LeftColon-Magnetic"
    cfg = load_cfg_from_registry(task, "env_cfg_entry_point")
    usual = cfg.scene.colon.abdomen.squareness
    cfg.scene.colon.abdomen.squareness = 4.0
    assert changes_of(task, cfg) == {}
    cfg.scene.colon.abdomen.enabled = True
    prefix = "scene.colon.abdomen"
    assert changes_of(task, cfg) == {f"{prefix}.enabled": [False, True], f"{prefix}.squareness": [usual, 4.0]}


def test_fields_of_an_effect_that_a_switch_switches_on_change_the_task() -> None:
    """Sheets of another fullness change nothing without sheets, and the task with ``env.clinical=[mesentery]``."""
    for more, found in (([], []), (["env.clinical=[mesentery]"], ["clinical", "scene.colon.mesentery.fullness"])):
        cfg = load_cfg_from_registry("ARC-LeftColon-Magnetic", "env_cfg_entry_point")
        apply_overrides({"env": cfg}, ["env.scene.colon.mesentery.fullness=2.0", *more])
        assert sorted(changes_of("ARC-LeftColon-Magnetic", cfg)) == found


def test_a_start_that_fails_leaves_no_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "mine.csv"
    write_conditions(path, [Trial(0, "colon_9", 100)], "A patient that is not there.")
    with pytest.raises(SystemExit):
        evaluate(tmp_path / "out", path)
    error = capsys.readouterr().err
    assert "colon_9: no such file" in error and len(error.splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_an_evaluation_does_not_go_on_with_other_settings(tmp_path: Path) -> None:
    folder = ResultFolder(tmp_path / "a", {"agent": "zero", "suite": "paper"})
    folder.note_changes("A", {"sim.dt": [1.0, 2.0]})
    folder.note_changes("A", {})  # no trial has run with the first
    folder.add({"task": "A", "agent": "zero", "trial": 0})
    folder.note_changes("A", {})
    with pytest.raises(UsageError, match="trials of A that were run otherwise: 'changes' was {} and is"):
        folder.note_changes("A", {"sim.dt": [1.0, 2.0]})


def test_contacts_without_room_of_an_evaluation_that_was_stopped_are_counted(
    tmp_path: Path, conditions: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped(env: Any, *rest: Any) -> None:
        env.unwrapped.sim.dropped_contacts[0] = 7
        raise KeyboardInterrupt

    monkeypatch.setattr("arcgym.evaluation.evaluate.run_trials", stopped)
    folder = ResultFolder(tmp_path / "out", {"agent": "zero", "suite": "paper"})
    cfg = load_trial_cfgs(
        "ARC-Rectum-Capsule", None, ("env.start=rest", "env.scene.camera.width=16", "env.sim.device=cpu")
    )
    trials = read_conditions(conditions).trials[:1]
    options = EvaluationOptions(("zero",), "paper", (), 1, 1, "cpu")
    with pytest.raises(KeyboardInterrupt):
        _run_batch("ARC-Rectum-Capsule", "zero", trials, lambda task, checkpoint: cfg, options, folder)
    assert folder.dropped("ARC-Rectum-Capsule") == 7
    assert cfg[0].curriculum is None  # trials are the same whatever was learnt before


def test_the_expert_withdraws_and_sees_mucosa(tmp_path: Path, tiny_colon_path: Path) -> None:
    """From 16 cm deep back to 5 cm at 10 mm/s: success after about 11 s, with most of that mucosa seen on the way."""
    path = tmp_path / "back_v1.csv"
    write_conditions(path, [Trial(0, str(tiny_colon_path), 7)], "One trial.")
    words = f"evaluate --agent expert --tasks ARC-Withdrawal-Capsule --device cpu --out {tmp_path / 'run'}"
    small = ["env.segment=transverse", "env.scene.camera.width=32", "env.scene.camera.height=32"]
    main([*words.split(), "--conditions", str(path), *small])
    (row,) = read_trial_rows(tmp_path / "run")
    assert row["end"] == "success" and row["progress"] == 1.0
    assert 8.0 < row["seconds"] < 20.0
    assert 0.4 < row["coverage"] <= 1.0 and row["polyps"] == 0.0


def test_trials_of_ones_own_are_no_suites(tmp_path: Path, conditions: Path) -> None:
    evaluate(tmp_path / "run", conditions)
    assert read_run(tmp_path / "run")["suite"] == "five_v1"


def test_variants_are_tasks_of_their_own(tmp_path: Path, conditions: Path) -> None:
    """A random agent does not look: its trials are the same with a blurred picture, and others with more friction."""
    words = ["--tasks", "ARC-Rectum-Capsule,ARC-Rectum-Capsule:blur_2,ARC-Rectum-Capsule:sticky_3"]
    rows = evaluate(tmp_path / "run", conditions, *words)
    by_task = {name: [row["reward"] for row in rows if row["task"].endswith(name)] for name in ("ule", "_2", "_3")}
    assert by_task["ule"] == by_task["_2"] and len(by_task["_3"]) == 5
    assert by_task["_3"] != by_task["ule"]
    friction = {(row["task"][18:], row["trial"]): row["friction"] for row in rows}
    assert len(set(friction.values())) == 10 and all(0.05 <= friction["", k] <= 0.15 for k in range(5))
    assert all(friction[":sticky_3", k] == pytest.approx(5.0 * friction["", k]) for k in range(5))
    assert all(0.7 <= row["wall_stiffness"] <= 1.4 and row["anchor_stiffness"] == 1.0 for row in rows)
    assert read_run(tmp_path / "run")["changes"]["ARC-Rectum-Capsule:sticky_3"]["robustness"] == ["none", "sticky_3"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ["--tasks", "ARC-Rectum-Capsule,ARC-Rectum-Capsule:blur_7"],
            "env.robustness is 'blur_7'. Did you mean 'blur_3'",
        ),
        (["env.scene.colon.material=in_stu"], "env.scene.colon.material is 'in_stu'. Did you mean 'in_situ'"),
    ],
)
def test_a_wrong_setting_is_refused_in_one_line_before_anything_runs(
    tmp_path: Path, conditions: Path, capsys, words: list[str], message: str
) -> None:
    with pytest.raises(SystemExit):
        evaluate(tmp_path / "run", conditions, *words)
    error = capsys.readouterr().err.strip()
    assert message in error and "\n" not in error and not (tmp_path / "run").exists()


def test_the_best_and_the_worst_trial_are_filmed_and_shown(tmp_path: Path, conditions: Path, capsys) -> None:
    """Five trials end by time: the best came farthest. Filmed in one world they come out as in five."""
    import pyarrow.parquet

    from arcgym.evaluation.page import write_page

    rows = evaluate(tmp_path / "run", conditions, "--videos")
    said = capsys.readouterr().out
    assert "came out otherwise" not in said and said.count("frames of trial ") >= 3
    ordered = sorted(rows, key=lambda row: row["progress"])
    films = {path.name for path in (tmp_path / "run" / "videos").iterdir()}
    names = {"worst": ordered[0], "median": ordered[2], "best": ordered[-1]}
    assert films == {f"ARC-Rectum-Capsule_{name}_trial_{row['trial']}.mp4" for name, row in names.items()}
    assert write_page(tmp_path / "run").read_text().count("<video controls src='data:video/mp4;base64,") == 3
    table = pyarrow.parquet.read_table(tmp_path / "run" / "trials.parquet")
    assert sorted(table["reward"].to_pylist()) == sorted(row["reward"] for row in rows)


def test_each_task_may_have_checkpoints_of_its_own(tmp_path: Path) -> None:
    from arcgym.evaluation.identity import run_record
    from arcgym.evaluation.options import EvaluationOptions
    from arcgym.evaluation.suites import read_suites
    from arcgym.evaluation.trials import read_conditions
    from arcgym.rl.checkpoint import write_checkpoint

    for task in ("ARC-Rectum-Magnetic", "ARC-Sigmoid-Magnetic"):
        (tmp_path / task).mkdir()
        for seed in (1, 2):
            write_checkpoint(tmp_path / task / f"{seed}.pt", {"infos": {"transitions": 10 * seed}, "of": task})
    options = EvaluationOptions((f"{tmp_path}/{{task}}/1.pt", f"{tmp_path}/{{task}}/2.pt"), "paper")
    assert options.agents_for("ARC-Sigmoid-Magnetic:dense")[1] == f"{tmp_path}/ARC-Sigmoid-Magnetic/2.pt"
    conditions = read_conditions(read_suites()["paper"].conditions_path)
    run = run_record(["ARC-Rectum-Magnetic", "ARC-Sigmoid-Magnetic"], conditions, options)
    assert len(set(run["checkpoint_sha256"])) == 4 and run["trained_on"] == [None] * 4
    assert run["training"] == [{"transitions": 10}, {"transitions": 20}] * 2
    with pytest.raises(UsageError, match="No checkpoint .*ARC-Splenic-Magnetic/1.pt, "):
        run_record(["ARC-Splenic-Magnetic"], conditions, options)
