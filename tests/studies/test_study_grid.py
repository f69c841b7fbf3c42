# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A study's file and the cells that it makes."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from arcgym.cli.study import SHIPPED
from arcgym.cli.task import agent_key
from arcgym.studies.checks import check_cells, check_names
from arcgym.studies.grid import hydra_value
from arcgym.studies.launch import all_cells
from arcgym.studies.study_cfg import StudyCfg, find_study, read_study
from arcgym.utils.errors import UsageError
from arcgym.utils.hydra import apply_overrides
from arcgym.utils.registry import load_cfg_from_registry

FOLDER = Path("/studies/one")
RECTUM, SIGMOID = "ARC-Rectum-Magnetic", "ARC-Sigmoid-Magnetic"


def study(**fields) -> StudyCfg:
    return StudyCfg(name="one", **{"task": RECTUM, **fields})


def test_the_grid_is_multiplied_out_and_its_last_name_varies_fastest():
    cells = all_cells(study(grid={"task": [RECTUM, SIGMOID], "algorithm": ["ppo", "sac"]}), FOLDER)
    assert [cell.name for cell in cells] == [
        "rectum-magnetic_ppo_seed1",
        "rectum-magnetic_sac_seed1",
        "sigmoid-magnetic_ppo_seed1",
        "sigmoid-magnetic_sac_seed1",
    ]


def test_segment_and_robot_make_a_task():
    grid = {"task": ["rectum", "sigmoid"], "robot": ["Capsule", "Magnetic"]}
    tasks = [cell.task for cell in all_cells(study(grid=grid), FOLDER)]
    assert tasks == ["ARC-Rectum-Capsule", RECTUM, "ARC-Sigmoid-Capsule", SIGMOID]


def test_the_grid_comes_on_top_of_the_algorithm_and_the_algorithm_on_top_of_the_task():
    """learning_rate: study 1, task 2, algorithm 3; gamma: study 0.9, grid 0.5; worlds: study 8, algorithm 4."""
    rate = "algorithm.learning_rate"
    cfg = study(
        num_envs=8,
        agent={rate: 1, "algorithm.gamma": 0.9},
        env={"lumen": "metric"},
        tasks={RECTUM: {"agent": {rate: 2}}},
        algorithms={"ppo": {"agent": {rate: 3}, "num_envs": 4}},
        grid={"agent.algorithm.gamma": [0.5]},
    )
    (cell,) = all_cells(cfg, FOLDER)
    assert cell.num_envs == 4
    assert cell.axes == {"agent.algorithm.gamma": 0.5}
    assert cell.name == "rectum-magnetic_ppo_seed1_gamma=0.5"
    assert list(cell.overrides) == [
        "env.lumen=metric",
        "agent.algorithm.learning_rate=3",
        "agent.algorithm.gamma=0.5",
    ]


def test_an_algorithm_has_settings_of_a_robot_on_top_of_its_own():
    """A capsule's velocity is 2, as the algorithm has it for capsules; a magnetic scope's is 1, as it has else."""
    algorithm = {"env": {"velocity": 1}, "num_envs": 4, "robots": {"Capsule": {"env": {"velocity": 2}, "num_envs": 8}}}
    grid = {"robot": ["Capsule", "Magnetic"]}
    cells = all_cells(study(task="rectum", algorithms={"ppo": algorithm}, grid=grid), FOLDER)
    assert [(cell.overrides, cell.num_envs) for cell in cells] == [(("env.velocity=2",), 8), (("env.velocity=1",), 4)]


def test_the_command_line_sweeps_too():
    cells = all_cells(study(grid={"seed": [1, 2]}), FOLDER, ["seed=5,6,7", "++agent.algorithm.gamma=0.9,0.99"])
    assert [(cell.seed, cell.axes["agent.algorithm.gamma"]) for cell in cells] == [
        (seed, gamma) for seed in (5, 6, 7) for gamma in (0.9, 0.99)
    ]


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("algorithm=[ppo,sac]", "algorithm is ['ppo', 'sac'], expected one value, or several as algorithm=ppo,sac"),
        ("minutes=soon", "minutes"),
        ("algoritm=ppo", "no field 'algoritm'. Did you mean"),
    ],
)
def test_mistakes_on_the_command_line_are_named(override, message):
    with pytest.raises(UsageError, match=re.escape(message)):
        all_cells(study(grid={"seed": [1]}), FOLDER, [override])


def test_an_unknown_agent_lists_the_known():
    with pytest.raises(UsageError, match="algorithm 'sax'. Did you mean 'sac'"):
        check_cells(all_cells(study(algorithm="sax"), FOLDER))


def test_more_minutes_on_the_command_line_are_for_the_same_cell():
    """5 minutes given stand over the algorithm's 3; the grid's worlds are a part of the name, the minutes are not."""
    cfg = study(minutes=1.0, algorithms={"ppo": {"minutes": 3.0}}, grid={"num_envs": [8]})
    (cell,) = all_cells(cfg, FOLDER, ["minutes=5"])
    assert cell.minutes == 5
    assert cell.name == "rectum-magnetic_ppo_seed1_num_envs=8"
    assert [one.minutes for one in all_cells(cfg, FOLDER, ["minutes=5,6"])] == [5, 6]


