# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""The registered navigation tasks: names, configurations, what a user may change."""

from __future__ import annotations

import json
import subprocess
import sys

import gymnasium
import pytest

from arcgym.cli.main import main
from arcgym.envs import mdp
from arcgym.rl.params import restore
from arcgym.utils.configclass import MISSING, configclass, to_dict, validate
from arcgym.utils.hydra import apply_overrides
from arcgym.utils.registry import cfg_keys, list_tasks, load_cfg_from_registry
from arcgym_tasks.navigation import register_navigation_task, register_robot
from arcgym_tasks.navigation.config.proximal import ProximalEnvCfg

TASKS = [
    f"ARC-{segment}-{robot}{variant}"
    for segment in ("Rectum", "Sigmoid", "Descending", "Splenic")
    for robot in ("Capsule", "Magnetic", "Proximal")
    for variant in ("", "-Play")
]


def test_plain_newton_needs_three_terms_switched_off() -> None:
    cfg = load_cfg_from_registry("ARC-Rectum-Capsule", "env_cfg_entry_point")
    cfg.sim.solver = "newton"
    with pytest.raises(ValueError, match="solver.*env.terminations.wall_penetrated=null env.events.stiffness=null"):
        validate(cfg)
    cfg.terminations.wall_penetrated = cfg.events.stiffness = cfg.events.friction = None
    validate(cfg)


def test_going_back_needs_a_tether_that_is_to_come_on() -> None:
    tethered = load_cfg_from_registry("ARC-LeftColon-Magnetic", "env_cfg_entry_point")
    tethered.actions.tip.back_off_velocity = 0.045
    validate(tethered, "env")
    tethered.actions = {"tip": tethered.actions.tip, "gas": None}  # as a task of one's own may have them
    validate(tethered, "env")
    for task, term, reason in (
        ("ARC-LeftColon-Capsule", "capsule", "capsule.usda has no tether whose length it could read"),
        ("ARC-Withdrawal-Magnetic", "tip", "on its way out no scope comes on"),
    ):
        cfg = load_cfg_from_registry(task, "env_cfg_entry_point")
        getattr(cfg.actions, term).back_off_velocity = 0.03
        name = f"env.actions.{term}.back_off_velocity is 0.03 m/s, but {reason}"
        with pytest.raises(ValueError, match=f"^{name}: set it to 0, or take a task such as ARC-LeftColon-Magnetic.$"):
            validate(cfg, "env")


def test_all_tasks_are_registered() -> None:
    assert set(TASKS) <= set(list_tasks())


def test_listing_imports_neither_torch_nor_newton() -> None:
    code = "import sys, arcgym_tasks; print([m for m in ('torch', 'newton', 'warp') if m in sys.modules])"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert result.stdout.strip() == "[]"


@pytest.mark.parametrize("task", TASKS)
def test_environment_config_is_complete(task: str) -> None:
    cfg = load_cfg_from_registry(task, "env_cfg_entry_point")
    validate(cfg)
    _, segment, robot = task.removesuffix("-Play").split("-")
    assert cfg.segment == segment.lower()
    assert robot.lower() in cfg.scene.endoscope.usd_path


@pytest.mark.parametrize("task", TASKS)
def test_agent_config_builds(task: str) -> None:
    cfg = load_cfg_from_registry(task, "rsl_rl_cfg_entry_point")
    _, segment, robot = task.removesuffix("-Play").split("-")
    assert cfg.experiment_name == f"arc_{segment.lower()}_{robot.lower()}"
    assert cfg.to_dict()["algorithm"]["gamma"] == 0.97


@pytest.mark.parametrize(
    ("segment", "steps"), [("Rectum", 100), ("Sigmoid", 450), ("Descending", 160), ("Splenic", 270)]
)
def test_horizon_is_counted_in_control_steps_of_a_tenth_second(segment: str, steps: int) -> None:
    cfg = load_cfg_from_registry(f"ARC-{segment}-Magnetic", "env_cfg_entry_point")
    step = cfg.decimation * cfg.sim.dt
    assert step == pytest.approx(0.1)
    assert round(cfg.max_episode_length_s / step) == steps


