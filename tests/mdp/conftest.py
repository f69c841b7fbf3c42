# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""A stand-in for the environment: tensors that a test sets by hand, no physics."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
import torch

from arcgym.anatomy.segments import SEGMENTS
from arcgym.assets import ColonCfg
from arcgym.utils.world_random import WorldRandom

IDENTITY = [0.0, 0.0, 0.0, 1.0]
ABDOMEN_READOUTS = ("hand_dent", "abdomen_force")
GAS_READOUTS = ("lumen_pressure", "lumen_pressure_mean", "lumen_pressure_peak")
RING_READOUTS = ("wall_strain", "wall_strain_peak", "anchor_tension", "anchor_tension_peak")


class FakeEndoscopeData(SimpleNamespace):
    """Readings that a test sets."""

    @property
    def window_force_norm(self) -> torch.Tensor:
        return self.window_force_w.norm(dim=-1)

    @property
    def tip_force(self) -> torch.Tensor:
        return self.tip_force_w.norm(dim=-1)


class FakeEndoscope:
    """Records commands; its data are plain tensors of two worlds with three windows of force and three links."""

    def __init__(self, num_envs: int, num_links: int) -> None:
        zeros = torch.zeros
        self.commands: dict[str, Any] = {}
        self.data = FakeEndoscopeData(
            tip_arc_length=zeros(num_envs),
            tip_centerline_distance=zeros(num_envs),
            tip_pos_w=zeros(num_envs, 3),
            tip_quat_w=torch.tensor([IDENTITY] * num_envs),
            tip_lin_vel_w=zeros(num_envs, 3),
            tip_ang_vel_w=zeros(num_envs, 3),
            tip_lumen_direction_w=torch.tensor([[0.0, 0.0, 1.0]] * num_envs),
            tip_pull_force_w=zeros(num_envs, 3),
            base_force=zeros(num_envs),
            bending=zeros(num_envs, 2),
            inserted_length=zeros(num_envs),
            window_force_w=zeros(num_envs, 3, 3),
            window_force_peak=zeros(num_envs, 3),
            tip_force_w=zeros(num_envs, 3),
            link_force_w=zeros(num_envs, num_links, 3),
            link_force_peak=zeros(num_envs, num_links),
            tip_force_peak=zeros(num_envs),
            joint_pos=zeros(num_envs, 2 + num_links - 1),
        )

    def actuator(self, name: str) -> SimpleNamespace:
        """Records what its ``set_command`` is given under its name."""
        record = lambda *values: self.commands.update({name: tuple(value.clone() for value in values)})  # noqa: E731
        return SimpleNamespace(set_command=record)

    def turn_tip_target(self, angle: torch.Tensor, env_ids: torch.Tensor) -> None:
        self.commands["turn"] = (angle.clone(), env_ids)

    def write_friction_to_sim(self, mu: torch.Tensor, env_ids: torch.Tensor) -> None:
        self.commands["friction"] = (mu.clone(), env_ids)


