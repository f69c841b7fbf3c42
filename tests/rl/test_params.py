# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import pytest
import yaml

from arcgym.envs.mdp import METRIC
from arcgym.rl.params import differences, read_params, restore, without
from arcgym.rl.run_folder import write_params
from arcgym.utils.coerce import to_plain
from arcgym.utils.errors import UsageError
from arcgym.utils.registry import load_cfg_from_registry

TASK = "ARC-Sigmoid-Capsule"


@pytest.fixture
def env_cfg():
    return load_cfg_from_registry(TASK, "env_cfg_entry_point")


def test_differences_are_dotted():
    old, new = {"a": 1, "b": {"c": 2, "d": {"e": 3}}}, {"a": 1, "b": {"c": 4, "d": None}}
    assert differences(old, new) == {"b.c": (2, 4), "b.d": ({"e": 3}, None)}


def test_without_leaves_the_rest():
    assert without({"a": 1, "b": {"c": 2, "d": 3}}, ["a", "b.d"]) == {"b": {"c": 2}}


def test_a_run_comes_back_as_it_was(env_cfg, tmp_path):
    env_cfg.rewards.progress.weight, env_cfg.rewards.action_rate, env_cfg.lumen = 7.0, None, METRIC.copy()
    agent_cfg = load_cfg_from_registry(TASK, "rsl_rl_cfg_entry_point")
    agent_cfg.actor.hidden_dims = [64]
    write_params(tmp_path, run={"task": TASK}, env=env_cfg, agent=agent_cfg)
    saved = read_params(tmp_path)
    fresh_env = load_cfg_from_registry(TASK, "env_cfg_entry_point")
    fresh_agent = load_cfg_from_registry(TASK, "rsl_rl_cfg_entry_point")
    restore(fresh_env, saved.env, "env")
    restore(fresh_agent, saved.agent, "agent")
    assert saved.task == TASK
    assert fresh_env == env_cfg
    assert fresh_agent == agent_cfg


def test_play_variant_keeps_its_changes(env_cfg):
    env_cfg.lumen, env_cfg.scene.num_envs = METRIC.copy(), 500
    play = load_cfg_from_registry(f"{TASK}-Play", "env_cfg_entry_point")
    plain = load_cfg_from_registry(TASK, "env_cfg_entry_point")
    restore(play, to_plain(env_cfg), "env", list(differences(to_plain(plain), to_plain(play))))
    assert (play.lumen, play.scene.num_envs, play.events.light) == (METRIC, 4, None)


@pytest.mark.parametrize("code", ["subprocess:call", "arcgym.rl.run_folder:shutil.rmtree"])
def test_foreign_code_is_refused(env_cfg, code):
    saved = to_plain(env_cfg)
    saved["rewards"]["progress"]["func"] = code
    with pytest.raises(UsageError, match=f"'{code}' at 'rewards.progress.func'"):
        restore(env_cfg, saved, "env")


def test_a_population_is_no_code(env_cfg):
    saved = to_plain(env_cfg)
    saved["scene"]["colon"]["usd_path"] = ["colon_1/colon.usda", "population:train"]
    restore(env_cfg, saved, "env")
    assert env_cfg.scene.colon.usd_path == ["colon_1/colon.usda", "population:train"]


def test_params_of_another_version_are_refused(env_cfg):
    with pytest.raises(UsageError, match="does not fit this version.*--no_params"):
        restore(env_cfg, {"segmnt": "sigmoid"}, "env")


def test_code_in_yaml_is_not_run(tmp_path):
    write_params(tmp_path, run={}, env={}, agent={})
    (tmp_path / "params" / "env.yaml").write_text("a: !!python/object/apply:os.getcwd []\n")
    with pytest.raises(UsageError, match="env.yaml is no YAML of plain values"):
        read_params(tmp_path)
    assert yaml.safe_load((tmp_path / "params" / "agent.yaml").read_text()) == {}
