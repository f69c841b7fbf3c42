# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A checkpoint's path is enough: the agent is the one that its run was trained with."""

from __future__ import annotations

from pathlib import Path

import pytest

from arcgym.cli.arguments import RunArguments
from arcgym.cli.evaluate import load_trial_cfgs
from arcgym.cli.main import main
from arcgym.cli.task import load_run_cfgs
from arcgym.envs.mdp import rgb
from arcgym.managers import ObservationTermCfg
from arcgym.rl.run_folder import write_params
from arcgym.utils.errors import UsageError
from arcgym.utils.registry import load_cfg_from_registry

TASK = "ARC-Rectum-Capsule"


@pytest.mark.parametrize("agent", ["ppo_recurrent", "ppo_masked", "sac"])
def test_the_agent_is_that_of_the_run(tmp_path: Path, agent: str) -> None:
    key = f"rsl_rl_{agent}_cfg_entry_point"
    agent_cfg = load_cfg_from_registry(TASK, key)
    env_cfg = load_cfg_from_registry(TASK, "env_cfg_entry_point")
    write_params(tmp_path, run={"task": TASK, "agent": key}, env=env_cfg, agent=agent_cfg)
    checkpoint = tmp_path / "model_0.pt"
    checkpoint.write_bytes(b"")
    _, found, path = load_run_cfgs(RunArguments(task=TASK, checkpoint=str(checkpoint)))
    assert type(found) is type(agent_cfg) and path == checkpoint


def test_another_agent_than_that_of_the_run_is_refused(tmp_path: Path) -> None:
    key = "rsl_rl_cfg_entry_point"
    env_cfg, agent_cfg = (load_cfg_from_registry(TASK, each) for each in ("env_cfg_entry_point", key))
    write_params(tmp_path, run={"task": TASK, "agent": key}, env=env_cfg, agent=agent_cfg)
    (tmp_path / "model_0.pt").write_bytes(b"")
    with pytest.raises(UsageError, match=f"--agent is 'sac', but {tmp_path} was trained with {key}; leave --agent out"):
        load_run_cfgs(RunArguments(task=TASK, agent="sac", checkpoint=str(tmp_path / "model_0.pt")))


def test_further_images_of_a_policy_go_with_it_to_another_task(tmp_path: Path) -> None:
    env_cfg = load_cfg_from_registry(TASK, "env_cfg_entry_point")
    past = ObservationTermCfg(func=rgb, delay_min_lag=20, delay_max_lag=20)
    env_cfg.observations.policy.terms = {"rgb_20": past}
    env_cfg.observations.policy.rgb.history_length = 3
    agent_cfg = load_cfg_from_registry(TASK, "rsl_rl_cfg_entry_point")
    write_params(tmp_path, run={"task": TASK, "agent": "rsl_rl_cfg_entry_point"}, env=env_cfg, agent=agent_cfg)
    (tmp_path / "model_0.pt").write_bytes(b"")
    other, _, _ = load_run_cfgs(RunArguments(task="ARC-Sigmoid-Capsule", checkpoint=str(tmp_path / "model_0.pt")))
    assert other.observations.policy.terms["rgb_20"].delay_min_lag == 20
    assert other.observations.policy.rgb.history_length == 5


def test_a_group_that_a_policy_reads_goes_with_it_to_another_task(tmp_path: Path) -> None:
    """``force``, which its actor reads, and not ``shape``, which was there besides."""
    env_cfg = load_cfg_from_registry(TASK, "env_cfg_entry_point")
    env_cfg.extra_observations = ("force", "shape")
    agent_cfg = load_cfg_from_registry(TASK, "rsl_rl_cfg_entry_point")
    agent_cfg.obs_groups["actor"] = ["policy", "force"]
    write_params(tmp_path, run={"task": TASK, "agent": "rsl_rl_cfg_entry_point"}, env=env_cfg, agent=agent_cfg)
    (tmp_path / "model_0.pt").write_bytes(b"")
    other, _, _ = load_run_cfgs(RunArguments(task="ARC-Sigmoid-Capsule", checkpoint=str(tmp_path / "model_0.pt")))
    assert other.extra_observations == ("force",)


