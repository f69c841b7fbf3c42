# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Bounds of every number that the command line can reach, one case a bound, and a walk that finds those without."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator
from typing import Any, Literal, get_args, get_origin

import pytest

import arcgym_tasks  # noqa: F401
from arcgym.assets import PROXIMAL_CFG
from arcgym.envs import mdp
from arcgym.managers import CurriculumTermCfg, EventTermCfg, ObservationTermCfg
from arcgym.managers.noise import ConstantNoiseCfg, GaussianNoiseCfg, UniformNoiseCfg
from arcgym.rl.agent_cfgs.a2c import RslRlA2cAlgorithmCfg
from arcgym.rl.agent_cfgs.image_models import RecurrentCnnModelCfg
from arcgym.rl.agent_cfgs.ppo_lagrangian import AscentMultiplierCfg, FixedPenaltyCfg, RslRlPpoLagrangianAlgorithmCfg
from arcgym.rl.agent_cfgs.sac import RslRlSacRunnerCfg
from arcgym.rl.model_cfg import BetaDistributionCfg
from arcgym.utils.coerce import field_types, is_config
from arcgym.utils.configclass import validate
from arcgym.utils.hydra import apply_overrides
from arcgym.utils.registry import load_cfg_from_registry

TASK = "ARC-Splenic-Magnetic"

ANY_NUMBER = {
    "weight": "rewards and penalties of any size; zero skips the term",
    "concatenate_dim": "an axis, counted from either end",
    "bias": "an offset in the unit of its observation",
    "mean": "an offset in the unit of its observation",
    "n_min": "in the unit of its observation; only the order counts",
    "n_max": "in the unit of its observation; only the order counts",
    "clip": "in the unit of its observation; only the order counts",
    "scale": "a factor of any sign and size",
    "gravity": "a direction and any strength, zero by default",
    "azimuth": "an angle; whole turns do not matter",
    "action_range": "raw actions may be scaled to anything; only the order counts",
    "target_entropy": "an entropy of densities has either sign",
}
"""Numbers without a bound, and the reason. They must be finite all the same."""

CASES = [
    ("env.sim.dt=-0.01", "env.sim.dt is -0.01 s, expected a number above 0 and at most 0.0166667 s"),
    ("env.sim.dt=0.5", "env.sim.dt is 0.5 s"),
    ("env.sim.device=tpu", "env.sim.device is 'tpu', expected 'cpu', 'cuda' or 'cuda:<number>'"),
    ("env.sim.scope_substeps=0", "env.sim.scope_substeps is 0, expected a number at least 1"),
    ("env.sim.solver=foo", "'env.sim.solver' expects"),
    ("env.sim.contact.friction=-0.1", "env.sim.contact.friction is -0.1"),
    ("env.sim.contact.stiffness=0", "env.sim.contact.stiffness is 0.0 N/m"),
    ("env.sim.wall.iterations=0", "env.sim.wall.iterations is 0"),
    ("env.decimation=0", "env.decimation is 0"),
    ("env.seed=-2", "env.seed is -2"),
    ("env.episode_length_s=0", "env.episode_length_s is 0.0 s"),
    ("env.scene.num_envs=0", "env.scene.num_envs is 0, expected a number at least 1"),
    ("env.scene.num_envs=-3", "env.scene.num_envs is -3"),
    ("env.scene.camera.width=0", "env.scene.camera.width is 0 px"),
    (
        "env.scene.camera.data_types=[rgb,deep]",
        "camera.data_types is 'deep'. Did you mean 'depth'? Available: depth, rgb",
    ),
    ("env.scene.camera.exposure.lag=1", "env.scene.camera.exposure.lag is 1.0, expected a number at least 0 and below"),
    ("env.scene.camera.exposure.gain_range=[2,1]", "gain_range is (2.0, 1.0), expected the smaller number first"),
    ("env.scene.camera.lighting.beam=2", "env.scene.camera.lighting.beam is 2.0"),
    ("env.scene.colon.material=papper", "env.scene.colon.material is 'papper'. Did you mean 'paper'"),
    ("env.scene.colon.poissons_ratio=0.5", "env.scene.colon.poissons_ratio is 0.5"),
    ("env.scene.colon.anchor_slack={sigmoyd: 0.1}", "anchor_slack names 'sigmoyd'. Did you mean 'sigmoid'"),
    ("env.scene.endoscope.actuators.tip.damping=-1", "env.scene.endoscope.actuators.tip.damping is -1.0 N s/m"),
    ("env.segment=cecun", "env.segment is 'cecun'. Did you mean 'cecum'"),
    ("env.lumen=metrik", "'env.lumen': There is no lumen preset 'metrik'. Did you mean 'metric'"),
    ("env.lumen.tau_wall=0.1", "env.lumen.tau_lumen is 0.02 m, but tau_wall (0.1 m) < tau_lumen"),
    ("env.force_tiers.comfort=9", "comfort (9.0 N) < unsafe (5.0 N)"),
    ("env.rewards.shaft_force.params.limit=comfy", "shaft_force.params.limit is 'comfy'. Did you mean 'comfort'"),
    (
        "env.rewards.shaft_force.params.kind=shaf_force",
        "shaft_force.params.kind is 'shaf_force'. Did you mean 'shaft_force'",
    ),
    ("env.terminations.stuck.params.window_s=0", "env.terminations.stuck.params.window_s is 0.0"),
    ("env.events.friction.params.friction=[0,1]", "env.events.friction.params.friction is 0"),
    ("env.costs.tip_force.weight=-1", "env.costs.tip_force.weight is -1.0"),
    ("env.viewer.env_id=64", "env.viewer.env_id is 64, but scene.num_envs is 64"),
    ("agent.num_steps_per_env=0", "agent.num_steps_per_env is 0"),
    ("agent.max_iterations=-1", "agent.max_iterations is -1"),
    ("agent.logger=wandbb", "agent.logger is 'wandbb'. Did you mean 'wandb'"),
    ("agent.algorithm.gamma=1.5", "agent.algorithm.gamma is 1.5"),
    ("agent.algorithm.schedule=adaptiv", "agent.algorithm.schedule is 'adaptiv'. Did you mean 'adaptive'"),
    ("agent.actor.activation=eluu", "agent.actor.activation is 'eluu'. Did you mean 'elu'"),
    ("agent.actor.cnn_cfg.stride=[4,2]", "agent.actor.cnn_cfg.stride has 2 entries, expected 3"),
    ("agent.critic.hidden_dims=[0]", "agent.critic.hidden_dims is 0"),
]
"""An override and the message it gets."""


