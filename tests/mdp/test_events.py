# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Events and curricula on a stand-in environment."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest
import torch

from arcgym.envs import mdp
from arcgym.envs.mdp import events
from arcgym.managers import EventTermCfg
from arcgym.utils.world_random import WorldRandom


class FakeSim:
    """Records written snapshots; has states of its own for the segments ``names``."""

    def __init__(self, names: list[str] | None) -> None:
        self.snapshots = None if names is None else SimpleNamespace(names=names, index=names.index)
        self.written: list[tuple[int, list[int]]] = []

    def load_snapshots(self, snapshots: list[object]) -> None:
        self.snapshots = snapshots[0]

    def write_snapshot(self, index: torch.Tensor, env_ids: torch.Tensor) -> None:
        self.written.append((int(index), env_ids.tolist()))


def make_reset(env, segment: str, names: list[str] | None, **params: str):
    env.sim, env.cfg.segment = FakeSim(names), segment
    cfg = EventTermCfg(func=mdp.reset_to_segment_start, mode="reset", params=params)
    return mdp.reset_to_segment_start(cfg, env)


@pytest.mark.parametrize(
    ("segment", "names", "index"), [("sigmoid", ["rectum", "sigmoid"], 1), ("rectum", ["rectum"], 0)]
)
def test_reset_writes_the_snapshot_of_the_segment(env, segment: str, names: list[str], index: int) -> None:
    make_reset(env, segment, names)(env, torch.tensor([1]))
    assert env.sim.written == [(index, [1])]


def test_missing_start_states_are_made(env, monkeypatch: pytest.MonkeyPatch) -> None:
    names = ["rectum", "sigmoid"]
    made = SimpleNamespace(names=names, index=names.index)
    monkeypatch.setattr(events, "ensure_all", lambda scene, segment: [made])
    make_reset(env, "sigmoid", None)(env, torch.tensor([1]))
    assert env.sim.written == [(1, [1])] and env.sim.snapshots is made