def test_a_roll_to_and_fro_and_going_back_go_with_their_policy(tmp_path: Path) -> None:
    """In evaluation and play, in its own task and in another one; a robot without such an action is left alone."""
    trained = "ARC-Rectum-Magnetic"
    env_cfg = load_cfg_from_registry(trained, "env_cfg_entry_point")
    env_cfg.actions.tip.roll_amplitude, env_cfg.actions.tip.roll_period = 9.0, 3.0
    env_cfg.actions.tip.back_off_velocity, env_cfg.actions.tip.back_off_time = 0.03, 2.0
    env_cfg.actions.tip.linear_scale = 0.02
    agent_cfg = load_cfg_from_registry(trained, "rsl_rl_cfg_entry_point")
    write_params(tmp_path, run={"task": trained, "agent": "rsl_rl_cfg_entry_point"}, env=env_cfg, agent=agent_cfg)
    checkpoint = tmp_path / "model_0.pt"
    checkpoint.write_bytes(b"")
    for task in (trained, f"{trained}-Play", "ARC-Cecum-Magnetic", "ARC-LeftColon-Magnetic-Play"):
        played, _, _ = load_run_cfgs(RunArguments(task=task, checkpoint=str(checkpoint)))
        judged, _ = load_trial_cfgs(task, checkpoint, ())
        for tip in (played.actions.tip, judged.actions.tip):
            assert (tip.roll_amplitude, tip.roll_period) == (9.0, 3.0)
            assert (tip.back_off_velocity, tip.back_off_after, tip.back_off_time) == (0.03, 4.0, 2.0)
            assert tip.linear_scale == (0.02 if trained in task else 0.045)
        still, _ = load_trial_cfgs(task, checkpoint, ("env.actions.tip.roll_amplitude=0",))
        assert still.actions.tip.roll_amplitude == 0.0
    pushed, _, _ = load_run_cfgs(RunArguments(task="ARC-Rectum-Proximal", checkpoint=str(checkpoint)))
    assert pushed.actions.base.roll_amplitude == 0.0


def test_a_scope_of_another_length_goes_with_its_policy_and_is_told(tmp_path: Path, capsys) -> None:
    """In its own task, where no override gives it that of the task."""
    trained, field = "ARC-Cecum-Magnetic", "env.scene.endoscope.length"
    env_cfg = load_cfg_from_registry(trained, "env_cfg_entry_point")
    env_cfg.scene.endoscope.length = None
    agent_cfg = load_cfg_from_registry(trained, "rsl_rl_cfg_entry_point")
    write_params(tmp_path, run={"task": trained, "agent": "rsl_rl_cfg_entry_point"}, env=env_cfg, agent=agent_cfg)
    checkpoint = tmp_path / "model_0.pt"
    checkpoint.write_bytes(b"")
    for task, override, length in (
        (trained, (), None),
        (f"{trained}-Play", (), None),
        (trained, (f"{field}=2.2",), 2.2),
        (trained, (f"{field}=null",), None),
        ("ARC-LeftColon-Magnetic", (), None),
    ):
        judged, _ = load_trial_cfgs(task, checkpoint, override)
        note = f"note: a scope of its shipped length, as the run had; {task} has one of 2.2 m now, which {field}=2.2"
        assert judged.scene.endoscope.length == length
        assert (note in capsys.readouterr().out) == (trained in task and not override)


def test_a_run_that_was_stuck_sooner_says_so_and_its_trials_are_not(tmp_path: Path, capsys) -> None:
    task, field = "ARC-LeftColon-Magnetic", "env.terminations.stuck.params.window_s"
    env_cfg = load_cfg_from_registry(task, "env_cfg_entry_point")
    env_cfg.stuck_after_s = 6.0
    agent_cfg = load_cfg_from_registry(task, "rsl_rl_cfg_entry_point")
    write_params(tmp_path, run={"task": task, "agent": "rsl_rl_cfg_entry_point"}, env=env_cfg, agent=agent_cfg)
    checkpoint = tmp_path / "model_0.pt"
    checkpoint.write_bytes(b"")
    note = (
        f"note: an episode is stuck after 6 s, as in the run; in {task} it is after 20 s now, which {field}=20 gives it"
    )
    for overrides, seconds in ((), 6.0), ([f"{field}=6.0"], 6.0), ([f"{field}=20.0"], 20.0):
        args = RunArguments(task=task, checkpoint=str(checkpoint), overrides=list(overrides))
        assert load_run_cfgs(args)[0].stuck_after_s == seconds
        assert (note in capsys.readouterr().out) == (not overrides)
    assert load_trial_cfgs(task, checkpoint, ())[0].stuck_after_s == 20.0
    assert "note: " not in capsys.readouterr().out


