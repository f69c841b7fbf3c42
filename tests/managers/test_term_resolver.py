# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import pytest
import torch

from arcgym.managers import ManagerTermBase, RewardManager, RewardTermCfg, SceneEntityCfg, TerminationTermCfg
from arcgym.utils.errors import TermError


def scaled(env, factor, offset=0.0):
    return env.value * factor + offset


def num_hinges(env, asset_cfg=SceneEntityCfg("endoscope", joint_names="hinge_.*")):  # noqa: B008
    return torch.full((env.num_envs,), float(len(asset_cfg.joint_ids)))


class Counting(ManagerTermBase):
    """Counts its calls since the last reset."""

    def __init__(self, cfg, env):
        super().__init__(cfg, env)
        self.count = torch.zeros(self.num_envs)

    def reset(self, env_ids=None):
        self.count[slice(None) if env_ids is None else env_ids] = 0.0

    def __call__(self, env, step=1.0):
        self.count += step
        return self.count


def test_missing_parameter_is_named(env) -> None:
    message = r"Term 'a' of RewardManager expects parameters \['factor'\] and optionally \['offset'\], got \['offset'\]"
    with pytest.raises(TermError, match=message):
        RewardManager({"a": RewardTermCfg(func=scaled, params={"offset": 1.0})}, env)


def test_unknown_parameter_is_named(env) -> None:
    with pytest.raises(TermError, match=r"got \['factor', 'bias'\]"):
        RewardManager({"a": RewardTermCfg(func=scaled, params={"factor": 1.0, "bias": 1.0})}, env)


def test_text_is_imported(env) -> None:
    manager = RewardManager({"a": RewardTermCfg(func=f"{__name__}:scaled", params={"factor": 2.0})}, env)
    assert manager.compute(dt=1.0).tolist() == [2.0, 6.0]


def test_wrong_text_names_the_term(env) -> None:
    with pytest.raises(ValueError, match="Term 'a' of RewardManager: .*'scale'. Did you mean 'scaled'"):
        RewardManager({"a": RewardTermCfg(func=f"{__name__}:scale")}, env)


def test_wrong_kind_of_term_is_named(env) -> None:
    with pytest.raises(
        TermError, match="Term 'a' of RewardManager is of type TerminationTermCfg, expected .*RewardTermCfg"
    ):
        RewardManager({"a": TerminationTermCfg(func=scaled)}, env)


def test_wrong_shape_names_got_and_expected(env) -> None:
    with pytest.raises(ValueError, match=r"Term 'a' of RewardManager returned shape \(2, 1\), expected \(2,\)"):
        RewardManager({"a": RewardTermCfg(func=lambda env: env.value.unsqueeze(1))}, env)


def test_class_must_be_a_term(env) -> None:
    with pytest.raises(TermError, match="the class dict, which does not derive from ManagerTermBase"):
        RewardManager({"a": RewardTermCfg(func=dict)}, env)


def test_class_term_starts_fresh_and_is_reset_by_world(env) -> None:
    manager = RewardManager({"a": RewardTermCfg(func=Counting, params={"step": 2.0})}, env)
    assert manager.compute(1.0).tolist() == [2.0, 2.0]
    manager.reset(torch.tensor([1]))
    assert manager.compute(1.0).tolist() == [4.0, 2.0]


def test_configuration_of_the_environment_is_left_alone(env) -> None:
    cfg = {"a": RewardTermCfg(func=Counting)}
    RewardManager(cfg, env)
    assert cfg["a"].func is Counting


def test_default_scene_entity_of_a_function_is_resolved(env) -> None:
    assert RewardManager({"a": RewardTermCfg(func=num_hinges)}, env).compute(1.0).tolist() == [3.0, 3.0]


def test_entity_error_names_term_and_parameter(env) -> None:
    params = {"asset_cfg": SceneEntityCfg("endoscop")}
    with pytest.raises(
        ValueError, match="Term 'a' of RewardManager, parameter 'asset_cfg': .*Did you mean 'endoscope'"
    ):
        RewardManager({"a": RewardTermCfg(func=num_hinges, params=params)}, env)