def test_a_cell_names_the_checkpoint_of_the_one_it_comes_after(tmp_path):
    cfg = study(
        grid={"algorithm": ["ppo_teacher", "distillation"]},
        algorithms={"distillation": {"after": "ppo_teacher", "agent": {"teacher_checkpoint": "{checkpoint}"}}},
    )
    teacher, pupil = all_cells(cfg, tmp_path)
    (teacher.folder / "run_1").mkdir(parents=True)
    (teacher.folder / "run_1" / "model_7.pt").touch()
    assert pupil.command("cpu")[-1] == f"agent.teacher_checkpoint='{teacher.folder}/run_1/model_7.pt'"
    with pytest.raises(UsageError, match="comes after 'rectum-magnetic_ppo_teacher_seed1'"):
        check_cells([pupil])


def test_a_resumed_cell_makes_the_iterations_that_are_left(tmp_path):
    """model_9 is of the tenth of 25 iterations: 15 are left."""
    (cell,) = all_cells(study(max_iterations=25), tmp_path)
    assert cell.command(None)[cell.command(None).index("--max_iterations") + 1] == "25"
    for run, model in (("run_1", 3), ("run_1", 9), ("run_2", 4)):
        (cell.folder / run).mkdir(parents=True, exist_ok=True)
        (cell.folder / run / f"model_{model}.pt").touch()
    (cell.folder / "run_2" / "model_4.pt").unlink()
    words = cell.command(None)
    assert words[words.index("--max_iterations") + 1] == "15"
    assert words[words.index("--checkpoint") + 1].endswith("run_1/model_9.pt")
    assert words[words.index("--log_dir") + 1].endswith("run_3")


def test_an_algorithm_may_be_another_one_with_values_given_whole():
    whole = "agent.algorithm.limits={tip_force: 0.2}"
    cfg = study(
        algorithm="gentle", algorithms={"gentle": {"like": "ppo_lagrangian", "overrides": [whole], "env": {"a": 1}}}
    )
    (cell,) = all_cells(cfg, FOLDER)
    words = cell.command(None)
    assert cell.name == "rectum-magnetic_gentle_seed1"
    assert words[words.index("--agent") + 1] == "ppo_lagrangian"
    assert cell.overrides == ("env.a=1", whole)


def test_the_limits_study_fits_its_task():
    """Limits and controls reach the configurations: 0.1, 0.3 and 1 s, a price of 1, and an early end after 0.3 s."""
    limits, prices, ends = [], [], []
    for cell in all_cells(read_study(find_study("limits", SHIPPED)), FOLDER):
        env_cfg = load_cfg_from_registry(cell.task, "env_cfg_entry_point")
        agent_cfg = load_cfg_from_registry(cell.task, agent_key(cell.like or cell.algorithm))
        apply_overrides({"env": env_cfg, "agent": agent_cfg}, cell.overrides)
        algorithm = agent_cfg.algorithm
        limits.append(getattr(algorithm, "limits", {}).get("tip_force"))
        prices.append(algorithm.multiplier.init if hasattr(algorithm, "multiplier") else None)
        ends.append(env_cfg.terminations.cost_limit and env_cfg.terminations.cost_limit.params["limit"])
    assert limits == [None, 0.1, 0.3, 1.0, 0.0, None, None]
    assert prices == [None, 0.001, 0.001, 0.001, 1.0, None, None]
    assert ends == [None, None, None, None, None, 0.3, None]


def test_the_limits_on_the_shaft_fit_their_task():
    """2, 5 and 8 s of a cost that the task has only in this study, and none."""
    limits, costs = [], []
    for cell in all_cells(read_study(find_study("limits_shaft", SHIPPED)), FOLDER):
        env_cfg = load_cfg_from_registry(cell.task, "env_cfg_entry_point")
        agent_cfg = load_cfg_from_registry(cell.task, agent_key(cell.like or cell.algorithm))
        assert env_cfg.costs.shaft_force is None
        apply_overrides({"env": env_cfg, "agent": agent_cfg}, cell.overrides)
        limits.append(getattr(agent_cfg.algorithm, "limits", {}).get("shaft_force"))
        costs.append(env_cfg.costs.shaft_force and env_cfg.costs.shaft_force.params)
    assert limits == [None, 2.0, 5.0, 8.0, 0.0]
    assert costs == [None, *[{"kind": "shaft_force", "limit": "unsafe"}] * 4]


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, "null"), (True, "true"), (0.05, "0.05"), ([1, "a b"], "[1,'a b']"), ("it's", r"'it\'s'"), ("ppo", "ppo")],
)
def test_values_are_written_in_the_grammar_of_hydra(value, text):
    from hydra.core.override_parser.overrides_parser import OverridesParser

    assert hydra_value(value) == text
    assert OverridesParser.create().parse_override(f"x={text}").value() == value


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("nme: x", "has the field 'nme'. Did you mean 'name'"),
        ("minutes: 0", "minutes is 0"),
        ("grid: {sed: [1]}", "varies 'sed'"),
        ("algorithms: {ppo: {robot: {}}}", "gives 'ppo' 'robot'. Did you mean 'robots'"),
        ("algorithms: {ppo: {robots: {Capsule: {evn: {}}}}}", "gives 'Capsule' 'evn'. Did you mean 'env'"),
        ("grid: {seed: []}", "gives 'seed' no values"),
        ("{grid: {seed: [1]}, skip: [{gamma: 1}]}", "names 'gamma', expected names of the grid"),
        ("algorithms: {sac: {worlds: 4}}", "gives 'sac' 'worlds'"),
        ("[1, 2]", "holds list"),
    ],
)
def test_mistakes_in_a_file_are_named(tmp_path, text, message):
    path = tmp_path / "one.yaml"
    path.write_text(text)
    with pytest.raises(UsageError, match=message.replace(".", r"\.")):
        read_study(path)


