# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Events and curricula on a stand-in environment."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace

import pytest
import torch

from arcgym.envs import mdp
from arcgym.managers import EventTermCfg


class FakeSim:
    """Records written snapshots; has states of its own for the segments ``names``."""

    def __init__(self, names: list[str] | None) -> None:
        self.snapshots = None if names is None else SimpleNamespace(names=names, index=names.index)
        self.written: list[tuple[int, list[int]]] = []

    def load_snapshots(self, snapshots: object) -> None:
        self.snapshots = snapshots

    def write_snapshot(self, index: torch.Tensor, env_ids: torch.Tensor) -> None:
        self.written.append((int(index), env_ids.tolist()))


def make_reset(env, segment: str, names: list[str] | None, folder: Path = Path()):
    env.sim, env.cfg.segment = FakeSim(names), segment
    env.scene["colon"].path, env.scene["endoscope"].path = folder / "colon.usda", folder / "proximal.usda"
    return mdp.reset_to_segment_start(EventTermCfg(func=mdp.reset_to_segment_start, mode="reset"), env)


@pytest.mark.parametrize(
    ("segment", "names", "index"),
    [("sigmoid", ["rectum", "sigmoid"], 1), ("rectum", ["rectum"], 0), ("rectum", ["sigmoid"], -1)],
)
def test_reset_writes_the_snapshot_of_the_segment(env, segment: str, names: list[str], index: int) -> None:
    make_reset(env, segment, names)(env, torch.tensor([1]))
    assert env.sim.written == [(index, [1])]


def test_missing_snapshots_name_the_tool(env, tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="snapshots/proximal.npz.*make_snapshots"):
        make_reset(env, "sigmoid", None, tmp_path)


def test_the_first_segment_starts_from_rest_without_snapshots(env, tmp_path: Path) -> None:
    make_reset(env, "rectum", None, tmp_path)(env, torch.tensor([0]))
    assert env.sim.written == [(-1, [0])]


def make_perturbation(env, joint_names: list[str], bending_links: int):
    scope = env.scene["endoscope"]
    scope.joint_names, scope.stage = joint_names, SimpleNamespace(bending_links=bending_links)
    scope.data.joint_pos = torch.zeros(2, len(joint_names))
    return mdp.perturb_tip(EventTermCfg(func=mdp.perturb_tip, mode="reset", params={"hinges": 3}), env)


def test_perturbation_is_shared_among_the_last_hinges(env) -> None:
    term = make_perturbation(env, ["slide", "roll", "hinge_1", "hinge_2", "hinge_3", "hinge_4"], bending_links=3)
    term(env, torch.tensor([1]), std=0.2)
    pitch, yaw = env.scope.bending[1].tolist()
    # Of hinges 2, 3, 4 only 3 is odd (pitch); 2 and 4 share the yaw.
    expected = torch.tensor([0.0, 0.0, 0.0, 0.5 * yaw, pitch, 0.5 * yaw])
    torch.testing.assert_close(env.scope.joint_pos[1], expected)
    assert pitch != 0.0 and not env.scope.joint_pos[0].any() and not env.scope.bending[0].any()


def test_a_passive_scope_is_bent_without_a_command(env) -> None:
    term = make_perturbation(env, ["slide", "roll", "hinge_1", "hinge_2"], bending_links=0)
    term(env, torch.tensor([0]))
    assert env.scope.joint_pos[0, 2:].all() and not env.scope.bending.any()


def test_a_capsule_is_turned_whole(env) -> None:
    names = ["pos_x", "pos_y", "pos_z", "quat_x", "quat_y", "quat_z", "quat_w"]
    term = make_perturbation(env, names, bending_links=0)
    env.scope.joint_pos[:, 6] = 1.0
    term(env, torch.tensor([1]), std=0.2)
    quat = env.scope.joint_pos[1, 3:]
    assert quat.norm().item() == pytest.approx(1.0) and quat[2] == 0.0 and quat[0] != 0.0
    assert env.scope.joint_pos[0, 3:].tolist() == [0.0, 0.0, 0.0, 1.0]


@pytest.mark.parametrize(
    ("name", "entity", "command", "shape", "bounds"),
    [
        ("randomize_light", "camera", "light", (1,), (0.7, 1.4)),
        ("randomize_color", "camera", "color", (1, 3), (0.9, 1.1)),
        ("randomize_texture", "camera", "texture", (1, 2), (0.0, 1.0)),
        ("randomize_tissue_stiffness", "colon", "stiffness", (1,), (0.5, 2.0)),
        ("randomize_friction", "endoscope", "friction", (1,), (0.05, 0.2)),
    ],
)
def test_randomisation_stays_in_its_bounds(env, name, entity, command, shape, bounds) -> None:
    worlds = torch.tensor([1])
    getattr(mdp, name)(env, worlds)
    value, env_ids = env.scene[entity].commands[command]
    assert value.shape == shape and env_ids is worlds
    assert bool((value >= bounds[0]).all()) and bool((value <= bounds[1]).all())


def test_log_uniform_has_its_median_at_the_geometric_mean(env) -> None:
    torch.manual_seed(0)
    mdp.randomize_tissue_stiffness(env, torch.arange(2001), scale=(0.25, 4.0))
    value, _ = env.scene["colon"].commands["stiffness"]
    assert math.log(value.median().item()) == pytest.approx(0.0, abs=0.1)


def test_tissue_is_one_of_the_presets_in_each_world(env) -> None:
    mdp.randomize_tissue(env, torch.arange(200), presets=("soft_nu045", "paper"))
    value, _ = env.scene["colon"].commands["material"]
    assert {(round(e), round(nu, 2)) for e, nu in value.tolist()} == {(500_000, 0.45), (5_000_000, 0.49)}


def test_anchors_are_one_of_the_scales_in_each_world(env) -> None:
    mdp.randomize_anchors(env, torch.arange(200))
    value, _ = env.scene["colon"].commands["anchors"]
    assert set(value.tolist()) == {0.25, 1.0, 4.0}


@pytest.mark.parametrize("probability", [0.0, 1.0])
def test_rigidity_has_its_probability(env, probability: float) -> None:
    mdp.randomize_rigidity(env, torch.arange(20), probability=probability)
    value, _ = env.scene["colon"].commands["rigid"]
    assert value.dtype == torch.bool and value.float().mean().item() == probability


def test_widen_reset_moves_linearly(env) -> None:
    cfg = EventTermCfg(func=mdp.perturb_tip, mode="reset", params={"std": 0.0})
    env.event_manager = SimpleNamespace(get_term_cfg={"aim": cfg}.get)
    values = []
    for env.common_step_counter in (0, 500, 2000):
        values.append(
            mdp.widen_reset(env, torch.tensor([0]), event="aim", param="std", start=0.1, end=0.3, num_steps=1000)
        )
    assert values == pytest.approx([0.1, 0.2, 0.3]) and cfg.params["std"] == pytest.approx(0.3)
