# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar, Literal

import pytest

from arcgym.utils import configclass
from arcgym.utils.hydra import apply_overrides


@configclass
class TermCfg:
    can_be_none: ClassVar[bool] = True
    func: Callable[..., Any] = max
    weight: float = 1.0
    params: dict[str, Any] = {"sigma": 0.5}


@configclass
class RewardsCfg:
    contact = TermCfg()


@configclass
class SceneCfg:
    num_envs: int = 64
    size: tuple[int, int] = (84, 84)
    device: str | None = None
    layers: list[int] = [1, 2]
    mode: Literal["fast", "slow"] = "fast"


@configclass
class ViewCfg:
    angle: float = 0.0

    @classmethod
    def from_name(cls, name: str) -> ViewCfg:
        if name != "side":
            raise ValueError(f"There is no view '{name}'.")
        return ViewCfg(angle=90.0)


@configclass
class EnvCfg:
    view: ViewCfg = ViewCfg()
    scene: SceneCfg = SceneCfg()
    rewards: RewardsCfg = RewardsCfg()
    terms: dict[str, TermCfg] = {"first": TermCfg()}
    use_graph: bool = True

    def __post_init__(self) -> None:
        self.scene.num_envs = 8


@pytest.fixture
def cfg() -> EnvCfg:
    return EnvCfg()


def get(cfg: Any, path: str) -> Any:
    for name in path.split("."):
        cfg = cfg[name] if isinstance(cfg, dict) else getattr(cfg, name)
    return cfg


@pytest.mark.parametrize(
    ("path", "text", "expected"),
    [
        ("scene.num_envs", "4", 4),
        ("scene.size", "[64,48]", (64, 48)),
        ("scene.device", "cpu", "cpu"),
        ("scene.device", "null", None),
        ("scene.layers", "[3,4,5]", [3, 4, 5]),
        ("scene.mode", "slow", "slow"),
        ("use_graph", "false", False),
        ("rewards.contact.weight", "2", 2.0),
        ("rewards.contact.weight", "1e-4", 1e-4),
        ("rewards.contact.params.sigma", "1", 1.0),
        ("rewards.contact.func", "math:sqrt", __import__("math").sqrt),
        ("rewards.contact", "null", None),
        ("terms.first.weight", "3.5", 3.5),
    ],
)
def test_value_is_fitted_to_its_field(cfg: EnvCfg, path: str, text: str, expected: Any) -> None:
    apply_overrides({"env": cfg}, [f"env.{path}={text}"])
    assert get(cfg, path) == expected and type(get(cfg, path)) is type(expected)


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("env.scene.num_env=4", "'env.scene' has no field 'num_env'. Did you mean 'num_envs'"),
        ("env.scene.num_env=4", "Available: device, layers, mode, num_envs, size"),
        ("evn.scene.num_envs=4", "no field 'evn'. Did you mean 'env'"),
        ("env.rewards.contact.params.sigmo=1", "Did you mean 'sigma'"),
        ("env.rewards.contact.func=math:sqr", "'math:sqr': no attribute 'sqr'. Did you mean 'sqrt'"),
        ("env=3", "name a field inside it"),
        ("use_graph=false", "The command has no field 'use_graph'. Did you mean 'env.use_graph'"),
        ("speed=3", "The command has no field 'speed': begin with 'env.'"),
        ("env.view=sidee", "'env.view': There is no view 'sidee'"),
        ("env.use_graph", "expected path=value"),
        ("~env.rewards.contact", "use path=null"),
        ("env.scene.num_envs=1,2", "deletes or sweeps"),
        ("env.scene.device.index=1", "switched off"),
    ],
)
def test_unknown_path_says_what_was_meant(cfg: EnvCfg, override: str, message: str) -> None:
    with pytest.raises(ValueError) as error:
        apply_overrides({"env": cfg}, [override])
    assert message in str(error.value)


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("env.scene.num_envs=2.5", "'env.scene.num_envs' expects int, got float 2.5"),
        ("env.scene.num_envs=true", "expects int, got bool True"),
        ("env.scene.num_envs=null", "expects int, got NoneType None"),
        ("env.scene.size=[1,2,3]", "'env.scene.size' expects tuple[int, int], got list [1, 2, 3]"),
        ("env.scene.size=[1,a]", "'env.scene.size.1' expects int, got str 'a'"),
        ("env.scene.mode=medium", "expects Literal['fast', 'slow'], got str 'medium'"),
        ("env.scene=null", "expects SceneCfg, got NoneType None"),
        ("env.use_graph=1", "expects bool, got int 1"),
        ("env.rewards.contact.params.sigma=wide", "expects float, got str 'wide'"),
    ],
)
def test_wrong_type_names_field_expected_and_given(cfg: EnvCfg, override: str, message: str) -> None:
    with pytest.raises(TypeError) as error:
        apply_overrides({"env": cfg}, [override])
    assert message in str(error.value)


def test_override_stands_against_post_init(cfg: EnvCfg) -> None:
    assert cfg.scene.num_envs == 8
    apply_overrides({"env": cfg}, ["env.scene.num_envs=3"])
    assert cfg.scene.num_envs == 3


def test_plus_adds_a_dict_entry(cfg: EnvCfg) -> None:
    apply_overrides({"env": cfg}, ["+env.rewards.contact.params.limit=2"])
    assert cfg.rewards.contact.params == {"sigma": 0.5, "limit": 2}


def test_dict_sets_several_fields_of_a_nested_configuration(cfg: EnvCfg) -> None:
    apply_overrides({"env": cfg}, ["env.scene={num_envs: 2, mode: slow}"])
    assert (cfg.scene.num_envs, cfg.scene.mode, cfg.scene.size) == (2, "slow", (84, 84))


def test_each_configuration_has_its_own_first_word(cfg: EnvCfg) -> None:
    agent = SceneCfg()
    apply_overrides({"env": cfg, "agent": agent}, ["agent.num_envs=1", "env.use_graph=false"])
    assert agent.num_envs == 1 and cfg.use_graph is False


def test_a_name_replaces_a_configuration_that_has_presets(cfg: EnvCfg) -> None:
    apply_overrides({"env": cfg}, ["env.view=side"])
    assert cfg.view == ViewCfg(angle=90.0)
    apply_overrides({"env": cfg}, ["env.view.angle=80"])
    assert cfg.view.angle == 80.0