class FakeColon:
    """A straight colon along +Z: rectum 0 to 0.1 m, sigmoid 0.1 to 0.5 m."""

    def __init__(self, num_envs: int) -> None:
        arc = torch.linspace(0.0, 0.5, 6)
        points = torch.stack([torch.zeros(6), torch.zeros(6), arc], dim=1)
        spans = torch.tensor([(0.0, 0.1), (0.1, 0.5), *[(0.5, 0.5)] * (len(SEGMENTS) - 2)])
        self.data = SimpleNamespace(
            centerline_arc=arc.repeat(num_envs, 1),
            patient=torch.zeros(num_envs, dtype=torch.int32),
            segment_spans=spans.expand(num_envs, len(SEGMENTS), 2),
            centerline_pos_w=points.expand(num_envs, 6, 3),
            **{name: torch.zeros(num_envs, 6) for name in RING_READOUTS},
            **{name: torch.zeros(num_envs) for name in (*GAS_READOUTS, *ABDOMEN_READOUTS)},
            hand_place=torch.zeros(num_envs, 2),
        )
        self.cfg = ColonCfg()
        self.patients = [SimpleNamespace(name="tube", bounds={"rectum": (0.0, 0.1), "sigmoid": (0.1, 0.5)})]
        self.commands: dict[str, Any] = {}

    def write_patient_to_sim(self, patient: torch.Tensor, env_ids: torch.Tensor) -> None:
        self.commands["patient"] = (patient.clone(), env_ids)

    def require_segment(self, name: str) -> None:
        if name not in ("rectum", "sigmoid"):
            raise ValueError(f"Segment '{name}' is not in colon.usda; it has rectum, sigmoid.")

    def write_stiffness_scale_to_sim(self, scale: torch.Tensor, env_ids: torch.Tensor) -> None:
        self.commands["stiffness"] = (scale.clone(), env_ids)

    def write_material_to_sim(self, modulus: torch.Tensor, ratio: torch.Tensor, env_ids: torch.Tensor) -> None:
        self.commands["material"] = (torch.stack([modulus, ratio], dim=1), env_ids)

    def write_anchor_scale_to_sim(self, scale: torch.Tensor, env_ids: torch.Tensor) -> None:
        self.commands["anchors"] = (scale.clone(), env_ids)

    def write_rigid_to_sim(self, rigid: torch.Tensor, env_ids: torch.Tensor) -> None:
        self.commands["rigid"] = (rigid.clone(), env_ids)

    def write_gas_to_sim(self, env_ids: torch.Tensor, **values: torch.Tensor) -> None:
        self.commands["gas"] = (values, env_ids)

    def write_abdomen_to_sim(self, env_ids: torch.Tensor, **values: torch.Tensor) -> None:
        self.commands["abdomen"] = (values, env_ids)

    def write_mesentery_to_sim(self, env_ids: torch.Tensor, **values: torch.Tensor) -> None:
        self.commands["mesentery"] = (values, env_ids)

    def set_hand_pressure(self, force: torch.Tensor, place: torch.Tensor) -> None:
        self.commands["hand"] = (force.clone(), place.clone())
        self.data.hand_place[:] = place

    def set_gas_flow(self, flow: torch.Tensor) -> None:
        self.commands["flow"] = flow.clone()


class FakeCamera:
    """Images that a test sets."""

    def __init__(self, num_envs: int) -> None:
        image = torch.arange(num_envs * 4 * 6 * 3).reshape(num_envs, 4, 6, 3).to(torch.uint8)
        self.data = SimpleNamespace(output={"rgb": image, "depth": torch.full((num_envs, 4, 6), 0.05)}, frame=1)
        self.commands: dict[str, Any] = {}

    def write_light_gain(self, gain: torch.Tensor, env_ids: torch.Tensor) -> None:
        self.commands["light"] = (gain.clone(), env_ids)

    def write_color_gain(self, gain: torch.Tensor, env_ids: torch.Tensor) -> None:
        self.commands["color"] = (gain.clone(), env_ids)

    def write_texture_offset(self, offset: torch.Tensor, env_ids: torch.Tensor) -> None:
        self.commands["texture"] = (offset.clone(), env_ids)

    def write_preparation(self, scores: torch.Tensor, seed: torch.Tensor, env_ids: torch.Tensor) -> None:
        self.commands["preparation"] = ((scores.clone(), seed.clone()), env_ids)


class FakeEnv:
    """What terms read of an environment: two worlds, three links, 10 Hz."""

    def __init__(self, num_envs: int = 2, num_links: int = 3) -> None:
        self.num_envs, self.device, self.step_dt = num_envs, "cpu", 0.1
        self.common_step_counter, self.max_episode_length = 0, 100
        self.episode_length_buf = torch.zeros(num_envs, dtype=torch.long)
        self.cfg = SimpleNamespace(segment="sigmoid", lumen="paper")
        self.random = WorldRandom(num_envs, "cpu", seed=0)
        self.sim = SimpleNamespace(written_states=0, non_finite=torch.zeros(num_envs, dtype=torch.bool))
        self.scene = {
            "endoscope": FakeEndoscope(num_envs, num_links),
            "colon": FakeColon(num_envs),
            "camera": FakeCamera(num_envs),
        }
        self.action_manager = SimpleNamespace(action=torch.zeros(num_envs, 2), prev_action=torch.zeros(num_envs, 2))

    @property
    def scope(self) -> SimpleNamespace:
        """Data of the endoscope."""
        return self.scene["endoscope"].data


@pytest.fixture
def env() -> FakeEnv:
    """A fresh fake environment."""
    return FakeEnv()