def test_a_withdrawal_rewards_what_is_seen_and_starts_at_a_segment() -> None:
    cfg = load_cfg_from_registry("ARC-Withdrawal-Proximal", "env_cfg_entry_point")
    validate(cfg)
    assert (cfg.segment, cfg.direction, cfg.max_episode_length_s) == ("cecum", "withdrawal", 480.0)
    assert cfg.rewards.coverage.func is mdp.coverage_gain and cfg.terminations.stuck is None
    assert load_cfg_from_registry("ARC-Cecum-Proximal", "env_cfg_entry_point").terminations.stuck is not None
    cfg.start = "rest"
    with pytest.raises(ValueError, match=r"start is 'rest', at the anus: .* env.start=segment"):
        validate(cfg)


def test_another_segment_brings_its_time_limit() -> None:
    cfg = load_cfg_from_registry("ARC-Rectum-Proximal", "env_cfg_entry_point")
    apply_overrides({"env": cfg}, ["env.segment=splenic"])
    assert cfg.max_episode_length_s == 27.0
    apply_overrides({"env": cfg}, ["env.episode_length_s=5"])
    assert cfg.max_episode_length_s == 5.0


def test_an_episode_from_rest_has_time_for_the_whole_way() -> None:
    cfg = load_cfg_from_registry("ARC-Descending-Proximal", "env_cfg_entry_point")
    apply_overrides({"env": cfg}, ["env.start=rest"])
    validate(cfg)
    assert cfg.max_episode_length_s == 10.0 + 45.0 + 16.0


def test_a_segment_without_a_time_limit_needs_one() -> None:
    cfg = ProximalEnvCfg(segment="transverse")
    with pytest.raises(ValueError, match="'transverse' has no time limit.*env.episode_length_s.*splenic"):
        validate(cfg)
    cfg.episode_length_s = 20.0
    validate(cfg)


def test_one_call_registers_a_robot_of_ones_own() -> None:
    @configclass
    class SlowEnvCfg(ProximalEnvCfg):
        decimation: int = 96

    tasks = register_robot("Slow", SlowEnvCfg, segments=("sigmoid", "transverse"))
    try:
        assert (
            tasks[:2] == ["ARC-Sigmoid-Slow", "ARC-Sigmoid-Slow-Play"]
            and "ARC-LeftColon-Slow" in tasks
            and len(tasks) == 10
        )
        cfg = load_cfg_from_registry("ARC-Sigmoid-Slow-Play", "env_cfg_entry_point")
        assert (cfg.segment, cfg.decimation, cfg.scene.num_envs) == ("sigmoid", 96, 4)
        agent = load_cfg_from_registry("ARC-Sigmoid-Slow", "rsl_rl_cfg_entry_point")
        assert agent.experiment_name == "arc_sigmoid_slow"
    finally:
        for task in tasks:
            gymnasium.registry.pop(task)


def test_a_task_of_ones_own_has_every_agent_each_with_a_folder() -> None:
    tasks = register_navigation_task(
        "My-Task", "arcgym_tasks.navigation.config.capsule:CapsuleEnvCfg", segment="rectum"
    )
    try:
        assert tasks == ["My-Task", "My-Task-Play"] and cfg_keys("My-Task") == cfg_keys("ARC-Rectum-Capsule")
        cfg = load_cfg_from_registry("My-Task-Play", "env_cfg_entry_point")
        assert (cfg.segment, cfg.scene.num_envs) == ("rectum", 4)
        agents = [load_cfg_from_registry("My-Task", f"rsl_rl_{key}cfg_entry_point") for key in ("", "sac_")]
        assert [agent.experiment_name for agent in agents] == ["my_task", "my_task_sac"]
    finally:
        for task in tasks:
            gymnasium.registry.pop(task)


def test_the_list_of_configurations_cuts_no_name(capsys) -> None:
    assert main(["list", "Rectum-Capsule", "--cfgs"]) == 0
    assert "arcgym_tasks.navigation.agents.rsl_rl_cfg:NavigationPPORunnerCfg(" in capsys.readouterr().out


def test_registering_a_module_that_is_not_there_costs_nothing_until_it_is_used() -> None:
    tasks = register_robot("Ghost", "nowhere.ghost:GhostEnvCfg", segments=("rectum",))
    try:
        assert "ARC-Rectum-Ghost" in list_tasks()
        with pytest.raises(ValueError, match="nowhere"):
            load_cfg_from_registry("ARC-Rectum-Ghost", "env_cfg_entry_point")
    finally:
        for task in tasks:
            gymnasium.registry.pop(task)


def test_an_entry_point_shows_class_and_fields() -> None:
    entry = gymnasium.spec("ARC-Sigmoid-Capsule-Play").kwargs["env_cfg_entry_point"]
    assert str(entry) == "arcgym_tasks.navigation.config.capsule:CapsuleEnvCfg(segment='sigmoid').play()"