def test_the_first_segment_starts_from_rest_without_snapshots(env, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(events, "find_stored", lambda scene, segment, patient: None)
    make_reset(env, "rectum", ["sigmoid"])(env, torch.tensor([0]))
    assert env.sim.written == [(-1, [0])]


@pytest.mark.parametrize("by", ["task", "term"])
def test_an_episode_may_begin_at_rest_whatever_the_segment(env, by: str) -> None:
    env.cfg.start = "rest" if by == "task" else "segment"
    params = {"start": "rest"} if by == "term" else {}
    make_reset(env, "sigmoid", ["sigmoid"], **params)(env, torch.tensor([0]))
    assert env.sim.written == [(-1, [0])]


@pytest.fixture
def many(env):
    """The same with the random numbers of 2001 worlds."""
    env.random = WorldRandom(2001, "cpu", seed=0)
    return env


def test_perturbation_turns_the_target_within_two_deviations(many) -> None:
    mdp.perturb_tip(many, torch.arange(200), std=0.2)
    angle, env_ids = many.scene["endoscope"].commands["turn"]
    assert angle.shape == (200, 3) and env_ids.tolist() == list(range(200))
    assert angle.abs().amax().item() == pytest.approx(0.4) and angle.std().item() == pytest.approx(0.2, rel=0.15)


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
def test_randomization_stays_in_its_bounds(env, name, entity, command, shape, bounds) -> None:
    worlds = torch.tensor([1])
    getattr(mdp, name)(env, worlds)
    value, env_ids = env.scene[entity].commands[command]
    assert value.shape == shape and env_ids is worlds
    assert bool((value >= bounds[0]).all()) and bool((value <= bounds[1]).all())


def test_preparation_is_scored_as_often_as_published(many) -> None:
    mdp.randomize_preparation(many, torch.arange(2001))
    (scores, seed), env_ids = many.scene["camera"].commands["preparation"]
    total = scores.sum(dim=1)
    assert scores.shape == (2001, 3) and seed.shape == (2001,) and env_ids.tolist() == list(range(2001))
    assert int(scores.min()) == 1 and int(scores.max()) == 3
    assert (scores.amax(dim=1) - scores.amin(dim=1)).max() == 1
    shares = [float((total == each).float().mean()) for each in (5, 6)] + [float((total >= 7).float().mean())]
    assert shares == pytest.approx([0.1, 0.2, 0.7], abs=0.03)
    assert float((total == 8).float().mean()) == pytest.approx(0.7 / 3, abs=0.03)


def test_shares_of_preparations_sum_up_to_one(env) -> None:
    with pytest.raises(ValueError, match=r"shares are \(0.1, 0.2, 0.6\), expected three that sum up to 1"):
        mdp.randomize_preparation(env, torch.arange(2), shares=(0.1, 0.2, 0.6))


@pytest.mark.parametrize(
    ("name", "entity", "command", "bounds"),
    [
        ("randomize_light", "camera", "light", {"gain": (2.0, 2.0)}),
        ("randomize_tissue_stiffness", "colon", "stiffness", {"scale": (2.0, 2.0)}),
        ("randomize_friction", "endoscope", "friction", {"friction": (2.0, 2.0)}),
    ],
)
def test_what_is_drawn_may_be_multiplied(env, name, entity, command, bounds) -> None:
    getattr(mdp, name)(env, torch.tensor([0]), **bounds, factor=1.5)
    assert float(env.scene[entity].commands[command][0]) == pytest.approx(3.0)


def test_log_uniform_has_its_median_at_the_geometric_mean(many) -> None:
    mdp.randomize_tissue_stiffness(many, torch.arange(2001), scale=(0.25, 4.0))
    value, _ = many.scene["colon"].commands["stiffness"]
    assert math.log(value.median().item()) == pytest.approx(0.0, abs=0.1)


def test_tissue_is_one_of_the_presets_in_each_world(many) -> None:
    mdp.randomize_tissue(many, torch.arange(200), presets=("soft_nu045", "paper"))
    value, _ = many.scene["colon"].commands["material"]
    assert {(round(e), round(nu, 2)) for e, nu in value.tolist()} == {(500_000, 0.45), (5_000_000, 0.49)}


def test_anchors_are_one_of_the_scales_in_each_world(many) -> None:
    mdp.randomize_anchors(many, torch.arange(200))
    value, _ = many.scene["colon"].commands["anchors"]
    assert set(value.tolist()) == {0.5, 1.0, 1.75}


@pytest.mark.parametrize("probability", [0.0, 1.0])
def test_rigidity_has_its_probability(env, probability: float) -> None:
    mdp.randomize_rigidity(env, torch.arange(20), probability=probability)
    value, _ = env.scene["colon"].commands["rigid"]
    assert value.dtype == torch.bool and value.float().mean().item() == probability


def test_a_parameter_moves_linearly(env) -> None:
    cfg = EventTermCfg(func=mdp.perturb_tip, mode="reset", params={"std": 0.0})
    env.event_manager = SimpleNamespace(get_term_cfg={"aim": cfg}.get)
    values = []
    for env.common_step_counter in (0, 500, 2000):
        values.append(mdp.move_param(env, torch.tensor([0]), "event", "aim", "std", start=0.1, end=0.3, num_steps=1000))
    assert values == pytest.approx([0.1, 0.2, 0.3]) and cfg.params["std"] == pytest.approx(0.3)


def test_every_patient_is_drawn_about_as_often(env) -> None:
    colon = env.scene["colon"]
    mdp.randomize_patient(env, torch.arange(2))
    assert "patient" not in colon.commands
    colon.patients = colon.patients * 3
    counts = torch.zeros(3)
    for _ in range(300):
        env.random.begin(torch.arange(2))
        mdp.randomize_patient(env, torch.arange(2))
        patient, env_ids = colon.commands["patient"]
        assert env_ids.tolist() == [0, 1]
        counts += patient.bincount(minlength=3)
    assert bool((counts > 150).all()) and int(counts.sum()) == 600


def test_patients_in_which_episodes_fail_come_more_often(env) -> None:
    worlds, colon = torch.arange(2), env.scene["colon"]
    colon.patients = colon.patients * 3
    cfg = EventTermCfg(func=mdp.randomize_patient_by_failures, mode="reset")
    draw = mdp.randomize_patient_by_failures(cfg, env)
    ends = SimpleNamespace(dones=torch.zeros(2, dtype=torch.bool), success=torch.zeros(2, dtype=torch.bool))
    env.termination_manager = ends
    counts = torch.zeros(3)
    for episode in range(700):
        env.random.begin(worlds)
        draw(env, worlds)
        patient, env_ids = colon.commands["patient"]
        assert env_ids.tolist() == [0, 1]
        colon.data.patient[:] = patient
        ends.dones, ends.success = torch.tensor([True, True]), patient != 1
        counts += patient.bincount(minlength=3) * (episode >= 100)
    assert draw.failures[1] > 0.99 and bool((draw.failures[[0, 2]] < 0.01).all())
    assert counts[1] / counts.sum() == pytest.approx(0.75, abs=0.05)  # 1.2 of 1.2 + 0.2 + 0.2


def test_worlds_that_are_reset_from_outside_are_no_failures(env) -> None:
    env.scene["colon"].patients *= 2
    draw = mdp.randomize_patient_by_failures(EventTermCfg(func=mdp.randomize_patient_by_failures, mode="reset"), env)
    none = torch.zeros(2, dtype=torch.bool)
    env.termination_manager = SimpleNamespace(dones=none, success=none)
    draw.failures = torch.tensor([0.3, 0.6])
    draw(env, torch.arange(2))
    assert draw.failures.tolist() == pytest.approx([0.3, 0.6])


def test_start_states_of_every_patient_are_loaded(env, monkeypatch: pytest.MonkeyPatch) -> None:
    env.scene["colon"].patients *= 2
    one = SimpleNamespace(only=lambda names: SimpleNamespace(names=names, index=names.index))
    made = [one, one]
    monkeypatch.setattr(events, "ensure_all", lambda scene, segment: made)
    make_reset(env, "sigmoid", None)(env, torch.tensor([1]))
    assert env.sim.written == [(0, [1])] and env.sim.snapshots.names == ["sigmoid"]
