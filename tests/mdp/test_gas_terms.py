# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Gas as action, observation, load and event, and how a task asks for it."""

from __future__ import annotations

import pytest
import torch

import arcgym_tasks  # noqa: F401
from arcgym.envs import mdp
from arcgym.managers import MetricsManager
from arcgym.utils.configclass import validate
from arcgym.utils.hydra import apply_overrides
from arcgym.utils.registry import load_cfg_from_registry

TASK = "ARC-Sigmoid-Proximal"


def configured(*overrides: str):
    cfg = load_cfg_from_registry(TASK, "env_cfg_entry_point")
    apply_overrides({"env": cfg}, list(overrides))
    validate(cfg)
    cfg.resolve()
    return cfg


def test_insufflation_and_suction_have_scales_of_their_own(env) -> None:
    term = mdp.GasFlowAction(mdp.GasFlowActionCfg(insufflation=1.5, suction=3.0), env)
    assert (term.action_dim, term.axis_names, term.axis_units) == (1, ["insufflation"], ["l/min"])
    term.process_actions(torch.tensor([[0.5], [-2.0]]))
    term.apply_actions()
    # Half of 1.5 l/min, and 3 l/min out, in m^3/s.
    torch.testing.assert_close(env.scene["colon"].commands["flow"], torch.tensor([0.75, -3.0]) * 1.0e-3 / 60.0)
    assert term.commanded_actions().tolist() == [[0.0], [0.0]]


def test_pressure_is_seen_over_that_of_the_image(env) -> None:
    env.scene["colon"].data.lumen_pressure[:] = torch.tensor([20.0, 40.0]) * 133.322
    torch.testing.assert_close(mdp.lumen_pressure(env), torch.tensor([[1.0], [2.0]]))


def test_a_pressure_at_which_a_cecum_ruptured_costs(env) -> None:
    env.scene["colon"].data.lumen_pressure_mean[:] = torch.tensor([80.0, 82.0]) * 133.322
    cost = configured("env.gas=present").costs.lumen_pressure
    assert mdp.load_above(env, **cost.params).tolist() == [False, True]


def test_pressures_of_an_episode(env) -> None:
    """The mean of the steps' means, and the largest physics step of any of them."""
    metrics = configured("env.gas=present").metrics
    terms = {name: getattr(metrics, name) for name in ("mean_lumen_pressure", "max_lumen_pressure")}
    manager, data = MetricsManager(terms, env), env.scene["colon"].data
    manager.reset()
    for mean, peak in ((1000.0, 1100.0), (1400.0, 2000.0), (1200.0, 1250.0)):
        data.lumen_pressure_mean[:] = torch.tensor([mean, 500.0])
        data.lumen_pressure_peak[:] = torch.tensor([peak, 500.0])
        manager.compute()
    manager.reset()
    found = {name: values.tolist() for name, values in manager.finished.items()}
    assert found == {"mean_lumen_pressure": [1200.0, 500.0], "max_lumen_pressure": [2000.0, 500.0]}


def test_every_world_may_have_a_belly_of_its_own(env) -> None:
    mdp.randomize_gas(env, torch.tensor([1]), abdominal_pressure=(600.0, 1600.0), leak_conductance=(0.0, 1.0e-9))
    values, worlds = env.scene["colon"].commands["gas"]
    assert set(values) == {"abdominal_pressure", "leak_conductance"} and worlds.tolist() == [1]
    assert 600.0 <= values["abdominal_pressure"].item() <= 1600.0 and 0.0 <= values["leak_conductance"].item() <= 1.0e-9


def test_a_task_has_gas_where_it_is_asked_for() -> None:
    none, present, commanded = (configured(f"env.gas={name}") for name in ("none", "present", "commanded"))
    assert not none.scene.colon.gas.enabled and none.actions.gas is None and none.metrics.max_lumen_pressure is None
    assert present.scene.colon.gas.enabled and present.actions.gas is None
    assert present.metrics.max_lumen_pressure.params == {"kind": "lumen_pressure", "reduce": "peak"}
    on = [name for name, term in vars(commanded.actions).items() if term is not None]
    assert on == ["base", "gas"] and commanded.actions.gas.insufflation == 1.5
    assert configured("env.gas=commanded", "env.actions.gas=null").actions.gas is not None  # null leaves it to env.gas


def test_a_solid_wall_has_no_gas() -> None:
    with pytest.raises(ValueError, match="env.scene.colon.wall_model=shell"):
        configured("env.gas=present", "env.scene.colon.wall_model=solid")
