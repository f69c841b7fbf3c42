# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""A robot driven in a new way, all of it in this file: a thread that pulls the tip's link with a commanded force."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import newton
import numpy as np
import pytest
import torch
import warp as wp
from tiny_sim import TinySim, steps

from arcgym.assets import ActuatorBaseCfg, BaseDriveCfg, BendingDriveCfg, EndoscopeCfg, TipPullCfg
from arcgym.assets.actuators import ActuatorBase
from arcgym.assets.endoscope import Endoscope
from arcgym.managers import ActionTerm, ActionTermCfg
from arcgym.sim import SnapshotSet
from arcgym.sim.snapshot import fingerprint
from arcgym.utils import configclass
from arcgym.utils.configclass import from_dict
from arcgym.utils.hydra import apply_overrides


@wp.kernel
def pull(
    links: int,
    tension: wp.array[float],
    dt: float,
    body_f: wp.array[wp.spatial_vector],
    wound: wp.array[float],
):
    w = wp.tid()
    force = wp.vec3(0.0, 0.0, tension[w])
    tip = (w + 1) * links - 1
    body_f[tip] = body_f[tip] + wp.spatial_vector(force, wp.vec3(0.0))
    wound[w] = wound[w] + dt * tension[w]


@wp.kernel
def add_pull(tension: wp.array[float], weight: float, mean: wp.array[wp.vec3]):
    w = wp.tid()
    mean[w] = mean[w] + weight * wp.vec3(0.0, 0.0, tension[w])


class Thread(ActuatorBase):
    def allocate(self, model: newton.Model, num_envs: int, device: str) -> None:
        self.tension, self.impulse = (wp.zeros(num_envs, dtype=float, device=device) for _ in range(2))
        self.mean = wp.zeros(num_envs, dtype=wp.vec3, device=device)
        self.commands, self.averages = [self.tension], [self.mean]
        self.memory, self.readings = {"impulse": self.impulse}, {"tip_pull_force_w": self.mean}

    def set_command(self, tension: torch.Tensor) -> None:
        wp.to_torch(self.tension).copy_(tension.clamp(max=self.cfg.strength))

    def apply(self, state: newton.State, control: newton.Control, resistance: wp.array, dt: float) -> None:
        inputs = [self.endoscope.num_bodies, self.tension, dt]
        wp.launch(pull, len(self.tension), inputs=inputs, outputs=[state.body_f, self.impulse])

    def record(self, drive_force: wp.array, acceleration: wp.array, weight: float) -> None:
        wp.launch(add_pull, len(self.tension), inputs=[self.tension, weight], outputs=[self.mean])


@configclass
class ThreadCfg(ActuatorBaseCfg):
    class_type: Any = Thread
    strength: float = 1.0


class ThreadAction(ActionTerm):
    def __init__(self, cfg: ActionTermCfg, env: Any) -> None:
        super().__init__(cfg, env)
        self._raw = torch.zeros(env.num_envs, 1)

    action_dim = property(lambda self: 1)
    raw_actions = property(lambda self: self._raw)
    processed_actions = property(lambda self: 0.002 * self._raw)

    def process_actions(self, actions: torch.Tensor) -> None:
        self._raw.copy_(actions)

    def apply_actions(self) -> None:
        self._asset.actuator("thread").set_command(self.processed_actions[:, 0])


@configclass
class ThreadActionCfg(ActionTermCfg):
    class_type: Any = ThreadAction
    asset_name: str = "endoscope"


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    return TinySim(tmp_path_factory.mktemp("own"))


def threaded(tiny: TinySim, **thread: Any):
    sim = tiny("capsule", num_envs=2, scope={"actuators": {"thread": ThreadCfg(**thread)}})
    sim.endoscope.data.joint_pos[:, 2] = 0.1  # clear of the anus
    sim.forward()
    return sim


def test_its_action_moves_the_scope(tiny: TinySim) -> None:
    sim = threaded(tiny)
    env = SimpleNamespace(scene={"endoscope": sim.endoscope}, num_envs=2, device="cpu")
    term = ThreadAction(ThreadActionCfg(), env)
    term.process_actions(torch.tensor([[0.0], [1.0]]))
    term.apply_actions()
    sim.step(2)
    speed = 0.002 / 0.005 * 2 * sim.physics_dt  # 2 mN on 5 g for two steps
    assert sim.endoscope.data.tip_lin_vel_w[:, 2].tolist() == pytest.approx([0.0, speed], rel=1e-3)
    assert sim.endoscope.data.tip_pull_force_w[:, 2].tolist() == pytest.approx([0.0, 0.002])


