# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Checking of result folders: what is refused, and what is the agent's to choose."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from paper_results import RUN, TASKS, changed, result
from result_folders import write_result_folder

from arcgym.cli.main import main
from arcgym.evaluation.agent_fields import AGENT_LIMITS, AGENTS_OWN
from arcgym.evaluation.check import problems
from arcgym.evaluation.result_folder import ResultFolder
from arcgym.evaluation.suites import read_suites
from arcgym.evaluation.trials import read_conditions


def test_one_checkpoint_a_task_is_one_training_seed(tmp_path: Path) -> None:
    """Four tasks with a policy each are four checkpoints, and one seed of each task."""
    conditions = read_conditions(read_suites()["paper"].conditions_path)
    own = dict(zip(TASKS, "abcd", strict=True))
    run = {**RUN, "checkpoint": list(own.values()), "checkpoint_sha256": ["1", "2", "3", "4"]}
    folder = ResultFolder(tmp_path / "all", run)
    for task in TASKS:
        for trial in conditions.trials:
            row = {"task": task, "agent": own[task], **vars(trial), "success": 1, "end": "success"}
            folder.add({**row, "reward": 1.0, "seconds": 2.0, "progress": 1.0})
    text = "has 1 checkpoint(s), expected 3 training seeds: paper_v1 has groups"
    assert problems(folder.path) == [f"{task} {text}" for task in sorted(TASKS)]


@pytest.mark.parametrize(
    ("trained_on", "why"),
    [
        ("population:20000", "population:20000, kept unseen"),
        ("population:020000*0.9", "population:20000, kept unseen"),
        (
            "/home/me/.cache/arcgym/population/generator_4_160x14/patient_20000/colon.usda",
            "population:20000, kept unseen",
        ),
        (
            ["colon_1/colon.usda", "unknown: /far/start.pt"],
            "does not say on which patients the policy was trained: unknown",
        ),
        (None, "does not say on which patients the policy was trained: None"),
        ("population:train", None),
    ],
)
def test_patients_of_the_training_are_known_and_none_of_the_test(
    tmp_path: Path, trained_on: Any, why: str | None
) -> None:
    found = problems(result(tmp_path / "a", run={**RUN, "trained_on": [trained_on]}))
    assert (found == []) if why is None else (len(found) == 1 and why in found[0])


def test_a_number_may_be_written_as_a_power_of_ten(tmp_path: Path) -> None:
    for value in ("0.01", "1e-2", "1.0e-2"):
        run = {**RUN, "overrides": [f"env.actions.tip.linear_scale={value}"]}
        assert problems(result(tmp_path / value, run=run)) == []


def test_settings_of_an_effect_that_the_suite_switches_on_are_the_suites(tmp_path: Path) -> None:
    """``env.clinical=[all]`` switches sheets on: how long they are changes the task, which it does not without."""
    for suite, refused in (("population_clinical", True), ("population", False)):
        task = read_suites()[suite].tasks("Magnetic")[0]
        changes = {task: {"scene.colon.mesentery.fullness": [1.0, 2.0]}}
        found = problems(ResultFolder(tmp_path / suite, {**RUN, "suite": suite, "changes": changes}).path)
        assert any("mesentery.fullness = 2.0" in line for line in found) == refused


def test_a_progress_that_is_no_number_is_told(tmp_path: Path) -> None:
    found = problems(result(tmp_path / "a", progress="x", max_tip_force="y"))
    assert [line.partition(" has ")[2] for line in found] == [
        "progress = x, expected a number",
        "max_tip_force = y, expected a number",
    ]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"seed": 5}, "another patient, seed or group"),
        ({"task": "ARC-Rectum-Magnetic:easy"}, "ARC-Rectum-Magnetic:easy is no task of the suite"),
        ({"end": "time_out"}, "says success 1 and end 'time_out'"),
        ({"progress": 0.5}, "succeeded with a progress of 0.5"),
        ({"trial": 1}, "is there twice"),
        ({"centered_rate": 1.5}, "has centered_rate = 1.5, expected 0 to 1"),
        ({"p95_tip_force": -0.2}, "has p95_tip_force = -0.2, expected no negative number"),
        ({"mean_tip_force": 3.0, "max_tip_force": 2.0}, "has mean_tip_force = 3.0, above the largest, 2.0"),
        ({"max_tip_force": 2.0, "peak_tip_force": 1.5}, "has max_tip_force = 2.0, above the peak, 1.5"),
        ({"p95_tip_force": float("nan")}, "has p95_tip_force = nan, expected a finite number"),
    ],
)
def test_a_wrong_submission_is_refused_with_the_reason(tmp_path: Path, capsys, changes: dict, message: str) -> None:
    path = result(tmp_path / "mine", **changes)
    assert main(["results", "check", str(path)]) == 1
    assert message in capsys.readouterr().out


