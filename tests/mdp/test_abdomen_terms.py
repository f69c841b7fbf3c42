# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""A hand on the abdomen as action and observation, bodies by an event, and how a task asks for them."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
import torch

import arcgym_tasks  # noqa: F401
from arcgym.envs import mdp
from arcgym.utils.configclass import validate
from arcgym.utils.hydra import apply_overrides
from arcgym.utils.registry import load_cfg_from_registry


def configured(*overrides: str):
    cfg = load_cfg_from_registry("ARC-Sigmoid-Proximal", "env_cfg_entry_point")
    apply_overrides({"env": cfg}, list(overrides))
    validate(cfg)
    cfg.resolve()
    return cfg


def test_a_hand_presses_and_moves(env) -> None:
    term = mdp.HandPressureAction(mdp.HandPressureActionCfg(force=40.0, speed=0.1, reach=0.015), env)
    assert (term.action_dim, term.axis_names) == (3, ["press", "right", "cranial"])
    for _ in range(2):
        term.process_actions(torch.tensor([[0.5, 1.0, -0.5], [2.0, 0.0, 0.0]]))
        for _ in range(3):
            term.apply_actions()
    force, place = env.scene["colon"].commands["hand"]
    assert force.tolist() == [20.0, 40.0]
    # 10 and 5 mm a control step of 0.1 s, however often it is applied, and no farther than 15 mm.
    torch.testing.assert_close(place, torch.tensor([[0.015, -0.010], [0.0, 0.0]]))
    assert term.commanded_actions().tolist() == [[0.0] * 3] * 2


def test_the_hand_is_seen(env) -> None:
    data = env.scene["colon"].data
    data.hand_dent[:], data.hand_place[1, 0] = torch.tensor([0.0, 0.05]), 0.02
    torch.testing.assert_close(mdp.hand(env), torch.tensor([[0.0, 0.0, 0.0], [0.5, 0.2, 0.0]]))


def test_every_world_may_have_a_body_of_its_own(env) -> None:
    mdp.randomize_abdomen(env, torch.tensor([1]), gap=None)
    values, worlds = env.scene["colon"].commands["abdomen"]
    assert set(values) == {"stiffness"} and worlds.tolist() == [1]
    assert 2.0e5 <= values["stiffness"].item() <= 5.0e5


def test_every_world_may_have_sheets_of_its_own(env) -> None:
    mdp.randomize_mesentery(env, torch.tensor([0, 1]), fullness=(1.2, 1.3))
    values, _ = env.scene["colon"].commands["mesentery"]
    assert set(values) == {"fullness"} and values["fullness"].shape == (2,)
    assert ((values["fullness"] >= 1.2) & (values["fullness"] <= 1.3)).all()


def test_every_world_may_have_a_friction_of_its_own(env) -> None:
    drawn: dict[str, torch.Tensor] = {}
    env.sim = SimpleNamespace(write_loop_friction=lambda friction, env_ids: drawn.update(value=friction, ids=env_ids))
    mdp.randomize_loop_friction(env, torch.tensor([1]))
    friction, worlds = drawn["value"], drawn["ids"]
    assert 0.034 <= friction.item() <= 0.078 and worlds.tolist() == [1]


def test_a_task_has_a_hand_where_it_is_asked_for() -> None:
    without, pressed = configured(), configured("env.hand_pressure=commanded")
    assert not without.scene.colon.abdomen.enabled and without.actions.hand is None
    assert pressed.scene.colon.abdomen.enabled and pressed.actions.hand.force == 40.0
    assert [name for name, term in vars(pressed.actions).items() if term is not None] == ["base", "hand"]


@pytest.mark.parametrize("override", ["env.scene.colon.wall_model=solid", "env.sim.solver=newton"])
def test_what_a_hand_needs_is_said(override: str) -> None:
    with pytest.raises(ValueError, match=rf"hand_pressure is 'commanded', which needs env\.{override[4:10]}"):
        configured("env.hand_pressure=commanded", override)
