# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Bad input is answered in one line with exit status 2, before anything is compiled or any folder is made."""

from __future__ import annotations

import importlib.util
import os

import gymnasium
import pytest
import torch

from arcgym.cli.main import main

TASK = ["--task", "ARC-Splenic-Proximal"]
TRAIN, PLAY, ZERO = ["train", *TASK], ["play", *TASK], ["zero", *TASK]


@pytest.fixture(autouse=True)
def nothing_is_built(tmp_path, monkeypatch):
    """Run in an empty folder that must stay empty, without environments and loggers."""

    def make(*_, **__):
        raise AssertionError("the environment was built")

    monkeypatch.setattr(gymnasium, "make", make)
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    find_spec = importlib.util.find_spec
    missing = ("wandb", "neptune")
    monkeypatch.setattr(importlib.util, "find_spec", lambda name, *a: None if name in missing else find_spec(name, *a))
    monkeypatch.chdir(tmp_path)
    yield
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (["trian"], "unknown subcommand 'trian'. Did you mean 'train'?"),
        (["train"], "required: --task"),
        (["train", "--task", "ARC-Splenic-Proxmal"], "'ARC-Splenic-Proxmal'. Did you mean 'ARC-Splenic-Proximal'"),
        ([*TRAIN, "--num_env", "3"], "unknown flag '--num_env'. Did you mean '--num_envs'?"),
        ([*TRAIN, "seed=3"], "unexpected argument 'seed=3'. An override is written env.path=value"),
        ([*TRAIN, "--num_envs", "0"], "--num_envs: 0 is too small, expected 1 or more"),
        ([*TRAIN, "--num_envs", "-3"], "--num_envs: -3 is too small, expected 1 or more"),
        ([*TRAIN, "--num_envs", "many"], "--num_envs: 'many' is no whole number, expected 1 or more"),
        ([*TRAIN, "env.scene.num_envs=0"], "env.scene.num_envs is 0, expected"),
        ([*TRAIN, "--max_iterations", "-1"], "--max_iterations: -1 is too small, expected 1 or more"),
        ([*TRAIN, "--device", "tpu"], "--device is 'tpu', expected cpu, cuda or cuda:<n>"),
        (
            [*TRAIN, "--device", "cuda:7"],
            "--device is 'cuda:7', which torch does not find",
        ),
        ([*TRAIN, "env.sim.dt=-0.01"], "env.sim.dt is -0.01 s, expected a number above 0"),
        ([*TRAIN, "env.sim.dt=fast"], "'env.sim.dt' expects float, got str 'fast'"),
        ([*TRAIN, "env.simm.dt=0.01"], "'env' has no field 'simm'. Did you mean 'sim'?"),
        (
            ["train", "--task", "ARC-Splenic-Capsule", "env.actions.capsule.back_off_velocity=0.045"],
            "env.actions.capsule.back_off_velocity is 0.045 m/s, but capsule.usda has no tether",
        ),
        ([*TRAIN, "env.lumen=metrik"], "'metrik'"),
        ([*TRAIN, "env.direction=withdrawal"], "env.direction is 'withdrawal' with terminations.stuck, which counts"),
        ([*TRAIN, "env.segment=cecu"], "env.segment is 'cecu'. Did you mean 'cecum'"),
        ([*TRAIN, "env.scene.colon.material=in_sit"], "'in_sit'"),
        ([*TRAIN, "env.scene.colon.usd_path=colon_9/colon.usda"], "colon_9/colon.usda"),
        ([*TRAIN, "env.scene.camera.width=20", "env.scene.camera.height=20"], "does not fit the 20x20 px images"),
        ([*TRAIN, "--num_envs", "1", "agent.num_steps_per_env=4"], "num_mini_batches is 6, but 1 worlds x 4 steps"),
        ([*TRAIN, "--agent", "ppo_recurrent", "--num_envs", "11"], "num_mini_batches is 6, but there are 11 worlds"),
        ([*TRAIN, "agent.init_policy=nowhere.pt"], "agent.init_policy is 'nowhere.pt', and there is no such file"),
        ([*TRAIN, "--agent", "ppo_taught"], "agent.teacher_checkpoint is not set"),
        ([*TRAIN, "--agent", "distillation", "agent.teacher_checkpoint=no.pt"], "agent.teacher_checkpoint is 'no.pt'"),
        (
            [*TRAIN, "agent.algorithm.learning_rate=-1.0"],
            "agent.algorithm.learning_rate is -1.0, expected a number above 0",
        ),
        ([*TRAIN, "agent.algorithm.optimizer=adamm"], "'adamm'. Did you mean 'adam'"),
        ([*TRAIN, "agent.algorithm.class_name=PPOO"], "agent.algorithm.class_name is 'PPOO'"),
        ([*TRAIN, "agent.obs_groups.actor=[polcy]"], "agent.obs_groups.actor reads 'polcy'"),
        ([*TRAIN, "--logger", "wandbb"], "invalid choice: 'wandbb'"),
        ([*TRAIN, "--logger", "wandb"], "agent.logger=wandb needs the package 'wandb', which is not installed"),
        ([*TRAIN, "agent.logger=papyrus"], "'papyrus'"),
        ([*TRAIN, "--experiment_name", "a/b"], "experiment_name is 'a/b', expected a name without '/'"),
        (
            [*TRAIN, "--agent", "bc", "agent.torch_compile_mode=default"],
            "torch_compile_mode is 'default', expected None",
        ),
        ([*TRAIN, "--agent", "distillation", "+agent.obs_groups.actor=[policy]"], "has 'actor', and NavigationDist"),
        (
            [*TRAIN, "--agent", "ppo_lagrangian", "agent.algorithm.multiplier.kind=fixed"],
            "init is 0.001 with the kind 'fixed', whose penalty it is",
        ),
        ([*TRAIN, "--checkpoint", "model_7.pt"], "--checkpoint is given without --resume"),
        ([*TRAIN, "--load_run", "mine"], "--load_run is given without --resume"),
        (["record", *TASK, "--checkpoint", "model_7.pt"], "--checkpoint is given with --agent expert, which has none"),
        ([*TRAIN, "--agent", "distillation", "agent.algorithm.gradient_length=100"], "expected a divisor of"),
        ([*TRAIN, "--distributed"], "--distributed needs torchrun"),
        ([*TRAIN, "--resume", "--load_run", "["], "load_run '[' is no regular expression"),
        ([*PLAY, "--checkpoint", "model_7.pt"], "No checkpoint 'model_7.pt'"),
        (
            [*TRAIN, "--agent", "pppo"],
            "'pppo', which ARC-Splenic-Proximal does not have. Did you mean 'ppo'",
        ),
        ([*PLAY, "--checkpoint", "runs/model_7.pt"], "--checkpoint is 'runs/model_7.pt': there is no such file."),
        (
            PLAY,
            "Nothing was trained in logs/rsl_rl/arc_splenic_proximal. No policy is shipped for ARC-Splenic-Proximal,",
        ),
        (PLAY, "--policy expert, zero and random need no checkpoint."),
        ([*PLAY, "--experiment_name", "nowhere"], "No checkpoint 'latest'"),
        ([*PLAY, "--policy", "rando"], "invalid choice: 'rando'"),
        (["record", *TASK, "--agent", "exprt"], "--agent is 'exprt'. Did you mean 'expert'"),
        (
            ["evaluate", "--agent", "zero", "--out", "results", "env.scene.colon.usd_path=ct_1"],
            "usd_path=ct_1 would change nothing, as trials set env.scene.colon.usd_path themselves: give trials",
        ),
        (
            ["evaluate", "--agent", "zero", "--out", "results", "+env.recorders.episodes={}"],
            "trials set env.recorders themselves",
        ),
        (
            ["evaluate", "--agent", "zero", "--out", "results", "env.scene.colon={usd_path: ct_1}"],
            "would change nothing, as trials set env.scene.colon.usd_path themselves",
        ),
        (["replay", "."], ". is a folder, expected a file ending in .hdf5."),
        (["preview", "colon_9", "page.png"], "no such file. Existing stages in"),
        (["preview", "colons/a/colon.usda", "page.png"], "ct_2; nor is it in the working folder, "),
        (["snapshots", *TASK, "--device", "tpu"], "--device is 'tpu', expected cpu, cuda or cuda:<n>"),
        (["teleop", *TASK, "--patient", "colon_11"], "--patient: There is no colon 'colon_11'"),
        ([*ZERO, "--steps", "0"], "--steps: 0 is too small, expected 1 or more"),
        ([*ZERO, "env.scene.colon.material=none"], "'none'"),
    ],
)
def test_bad_input(command, message, capsys):
    with pytest.raises(SystemExit) as stop:
        main(command)
    output = capsys.readouterr()
    assert stop.value.code == 2
    assert message in output.err
    assert output.err.count("\n") == 1


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_folder_that_cannot_be_written(tmp_path, monkeypatch, capsys):
    locked = tmp_path / "locked"
    locked.mkdir(mode=0o500)
    monkeypatch.chdir(locked)
    with pytest.raises(SystemExit):
        main(TRAIN)
    assert "no permission to write" in capsys.readouterr().err
    monkeypatch.chdir(tmp_path)
    locked.rmdir()