def test_the_least_progress_at_the_cecum_fits_the_patients() -> None:
    """Half of the cecum's length before the end; all that are known come to 0.975 or more."""
    from arcgym.anatomy.generator.population import draw_spec
    from arcgym.anatomy.generator.splits import read_splits

    for seed in read_splits().seeds["test"]:
        lengths = {name: segment.length for name, segment in draw_spec(seed).segments.items()}
        assert 1.0 - 0.5 * lengths["cecum"] / sum(lengths.values()) > 0.975


@pytest.mark.parametrize(("progress", "refused"), [(0.975, False), (0.96, True)])
def test_the_cecum_is_reached_before_the_way_ends(tmp_path: Path, progress: float, refused: bool) -> None:
    """Its middle lies 3 cm before the end of a colon that is at least 1.1 m long."""
    suite = read_suites()["cecum"]
    conditions = read_conditions(suite.conditions_path)
    folder = ResultFolder(tmp_path / "a", {**RUN, "suite": "cecum", "conditions_sha256": conditions.sha256})
    row = {"task": suite.tasks("Magnetic")[0], "agent": "a", **vars(conditions.trials[0]), "success": 1}
    folder.add({**row, "end": "success", "reward": 1.0, "seconds": 60.0, "progress": progress})
    found = [line for line in problems(folder.path) if "succeeded with a progress" in line]
    assert bool(found) == refused


@pytest.mark.parametrize(
    ("run", "message"),
    [
        ({**RUN, "overrides": ["env.start=rest"]}, "change the task"),
        ({**RUN, "checkpoint_sha256": []}, "cannot be identified"),
        ({**RUN, "checkpoint_sha256": ["abc", "abc"]}, "has 1 checkpoint(s), expected 3 training seeds"),
        ({**RUN, "changes": {"ARC-Rectum-Magnetic": {"clinical": [[], ["all"]]}}}, "run with clinical = ['all']"),
        ({**RUN, "changes": {"ARC-Rectum-Magnetic": {"gas": ["none", "present"]}}}, "run with gas = present"),
        ({**RUN, "changes": {"ARC-Rectum-Magnetic": {"scene.camera.far": [0.6, 0.3]}}}, "with scene.camera.far = 0.3"),
        ({**RUN, "changes": {"ARC-Rectum-Magnetic": {"actions.tip.linear_scale": [0.045, 0.1]}}}, "linear_scale = 0.1"),
        ({**RUN, "changes": {"ARC-Rectum-Magnetic": {"actions.tip.forward_velocity": [None, 0.1]}}}, "velocity = 0.1"),
        ({**RUN, "inputs": {"ARC-Rectum-Magnetic": {"sees": [], "simulator_depth": True}}}, "simulator's depth"),
        ({**RUN, "changes": {"ARC-Rectum-Magnetic": {"start": ["segment", "rest"]}}}, "run with start = rest"),
        ({**RUN, "suite": "mine"}, "expected one of paper"),
        ({**RUN, "versions": {"arcgym commit": "abc with changes"}}, "code that is not that of its commit: abc with"),
        ({**RUN, "changes": {}}, "ARC-Rectum-Magnetic: run.json does not say with what settings it was run"),
        ({**RUN, "inputs": {}}, "ARC-Rectum-Magnetic: run.json does not say what its policy sees"),
        ({**RUN, "conditions_sha256": "x"}, "hash of the condition file differs"),
    ],
)
def test_a_run_that_is_not_the_suites_is_refused(tmp_path: Path, capsys, run: dict, message: str) -> None:
    assert main(["results", "check", str(result(tmp_path / "mine", run=run))]) == 1
    assert message in capsys.readouterr().out


def test_what_is_the_agents_own_is_no_reason_to_refuse(tmp_path: Path) -> None:
    """Its reward, what it sees, a velocity that it could command itself, and settings of the agent."""
    own = {
        "reward": ["shaped", "paper"],
        "rewards.progress.weight": [300.0, 100.0],
        "actions.tip.forward_velocity": [None, 0.04],
        "observations.policy.image.params.size": [84, 64],
    }
    run = {
        **RUN,
        "changes": RUN["changes"] | {TASKS[0]: own},
        "overrides": ["agent.action_constraint.in_evaluation=false"],
    }
    assert problems(result(tmp_path / "mine", run=run)) == []


