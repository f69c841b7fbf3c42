# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar

import pytest
import yaml

from arcgym.utils import MISSING, configclass


def square(x: float) -> float:
    return x * x


@configclass
class TermCfg:
    can_be_none: ClassVar[bool] = True
    func: Callable[..., Any] = MISSING
    weight: float = 1.0
    params: dict[str, Any] = {}


@configclass
class GroupCfg:
    noise: bool = True

    def __post_init__(self) -> None:
        self.noise = False


@configclass
class ObservationsCfg:
    @configclass
    class PolicyCfg(GroupCfg):
        joint_pos = TermCfg(func=square)

        def __post_init__(self) -> None:
            super().__post_init__()
            self.joint_pos.weight = 2.0

    policy: PolicyCfg = PolicyCfg()
    bounds: tuple[float, float] = (0.0, 1.0)
    folder: Path | None = None


def test_members_without_annotation_are_fields() -> None:
    names = [field.name for field in dataclasses.fields(ObservationsCfg.PolicyCfg)]
    assert names == ["noise", "joint_pos"]


def test_nested_class_stays_a_class_and_post_init_chains() -> None:
    assert isinstance(ObservationsCfg.PolicyCfg, type)
    policy = ObservationsCfg().policy
    assert policy.noise is False and policy.joint_pos.weight == 2.0


def test_mutable_defaults_are_copied_for_each_instance() -> None:
    first, second = ObservationsCfg(), ObservationsCfg()
    first.policy.joint_pos.params["a"] = 1
    assert second.policy.joint_pos.params == {}
    assert ObservationsCfg.PolicyCfg().joint_pos.params == {}


def test_subclass_overrides_and_switches_off_without_annotation() -> None:
    @configclass
    class Changed(ObservationsCfg):
        policy = None
        bounds = (2.0, 3.0)

    cfg = Changed()
    assert cfg.policy is None and cfg.bounds == (2.0, 3.0)
    assert [field.name for field in dataclasses.fields(Changed)] == ["policy", "bounds", "folder"]
    assert ObservationsCfg().policy is not None


def test_required_field_may_follow_one_with_a_default() -> None:
    @configclass
    class Cfg:
        a: int = 1
        b: int

    assert Cfg().b is MISSING and Cfg(b=2).b == 2


def test_function_overrides_an_inherited_field_but_a_method_stays_a_method() -> None:
    @configclass
    class Cfg(TermCfg):
        func = square

        def double(self) -> float:
            return 2.0 * self.weight

    assert Cfg().func(3.0) == 9.0 and Cfg().double() == 2.0


def test_validate_names_every_missing_path() -> None:
    @configclass
    class Cfg:
        terms: list[TermCfg] = [TermCfg(func=square), TermCfg()]
        table: dict[str, TermCfg] = {"a": TermCfg()}
        name: str

    with pytest.raises(ValueError, match=r"Cfg has fields without a value: terms.1.func, table.a.func, name\."):
        Cfg().validate()


def test_validate_runs_checks_of_nested_configurations() -> None:
    @configclass
    class Positive:
        value: float = 1.0

        def validate_config(self) -> None:
            if self.value <= 0.0:
                raise ValueError(f"value must be positive, got {self.value}")

    @configclass
    class Cfg:
        inner: Positive = Positive()

    cfg = Cfg()
    cfg.validate()
    cfg.inner.value = -1.0
    with pytest.raises(ValueError, match="must be positive, got -1.0"):
        cfg.validate()


def test_replace_copies_and_does_not_run_post_init_again() -> None:
    cfg = GroupCfg()
    assert cfg.replace(noise=True).noise is True and cfg.noise is False
    with pytest.raises(ValueError, match="no field 'nose'. Did you mean 'noise'"):
        cfg.replace(nose=True)


def test_copies_keep_the_mark_of_missing_fields() -> None:
    assert TermCfg().copy().func is MISSING and copy.deepcopy(TermCfg()).func is MISSING


def test_to_dict_is_plain_and_from_dict_reads_it_back() -> None:
    cfg = ObservationsCfg(folder=Path("logs"))
    data = yaml.safe_load(yaml.safe_dump(cfg.to_dict()))
    assert data["policy"]["joint_pos"]["func"] == f"{__name__}:square"
    assert data["bounds"] == [0.0, 1.0] and data["folder"] == "logs"
    other = ObservationsCfg(bounds=(5.0, 6.0))
    other.from_dict(data)
    assert other == cfg


def test_term_that_is_switched_off_survives_the_round_trip() -> None:
    cfg = ObservationsCfg(policy=None)
    other = ObservationsCfg(policy=None)
    other.from_dict(cfg.to_dict())
    assert other.policy is None


def test_from_dict_names_an_unknown_field() -> None:
    with pytest.raises(ValueError, match="has no field 'policy.joint_pos.wait'. Did you mean 'weight'"):
        ObservationsCfg().from_dict({"policy": {"joint_pos": {"wait": 1.0}}})