def configurations() -> dict[str, Any]:
    """Return ``env`` and ``agent`` of a task."""
    entries = {"env": "env_cfg_entry_point", "agent": "rsl_rl_cfg_entry_point"}
    return {name: load_cfg_from_registry(TASK, entry) for name, entry in entries.items()}


def everything() -> dict[str, Any]:
    """Return a task's configurations with all that the command line may switch on, and those of other robots."""
    cfgs = configurations()
    env = cfgs["env"]
    env.recorders = mdp.TrajectoryRecorderCfg(images=mdp.PostStepImagesRecorderCfg())
    env.curriculum = {"aim": CurriculumTermCfg(func=mdp.move_param, params={"num_steps": 10})}
    env.events.interval = EventTermCfg(func=mdp.perturb_tip, mode="interval", interval_range_s=(1.0, 2.0))
    noises = (ConstantNoiseCfg(), GaussianNoiseCfg(), UniformNoiseCfg())
    env.observations.critic.terms = {
        str(i): ObservationTermCfg(func=mdp.tip_progress, noise=noise) for i, noise in enumerate(noises)
    }
    sac, lagrangian = RslRlSacRunnerCfg(), RslRlPpoLagrangianAlgorithmCfg(limits={"tip_force": 1.0})
    agents = (sac, lagrangian, RslRlA2cAlgorithmCfg(), RecurrentCnnModelCfg(), BetaDistributionCfg())
    actions = (mdp.InsertionActionCfg(), mdp.GasFlowActionCfg(), mdp.HandPressureActionCfg())
    others = (*agents, AscentMultiplierCfg(), FixedPenaltyCfg(), PROXIMAL_CFG, *actions)
    return cfgs | {f"other{i}": cfg for i, cfg in enumerate(others)}


def numeric_fields(cfg: Any, path: str) -> Iterator[tuple[Any, str, str]]:
    """Yield owner, name and path of every field that holds numbers, in everything nested in ``cfg``."""
    if is_config(cfg):
        for name, value in vars(cfg).items():
            if holds_numbers(field_types(type(cfg)).get(name)):
                yield cfg, name, f"{path}.{name}"
            else:
                yield from numeric_fields(value, f"{path}.{name}")
    elif isinstance(cfg, dict):
        for name, value in cfg.items():
            yield from numeric_fields(value, f"{path}.{name}")


def holds_numbers(declared: Any) -> bool:
    if get_origin(declared) is Literal:
        return False
    return declared in (int, float) or any(holds_numbers(part) for part in get_args(declared))


def filled(declared: Any, number: float) -> Any:
    """Return a value of the declared type in which every number is ``number``."""
    if declared in (int, float):
        return declared(number)
    origin, parts = get_origin(declared), get_args(declared)
    if origin is tuple:
        return tuple(filled(part, number) for part in parts if part is not Ellipsis)
    if origin is list:
        return [filled(parts[0], number)]
    if origin is dict:
        return {"sigmoid": filled(parts[1], number)}
    return filled(next(part for part in parts if holds_numbers(part)), number)


def is_refused(owner: Any, name: str, value: Any) -> bool:
    changed = copy.deepcopy(owner)
    setattr(changed, name, value)
    try:
        validate(changed)
    except ValueError as error:
        assert name in str(error)
        return True
    return False


def test_all_that_can_be_switched_on_passes() -> None:
    for name, cfg in everything().items():
        validate(cfg, name)


def test_every_number_has_a_bound_or_a_reason() -> None:
    owners = {
        (type(owner), name): (owner, path)
        for root, cfg in everything().items()
        for owner, name, path in numeric_fields(cfg, root)
    }
    unbounded, infinite = [], []
    for (kind, name), (owner, path) in owners.items():
        declared = field_types(kind)[name]
        if name not in ANY_NUMBER and not any(is_refused(owner, name, filled(declared, x)) for x in (-1e9, 1e9)):
            unbounded.append(path)
        if "float" in str(declared) and not is_refused(owner, name, filled(declared, math.inf)):
            infinite.append(path)
    assert len(owners) > 100
    assert unbounded == [] and infinite == []


@pytest.mark.parametrize(("override", "message"), CASES)
def test_a_value_out_of_bounds_is_named(override: str, message: str) -> None:
    cfgs = configurations()
    with pytest.raises((TypeError, ValueError)) as error:
        apply_overrides(cfgs, [override])
        for name, cfg in cfgs.items():
            validate(cfg, name)
    assert message in str(error.value) and "\n" not in str(error.value)


def test_a_preset_may_be_named_and_changed() -> None:
    cfgs = configurations()
    apply_overrides(cfgs, ["env.lumen=metric", "env.lumen.far=0.2"])
    lumen = cfgs["env"].lumen
    assert (lumen.mix, lumen.far) == (mdp.METRIC.mix, 0.2) and mdp.METRIC.far == 0.1