@pytest.mark.parametrize(
    ("field", "value", "fits"),
    [
        ("actions.tip.roll_amplitude", 9.0, True),
        ("actions.tip.roll_amplitude", 18.5, False),
        ("actions.tip.roll_period", 3.0, True),
        ("actions.base.roll_amplitude", 9.0, True),
        ("actions.base.roll_amplitude", 9.5, False),
        ("actions.tip.back_off_velocity", 0.045, True),
        ("actions.tip.back_off_velocity", 0.05, False),
        ("actions.tip.back_off_after", 8.0, True),
        ("actions.tip.back_off_time", 3.0, True),
        ("actions.capsule.back_off_velocity", 0.01, False),
        ("actions.tip.forward_velocity", 0.04, True),
        ("actions.tip.forward_velocity", 0.05, False),
        ("actions.capsule.forward_velocity", 0.05, True),
        ("actions.base.insertion_velocity", 0.04, True),
        ("actions.base.insertion_velocity", 0.06, False),
        ("actions.tip.roll_scale", 18.0, False),
        ("actions.tip.linear_scale", 0.01, True),
        ("actions.capsule.linear_scale", 0.06, False),
        ("actions.base.insertion_scale", 0.06, False),
        ("reward", "paper", True),
    ],
)
def test_what_is_the_agents_own_may_be_an_override(tmp_path: Path, field: str, value: Any, fits: bool) -> None:
    """Brought by the policy's parameters, or given to the evaluation as well; up to what experts or actions take."""
    run = changed(TASKS[0], **{field: [None, value]})
    given = run | {"overrides": [f"env.{field}={value}"]}
    for name, of in (("brought", run), ("given", given)):
        found = problems(result(tmp_path / name, run=of))
        assert bool(found) != fits and all("change" in line for line in found)


def test_a_setting_that_a_policy_brings_along_may_be_put_back(tmp_path: Path) -> None:
    """The reach of the contact search was 3 when it was trained, and the task's is 12."""
    back, brought = "env.sim.contact.search_reach=12", changed(TASKS[0], **{"sim.contact.search_reach": [12, 3]})
    assert problems(result(tmp_path / "back", run={**RUN, "overrides": [back]})) == []
    (found,) = problems(result(tmp_path / "brought", run=brought))
    assert found == f"{TASKS[0]} was run with sim.contact.search_reach = 3, which changes the task (12)"
    (found,) = problems(result(tmp_path / "other", run={**RUN, "overrides": ["env.sim.contact.search_reach=3"]}))
    assert "change the task" in found


def test_clinical_tissue_is_a_suites_own(tmp_path: Path) -> None:
    """A run's list of one name is the suite's ``env.clinical=[all]``, and no other list is."""
    for effects, fits in ((["all"], True), (["gas"], False)):
        changes = {"ARC-LeftColon-Magnetic": {"clinical": [[], effects]}}
        run = {**RUN, "suite": "population_clinical", "changes": changes}
        found = problems(ResultFolder(tmp_path / effects[0], run).path)
        assert any("clinical" in line for line in found) != fits


def test_a_setting_of_the_suite_may_not_be_put_back(tmp_path: Path) -> None:
    suite = read_suites()["left_colon_in_situ"]
    run = {**RUN, "suite": "left_colon_in_situ", "changes": {suite.tasks("Magnetic")[0]: {}}}
    for override, refused in ("env.scene.colon.material=paper", True), ("env.sim.contact.search_reach=12", False):
        folder = ResultFolder(tmp_path / override.rpartition(".")[2], {**run, "overrides": [override]})
        assert any("change the task" in line for line in problems(folder.path)) == refused