def test_its_configuration_limits_it(tiny: TinySim) -> None:
    sim = threaded(tiny, strength=0.001)
    sim.endoscope.actuator("thread").set_command(torch.tensor([0.5, 0.0005]))
    assert sim.endoscope.actuator("thread").tension.numpy().tolist() == pytest.approx([0.001, 0.0005])


def test_start_states_keep_what_it_remembers(tiny: TinySim) -> None:
    sim = threaded(tiny)
    sim.endoscope.actuator("thread").set_command(torch.tensor([0.002, 0.002]))
    sim.step(steps(sim, 0.1))
    sim.load_snapshots(SnapshotSet(("pulled",), (sim.read_snapshot(0),), fingerprint(sim)))
    sim.write_snapshot(-1, [0])
    assert sim.world_arrays()["thread.impulse"][:, 0].tolist() == pytest.approx([0.0, 0.0002])
    sim.write_snapshot(0, [0])
    assert sim.world_arrays()["thread.impulse"][:, 0].tolist() == pytest.approx([0.0002, 0.0002])
    assert sim.endoscope.actuator("thread").tension.numpy()[0] == 0.0


def test_two_drives_act_together(tiny: TinySim) -> None:
    sim = tiny("capsule", scope={"actuators": {"first": ThreadCfg(), "second": Silent(class_type=SilentThread)}})
    sim.endoscope.data.joint_pos[:, 2] = 0.1
    sim.forward()
    for name in ("first", "second"):
        sim.endoscope.actuator(name).set_command(torch.tensor([0.001]))
    sim.step(1)
    assert sim.endoscope.data.tip_lin_vel_w[0, 2].item() == pytest.approx(0.002 / 0.005 * sim.physics_dt, rel=1e-3)


class SilentThread(Thread):
    def allocate(self, model: newton.Model, num_envs: int, device: str) -> None:
        super().allocate(model, num_envs, device)
        self.readings = {}


class Silent(ThreadCfg):
    pass


def test_two_drives_that_give_the_same_reading_are_refused(tiny: TinySim) -> None:
    with pytest.raises(ValueError, match="'second' and one before it both give 'tip_pull_force_w'"):
        tiny("capsule", scope={"actuators": {"first": ThreadCfg(), "second": ThreadCfg()}})


@pytest.mark.parametrize(
    ("kind", "drives", "message"),
    [
        ("capsule", {"base": BaseDriveCfg()}, "slide and a roll with stiffness; the root of capsule"),
        ("magnetic", {"base": BaseDriveCfg()}, "slide and a roll with stiffness; the root of magnetic"),
        ("magnetic", {"bending": BendingDriveCfg()}, "bending section, and magnetic_6.usda has none"),
        ("magnetic", {"tip": TipPullCfg(stiffness=0.0)}, "tip.stiffness is 0.0 N/m, expected a number above 0"),
        ("proximal", {"base": BaseDriveCfg(force_limit=-1.0)}, "base.force_limit is -1.0 N"),
        ("proximal", {"bending": BendingDriveCfg(rate=0.0)}, "bending.rate is 0.0 rad/s"),
    ],
)
def test_a_drive_that_does_not_suit_the_stage_is_refused(tiny: TinySim, kind: str, drives: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Endoscope(tiny.scope_cfg(kind, actuators=drives))


def test_a_scope_without_stage_or_drives_is_refused() -> None:
    with pytest.raises(ValueError, match="without a value: usd_path, actuators"):
        Endoscope(EndoscopeCfg())


def test_drives_are_overridden_from_command_line_and_file(tiny: TinySim) -> None:
    cfg = tiny.scope_cfg()
    apply_overrides({"scope": cfg}, ["scope.actuators.base.force_limit=12", "scope.actuators.bending=null"])
    assert cfg.actuators["base"].force_limit == 12.0
    assert list(Endoscope(cfg).actuators) == ["base"]
    from_dict(cfg, {"actuators": {"base": {"torque_limit": 0.5}}})
    assert isinstance(cfg.actuators["base"], BaseDriveCfg) and cfg.actuators["base"].torque_limit == 0.5
    with pytest.raises(ValueError, match="force_limit"):
        apply_overrides({"scope": cfg}, ["scope.actuators.base.force_limitt=12"])


def test_a_scope_without_drives_stays_where_it_is(tiny: TinySim) -> None:
    sim = tiny("proximal", scope={"actuators": {}})
    sim.step(steps(sim, 0.1))
    assert not np.any(sim.endoscope.data.base_force.numpy())
    assert sim.endoscope.data.bending.shape == (1, 2)