def test_trials_are_drawn_by_the_task_however_the_training_drew(tmp_path: Path) -> None:
    env_cfg = load_cfg_from_registry(TASK, "env_cfg_entry_point")
    own = tuple(env_cfg.events.friction.params["friction"])
    env_cfg.events.friction.params["friction"] = (0.0, 0.01)
    env_cfg.observations.policy.rgb.history_length = 3
    agent_cfg = load_cfg_from_registry(TASK, "rsl_rl_cfg_entry_point")
    write_params(tmp_path, run={"task": TASK, "agent": "rsl_rl_cfg_entry_point"}, env=env_cfg, agent=agent_cfg)
    (tmp_path / "model_0.pt").write_bytes(b"")
    played, _, _ = load_run_cfgs(RunArguments(task=TASK, checkpoint=str(tmp_path / "model_0.pt")))
    judged, _ = load_trial_cfgs(TASK, tmp_path / "model_0.pt", ())
    assert tuple(played.events.friction.params["friction"]) == (0.0, 0.01)
    assert tuple(judged.events.friction.params["friction"]) == own != (0.0, 0.01)
    assert judged.observations.policy.rgb.history_length == 3
    asked, _ = load_trial_cfgs(TASK, tmp_path / "model_0.pt", ("env.events.friction.params.friction=[0.2,0.3]",))
    assert tuple(asked.events.friction.params["friction"]) == (0.2, 0.3)


def test_trials_have_the_tissue_of_the_suite_whatever_the_policy_learnt_in(tmp_path: Path) -> None:
    """A policy that learnt in clinical tissue was judged in it where the suite's trials are of another."""
    env_cfg = load_cfg_from_registry(TASK, "env_cfg_entry_point")
    env_cfg.clinical, env_cfg.scene.colon.material = ("all",), "in_situ"
    agent_cfg = load_cfg_from_registry(TASK, "rsl_rl_cfg_entry_point")
    write_params(tmp_path, run={"task": TASK, "agent": "rsl_rl_cfg_entry_point"}, env=env_cfg, agent=agent_cfg)
    (tmp_path / "model_0.pt").write_bytes(b"")
    judged, _ = load_trial_cfgs(TASK, tmp_path / "model_0.pt", ())
    assert tuple(judged.clinical) == () and judged.scene.colon.material == "paper"
    asked, _ = load_trial_cfgs(TASK, tmp_path / "model_0.pt", ("env.clinical=[camera]",))
    assert tuple(asked.clinical) == ("camera",)
    played, _, _ = load_run_cfgs(RunArguments(task=TASK, checkpoint=str(tmp_path / "model_0.pt")))
    assert tuple(played.clinical) == ("all",) and played.scene.colon.material == "in_situ"


def test_a_run_that_goes_on_from_a_checkpoint_says_which_agent_it_has(tmp_path: Path, monkeypatch) -> None:
    """Or the run that goes on could not be played: its parameters would be read as those of PPO."""
    key = "rsl_rl_sac_cfg_entry_point"
    agent_cfg = load_cfg_from_registry(TASK, key)
    env_cfg = load_cfg_from_registry(TASK, "env_cfg_entry_point")
    write_params(tmp_path, run={"task": TASK, "agent": key}, env=env_cfg, agent=agent_cfg)
    (tmp_path / "model_0.pt").write_bytes(b"")
    seen = []
    monkeypatch.setattr("arcgym.rl.training.train", lambda _task, _env, *rest: seen.append(rest) or 0)
    assert main(["train", "--task", TASK, "--resume", "--checkpoint", str(tmp_path / "model_0.pt")]) == 0
    ((found, options),) = seen
    assert type(found) is type(agent_cfg) and options.agent == key