@pytest.mark.parametrize("path", sorted(SHIPPED.glob("*.yaml")), ids=lambda path: path.stem)
def test_shipped_studies_are_whole(path):
    cells = all_cells(read_study(find_study(path.stem, SHIPPED)), FOLDER)
    check_cells(cells)
    assert len(cells) > 1


@pytest.mark.parametrize("path", sorted(SHIPPED.glob("*.yaml")), ids=lambda path: path.stem)
def test_settings_of_shipped_studies_fit_their_tasks(path):
    """Of the first seed: each override names a field of the cell's task or agent."""
    cells = all_cells(read_study(find_study(path.stem, SHIPPED)), FOLDER)
    for cell in (cell for cell in cells if cell.seed == cells[0].seed):
        env_cfg = load_cfg_from_registry(cell.task, "env_cfg_entry_point")
        agent_cfg = load_cfg_from_registry(cell.task, agent_key(cell.like or cell.algorithm))
        apply_overrides({"env": env_cfg, "agent": agent_cfg}, cell.overrides)


def test_cells_that_are_skipped_are_not_there():
    """Of six, capsule with seed 2 goes, and SAC with both seeds of the magnetic scope."""
    grid = {"seed": [1, 2], "algorithm": ["ppo", "sac"], "robot": ["Capsule", "Magnetic"]}
    skip = [{"robot": "Capsule", "seed": [2, 3]}, {"algorithm": ["sac"], "robot": "Magnetic"}]
    assert [cell.name for cell in all_cells(study(task="rectum", grid=grid, skip=skip), FOLDER)] == [
        "rectum-capsule_ppo_seed1",
        "rectum-magnetic_ppo_seed1",
        "rectum-capsule_sac_seed1",
        "rectum-magnetic_ppo_seed2",
    ]


def test_the_papers_table_has_three_seeds_where_the_paper_has_them():
    """PPO with both rewards on four tasks: three seeds magnetic and in the pushed sigmoid, else one."""
    cells = all_cells(read_study(find_study("paper_table", SHIPPED)), FOLDER)
    ppo = [cell for cell in cells if cell.algorithm in ("ppo", "ppo_paper")]
    assert len(ppo) == 2 * 4 * (3 + 1 + 1) + 2
    by_name = {cell.name: cell for cell in cells}
    assert set(by_name["sigmoid-magnetic_a2c_paper_seed1"].overrides) == {
        "agent.max_transitions=221184",
        "env.reward=paper",
        "env.actions.tip.forward_velocity=0.04",
    }
    assert by_name["sigmoid-proximal_ppo_seed1"].overrides == ("agent.max_transitions=614400",)
    assert by_name["sigmoid-proximal_ppo_seed1"].num_envs == 1024


@pytest.mark.parametrize("path", ["agent.seed", "env.seed", "agent.max_minutes", "env.scene.num_envs"])
def test_what_a_cell_gives_as_a_flag_is_no_override(path: str) -> None:
    """The flag would stand: three cells of one seed would be named and tabled as three seeds."""
    with pytest.raises(UsageError, match=f"gives {path}=2 to 'rectum-magnetic_ppo_seed1.*', which takes it from '"):
        check_cells(all_cells(study(algorithm="ppo", grid={path: [2, 3]}), FOLDER))


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        (
            {"tasks": {"ARC-Rectum-Magentic": {"minutes": 6}}},
            "the task 'ARC-Rectum-Magentic'. Did you mean 'ARC-Rectum-Ma",
        ),
        ({"algorithms": {"ppo_lagrangain": {"minutes": 6}}}, "'ppo_lagrangain'. Did you mean 'ppo_lagrangian'"),
        (
            {"algorithms": {"ppo": {"robots": {"magnetic": {"env": {}}}}}},
            "the robot 'magnetic'. Did you mean 'Magnetic'",
        ),
    ],
)
def test_settings_of_what_is_not_registered_are_refused(fields: dict, message: str) -> None:
    with pytest.raises(UsageError, match=re.escape(message)):
        check_names(study(**fields))


def test_settings_of_the_shipped_studies_are_of_what_is_registered() -> None:
    for path in SHIPPED.glob("*.yaml"):
        check_names(read_study(path))
