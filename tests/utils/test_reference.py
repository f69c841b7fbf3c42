# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""References of terms, on one written here and on all that ship."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from arcgym.envs import mdp
from arcgym.utils.reference import ParamReference, TermReference, describe, terms_of
from arcgym.utils.validation import POSITIVE, expects

if TYPE_CHECKING:
    import torch

TERMS = {term.name: term for term in terms_of(mdp)}


@expects(radius=POSITIVE, mode=("near", "far"))
def too_close(env: Any, radius: float, mode: str = "near") -> torch.Tensor:
    """Whether the tip is too close to the wall,
    bool, shape (N,).

    More words.

    Args:
        radius: Distance at which it is [m],
            measured along the normal.
        mode: Side to look at.

    Raises:
        ValueError: Never.
    """


def test_a_term_of_ones_own() -> None:
    assert describe(too_close) == TermReference(
        name="too_close",
        module=__name__,
        kinds=("reward", "cost", "metrics", "termination"),
        summary="Whether the tip is too close to the wall, bool, shape (N,).",
        params=(
            ParamReference(
                "radius", "required", "Distance at which it is [m], measured along the normal.", str(POSITIVE)
            ),
            ParamReference("mode", "'near'", "Side to look at.", "``near``, ``far``"),
        ),
    )


def test_class_terms_take_their_parameters_from_the_call() -> None:
    stuck = TERMS["stuck"]
    assert stuck.kinds == ("termination",) and stuck.summary.startswith("Whether the tip has hardly advanced")
    assert [(param.name, param.default) for param in stuck.params] == [
        ("window_s", "required"),
        ("min_progress", "required"),
    ]


def test_helpers_are_no_terms() -> None:
    assert {"force_limit", "segment_span", "lumen_scores", "resolve_lumen", "Load"}.isdisjoint(TERMS)
    assert {"load_above", "success", "rgb", "progress", "perturb_tip", "move_param", "load_percentile"} <= set(TERMS)


@pytest.mark.parametrize("name", sorted(TERMS))
def test_every_term_states_shape_and_parameters(name: str) -> None:
    term = TERMS[name]
    assert term.summary.endswith((".", ")", "]"))
    if not {"event", "curriculum"} & set(term.kinds):
        assert "shape (N" in term.summary
    assert [param.name for param in term.params if not param.description] == []
