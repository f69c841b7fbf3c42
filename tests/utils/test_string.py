# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import math

import pytest

from arcgym.utils.string import callable_name, did_you_mean, nearest, resolve_callable, resolve_matching_names


def test_names_come_in_their_own_order_unless_asked() -> None:
    names = ["slide", "hinge_1", "hinge_2"]
    assert resolve_matching_names(["hinge_2", "slide"], names) == ([0, 2], ["slide", "hinge_2"])
    assert resolve_matching_names(["hinge_2", "slide"], names, preserve_order=True) == ([2, 0], ["hinge_2", "slide"])


def test_expression_must_match_the_whole_name() -> None:
    with pytest.raises(ValueError, match="'hinge' matches no name. Did you mean 'hinge_1'"):
        resolve_matching_names("hinge", ["hinge_1", "slide"])


def test_callables_go_to_text_and_back() -> None:
    assert resolve_callable(callable_name(pytest.raises)) is pytest.raises
    assert resolve_callable("math:sqrt") is math.sqrt


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("math.sqrt", "expected 'module:attribute'"),
        ("no_such_module:f", "No module named"),
        ("math:squareroot", "no attribute 'squareroot'"),
        ("math:pi", "of type float, expected a callable"),
    ],
)
def test_wrong_text_is_explained(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        resolve_callable(text)


def test_hint_names_the_closest_first() -> None:
    assert did_you_mean("wieght", ["weight", "params"]) == "Did you mean 'weight'? Available: params, weight."
    assert did_you_mean("x", []) == "Nothing is available here."
    assert nearest("wieght", ["weight", "params"]) == "Did you mean 'weight'? "
    assert nearest("x", ["weight", "params"]) == ""