def test_play_has_few_worlds_and_no_randomization() -> None:
    train = load_cfg_from_registry("ARC-Sigmoid-Magnetic", "env_cfg_entry_point")
    play = load_cfg_from_registry("ARC-Sigmoid-Magnetic-Play", "env_cfg_entry_point")
    assert play.scene.num_envs < train.scene.num_envs
    assert play.events.light is None and play.events.reset is not None
    assert train.events.light is not None


def test_policy_sees_images_only() -> None:
    cfg = load_cfg_from_registry("ARC-Splenic-Proximal", "env_cfg_entry_point")
    terms = {name: term for name, term in vars(cfg.observations.policy).items() if hasattr(term, "func")}
    assert list(terms) == ["rgb"] and terms["rgb"].history_length == 5


def test_a_user_can_subclass_and_switch_terms_off() -> None:
    @configclass
    class MyEnvCfg(ProximalEnvCfg):
        def __post_init__(self) -> None:
            super().__post_init__()
            self.rewards.progress = None
            self.lumen = "metric"

    cfg = MyEnvCfg(segment="splenic")
    validate(cfg)
    assert cfg.rewards.progress is None and cfg.rewards.lumen is not None
    assert ProximalEnvCfg().rewards.progress is not None


def test_own_reward_constants_are_accepted() -> None:
    cfg = ProximalEnvCfg(segment="splenic")
    cfg.lumen = mdp.LumenCfg(mix=0.5)
    validate(cfg)


def test_unknown_names_are_refused() -> None:
    cfg = ProximalEnvCfg(segment="splenic")
    cfg.segment = "spleen"
    with pytest.raises(ValueError, match="'spleen'.*rectum.*splenic"):
        validate(cfg)
    cfg = ProximalEnvCfg(segment="splenic")
    cfg.lumen = "papper"
    with pytest.raises(ValueError, match="papper.*metric.*paper"):
        validate(cfg)


@pytest.mark.parametrize(
    ("way", "segment", "seconds"), [("LeftColon", "splenic", 10 + 45 + 16 + 27), ("Cecum", "cecum", 240)]
)
@pytest.mark.parametrize("robot", ["Capsule", "Magnetic", "Proximal"])
def test_journeys_begin_at_rest_in_the_anus(way: str, segment: str, seconds: float, robot: str) -> None:
    cfg = load_cfg_from_registry(f"ARC-{way}-{robot}", "env_cfg_entry_point")
    validate(cfg)
    assert (cfg.segment, cfg.start, cfg.max_episode_length_s) == (segment, "rest", seconds)


@pytest.mark.parametrize(("robot", "length"), [("Capsule", None), ("Magnetic", 2.2), ("Proximal", 2.2)])
@pytest.mark.parametrize("variant", ["", "-Play"])
def test_the_way_to_the_cecum_has_a_longer_scope(robot: str, length: float | None, variant: str) -> None:
    """Only there: a withdrawal starts from states of the shipped scope."""
    cfg = load_cfg_from_registry(f"ARC-Cecum-{robot}{variant}", "env_cfg_entry_point")
    assert cfg.scene.endoscope.length == cfg.scope_length == length
    for way in ("LeftColon", "Withdrawal"):
        other = load_cfg_from_registry(f"ARC-{way}-{robot}{variant}", "env_cfg_entry_point")
        assert other.scene.endoscope.length is None
    if length:
        apply_overrides({"env": cfg}, ["env.scene.endoscope.length=1.9"])
        assert cfg.scene.endoscope.length == 1.9
        apply_overrides({"env": cfg}, ["env.scene.endoscope.length=null"])
        validate(cfg)
        assert cfg.scene.endoscope.length is None


@pytest.mark.parametrize(
    ("way", "seconds"), [("Sigmoid", 6.0), ("LeftColon", 20.0), ("Cecum", 20.0), ("Withdrawal", None)]
)
def test_a_journey_has_longer_until_it_counts_as_stuck(way: str, seconds: float | None) -> None:
    cfg = load_cfg_from_registry(f"ARC-{way}-Magnetic", "env_cfg_entry_point")
    assert cfg.stuck_after_s == seconds
    cfg.terminations.stuck = None
    cfg.stuck_after_s = 20.0
    assert cfg.stuck_after_s is None