def test_every_field_of_a_task_but_the_agents_is_guarded() -> None:
    """A new effect of the environment is part of the task until it is said to be the agent's."""
    from arcgym.experts import PullExpert, PushExpert
    from arcgym.utils.coerce import to_plain
    from arcgym.utils.registry import load_cfg_from_registry

    fields = to_plain(load_cfg_from_registry("ARC-Sigmoid-Magnetic", "env_cfg_entry_point"))
    assert {name.partition(".")[0] for name in AGENTS_OWN} - {"actions"} <= set(fields)
    assert fields["actions"]["tip"]["linear_scale"] == AGENT_LIMITS["actions.tip.forward_velocity"]
    assert fields["actions"]["tip"]["linear_scale"] == AGENT_LIMITS["actions.tip.back_off_velocity"]
    most = PullExpert.VARIED["roll"][1], PushExpert.VARIED["twist"][1]
    assert most == (AGENT_LIMITS["actions.tip.roll_amplitude"], AGENT_LIMITS["actions.base.roll_amplitude"])
    for robot, action in (
        ("Magnetic", "tip.linear_scale"),
        ("Capsule", "capsule.linear_scale"),
        ("Proximal", "base.insertion_scale"),
    ):
        actions = to_plain(load_cfg_from_registry(f"ARC-Sigmoid-{robot}", "env_cfg_entry_point"))["actions"]
        term, scale = action.split(".")
        assert actions[term][scale] == AGENT_LIMITS[f"actions.{action}"]
    assert {"gas", "clinical", "sim", "scene", "events", "terminations", "metrics"} <= set(fields) - set(AGENTS_OWN)


def test_missing_trials_are_counted(tmp_path: Path, capsys) -> None:
    assert main(["results", "check", str(result(tmp_path / "mine", trials=slice(0, 28)))]) == 1
    assert "lacks 2 of 30 trials, first 28" in capsys.readouterr().out


def test_what_the_suite_itself_changes_is_no_reason_to_refuse(tmp_path: Path) -> None:
    """A variant sets env.robustness, a suite in soft tissue the material, and nothing else passes for them."""
    suite = read_suites()["robustness"]
    task = suite.tasks("Magnetic")[1]
    changes = {task: {"robustness": ["none", task.partition(":")[2]]}}
    run = {**RUN, "suite": "robustness", "conditions_sha256": read_conditions(suite.conditions_path).sha256}
    folder = ResultFolder(tmp_path / "a", {**run, "changes": changes})
    assert not [line for line in problems(folder.path) if "changes the task" in line]
    rigid = read_suites()["rigid"]
    run_rigid = {**RUN, "suite": "rigid", "conditions_sha256": read_conditions(rigid.conditions_path).sha256}
    of_rigid = {"ARC-Sigmoid-Magnetic:rigid": {"scene.colon.rigid": [False, True]}}
    folder = ResultFolder(tmp_path / "c", {**run_rigid, "changes": of_rigid})
    assert not [line for line in problems(folder.path) if "changes the task" in line]
    changes[task]["robustness"][1] = "none"
    other = ResultFolder(tmp_path / "b", {**run, "changes": changes})
    assert [line for line in problems(other.path) if "run with robustness = none, which changes the task" in line]


def test_trials_of_an_earlier_version_cannot_be_handed_in(tmp_path: Path) -> None:
    of: dict[str, Any] = {"task": "ARC-LeftColon-Magnetic", "suite": "population"}
    of |= {"checkpoint": ["a", "b", "c"], "checkpoint_sha256": ["1", "2", "3"], "agents": ["a", "b", "c"]}
    of |= {"changes": {of["task"]: {}}}
    of |= {"inputs": {of["task"]: {"sees": ["policy"], "simulator_depth": False}}}
    old = write_result_folder(tmp_path / "old", 3, **of, conditions_name="population_v2")
    message = "trials are of population_v2, an earlier version of population_v4: evaluate again"
    assert problems(old) == [message] and problems(old, whole=False) == []
    new = write_result_folder(tmp_path / "new", 3, **of)
    assert problems(new) == []


@pytest.mark.parametrize(
    ("suite", "trained", "refused"),
    [
        ("population", "population:train", False),
        ("population", ["colon_1/colon.usda", "population:20003"], True),
        ("paper", "population:19999,20003*0.8", True),
        ("paper", "population:test", True),
        ("paper", None, False),
        ("paper", "/data/assets/usd/ct_2/colon.usda", True),
        ("paper", "colon_3/colon.usda", False),
        ("cross_colon", "colon_3/colon.usda", True),
        ("cross_colon", ["colon_1/colon.usda", "colon_2/colon.usda"], False),
    ],
)
def test_training_on_unseen_patients_is_refused(tmp_path: Path, suite: str, trained, refused: bool) -> None:
    conditions = read_conditions(read_suites()[suite].conditions_path)
    run = {**RUN, "suite": suite, "conditions_sha256": conditions.sha256, "trained_on": [trained]}
    found = problems(ResultFolder(tmp_path / "run", run).path)
    assert any("kept unseen for tests" in line for line in found) == refused
