# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Bounds and names on a configuration of three fields."""

from __future__ import annotations

import math
from typing import Any

import pytest

from arcgym.utils import configclass
from arcgym.utils.configclass import validate
from arcgym.utils.validation import (
    POSITIVE,
    FieldError,
    Range,
    check_params,
    expects,
    require,
    require_ascending,
    require_order,
    require_positive,
)


@configclass
class SpringCfg:
    stiffness: float | None = 2.0
    span: tuple[float, float] = (0.0, 1.0)
    kind: str = "linear"

    def validate_config(self) -> None:
        require_positive(self, "stiffness", unit="N/m")


@configclass
class RobotCfg:
    springs: dict[str, SpringCfg] = {"left": SpringCfg()}


@pytest.mark.parametrize(
    ("bounds", "inside", "outside"),
    [
        (Range(0.0, 1.0), (0, 0.5, 1.0), (-0.1, 1.1)),
        (Range(0.0, 1.0, above=True, below=True), (0.5,), (0.0, 1.0)),
        (Range(1), (1, 7), (0, 0.5)),
        (Range(), (-1e30, 0), (math.inf, -math.inf, math.nan, "3", True, None)),
    ],
)
def test_range(bounds: Range, inside: tuple, outside: tuple) -> None:
    assert all(value in bounds for value in inside)
    assert not any(value in bounds for value in outside)


def test_bounds_in_words() -> None:
    assert str(Range(0.0, 1.0, above=True)) == "a number above 0 and at most 1"
    assert str(Range(1)) == "a number at least 1" and str(Range()) == "a finite number"


def test_a_number_outside_is_named_with_its_unit_and_bounds() -> None:
    with pytest.raises(FieldError, match=r"^SpringCfg.stiffness is -1.0 N/m, expected a number above 0 N/m\.$"):
        SpringCfg(stiffness=-1.0).validate_config()
    SpringCfg(stiffness=None).validate_config()


def test_validate_puts_the_path_as_on_the_command_line() -> None:
    cfg = RobotCfg()
    cfg.springs["left"].stiffness = 0.0
    with pytest.raises(ValueError, match=r"^env.springs.left.stiffness is 0.0 N/m, expected"):
        validate(cfg, "env")


def test_every_entry_of_a_sequence_is_checked() -> None:
    with pytest.raises(FieldError, match="span is 1.5, expected a number at least 0 and at most 1"):
        require(SpringCfg(span=(0.0, 1.5)), "span", Range(0.0, 1.0))


def test_an_unknown_name_gets_the_nearest() -> None:
    with pytest.raises(FieldError, match="kind is 'liner'. Did you mean 'linear'. Available: cubic, linear"):
        require(SpringCfg(kind="liner"), "kind", ("linear", "cubic"))


def test_pairs_and_fields_in_order() -> None:
    with pytest.raises(FieldError, match=r"span is \(2.0, 1.0\) m, expected the smaller number first"):
        require_ascending(SpringCfg(span=(2.0, 1.0)), "span", unit="m")

    @configclass
    class LimitsCfg:
        low: float = 2.0
        high: float = 1.0

    with pytest.raises(FieldError, match=r"high is 1.0 N, but low \(2.0 N\) < high \(1.0 N\) must hold"):
        require_order(LimitsCfg(), "low", "high", unit="N")


def test_nan_and_wrong_types_are_refused_without_a_check_of_its_own() -> None:
    with pytest.raises(ValueError, match="env.span.1 is nan, expected a number"):
        validate(SpringCfg(span=(0.0, math.nan)), "env")
    wrong: Any = "1"
    with pytest.raises(TypeError, match="'env.stiffness' expects float | None, got str '1'"):
        validate(SpringCfg(stiffness=wrong), "env")


def test_parameters_of_terms() -> None:
    @expects(kind=("tip", "wall"), limit=("comfort",), window=POSITIVE)
    def term(env: Any, kind: str, limit: float | str = 1.0, window: float = 1.0) -> None: ...

    for good in ({"kind": "tip"}, {"limit": "comfort"}, {"limit": -3.0}, {"window": 0.1}):
        check_params(SpringCfg(), term, good)
    for bad, message in (
        ({"kind": "tipp"}, "params.kind is 'tipp'. Did you mean 'tip'"),
        ({"limit": "comfy"}, "params.limit is 'comfy'. Did you mean 'comfort'"),
        ({"window": 0.0}, "params.window is 0.0, expected a number above 0"),
    ):
        with pytest.raises(FieldError, match=message):
            check_params(SpringCfg(), term, bad)