def test_a_scope_that_comes_in_one_length_keeps_it() -> None:
    """A stage of one's own, and a configuration whose scope comes later."""
    cfg = ProximalEnvCfg(segment="cecum")
    cfg.scene.endoscope.usd_path = "short.usda"
    cfg.scope_length = 2.2
    assert cfg.scope_length is None
    cfg.scene.endoscope = MISSING
    cfg.scope_length = 2.2


def test_the_papers_reward_is_the_view_of_the_lumen_alone() -> None:
    cfg = load_cfg_from_registry("ARC-Sigmoid-Magnetic", "env_cfg_entry_point")
    apply_overrides({"env": cfg}, ["env.reward=paper"])
    validate(cfg)
    cfg.resolve()
    assert [name for name, term in vars(cfg.rewards).items() if term is not None] == ["lumen"]


def test_an_unknown_reward_is_refused() -> None:
    cfg = load_cfg_from_registry("ARC-Sigmoid-Magnetic", "env_cfg_entry_point")
    cfg.reward = "papers"
    with pytest.raises(TypeError, match="reward.*'shaped', 'paper'"):
        validate(cfg)


def test_groups_of_observations_are_added_where_they_are_asked_for() -> None:
    cfg = load_cfg_from_registry("ARC-Sigmoid-Magnetic", "env_cfg_entry_point")
    apply_overrides({"env": cfg}, ["env.extra_observations=[force,shape]"])
    cfg.resolve()
    there = {name for name, group in vars(cfg.observations).items() if group is not None}
    assert there == {"policy", "critic", "force", "shape"}
    apply_overrides({"env": cfg}, ["env.extra_observations=[smell]"])
    with pytest.raises(ValueError, match="extra_observations.*'smell'.*force, insertion, pressure, shape"):
        validate(cfg)


def test_a_task_with_every_option_is_restored_from_what_was_written_of_it() -> None:
    """A run's params and a recording's settings hold the task as it was resolved, added groups and terms included."""
    options = ["extra_observations=[force,shape,insertion,pressure]", "gas=commanded", "clinical=[all]", "reward=s_c"]
    cfg = load_cfg_from_registry("ARC-Sigmoid-Magnetic", "env_cfg_entry_point")
    apply_overrides({"env": cfg}, [f"env.{option}" for option in options])
    cfg.resolve()
    written = json.loads(json.dumps(to_dict(cfg)))
    again = load_cfg_from_registry("ARC-Sigmoid-Magnetic", "env_cfg_entry_point")
    restore(again, written, "env")
    again.resolve()
    assert to_dict(again) == to_dict(cfg)
    assert again.observations.pressure.lumen.func is mdp.lumen_pressure


@pytest.mark.parametrize("part", ["s_c", "s_1", "s_2", "s_o"])
def test_a_part_of_the_papers_reward_may_stand_alone(part: str) -> None:
    cfg = load_cfg_from_registry("ARC-Sigmoid-Magnetic", "env_cfg_entry_point")
    apply_overrides({"env": cfg}, [f"env.reward={part}"])
    validate(cfg)
    cfg.resolve()
    terms = {name: term for name, term in vars(cfg.rewards).items() if term is not None}
    assert list(terms) == ["lumen"] and terms["lumen"].params == {"part": part}


def test_a_step_forward_earns_more_than_the_best_view_and_waiting_ends_in_failure():
    """At 40 mm/s a step of 0.1 s earns 300 x 0.004 x 0.1 = 0.12; the lumen reward is at most 1 and earns 0.1."""
    cfg = load_cfg_from_registry("ARC-Sigmoid-Magnetic", "env_cfg_entry_point")
    step = cfg.decimation * cfg.sim.dt
    best_view = cfg.rewards.lumen.weight * (mdp.PAPER.weight_centering + mdp.PAPER.weight_visibility) * step
    assert cfg.rewards.progress.weight * 0.04 * step * step > best_view
    assert not cfg.terminations.stuck.time_out


def test_events_begin_with_the_patient() -> None:
    """What follows belongs to the world's patient, and evaluations of several patients put theirs there."""
    cfg = load_cfg_from_registry("ARC-LeftColon-Magnetic", "env_cfg_entry_point")
    assert next(iter(vars(cfg.events))) == "patient"


def test_a_segment_that_is_misspelt_is_refused_when_it_is_registered() -> None:
    with pytest.raises(ValueError, match="names the segment 'rectm'. Did you mean 'rectum'"):
        register_robot("Nowhere", "my_package:Cfg", segments=("rectm",), journeys={})
