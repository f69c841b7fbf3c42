# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The soak: actions, findings, exit status. A fake environment stands for the simulation."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import torch
import warp as wp

from arcgym.benchmarks.lumen import LumenCheck, below_opening
from arcgym.benchmarks.soak.adversaries import KINDS, OVERDRIVE, Adversaries
from arcgym.benchmarks.soak.isolation import ResetGuard, different
from arcgym.benchmarks.soak.journal import Journal, Tally
from arcgym.benchmarks.soak.piercing import Piercing
from arcgym.benchmarks.soak.session import growth
from arcgym.cli.main import main

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "scripts" / "benchmarks"
TASK = "ARC-Sigmoid-Capsule"


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(FOLDER / "soak.py"), *arguments]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60)


@pytest.mark.parametrize(
    ("arguments", "hint"),
    [
        (["--robots", "capsul"], "ARC-Sigmoid-Capsule"),
        (["--steps", "0"], "0 is too small, expected 1 or more"),
        (["--resume", "nowhere.jsonl"], "nowhere.jsonl: there is no such file"),
        (["env.sim.contact.frction=0.2"], "friction"),
    ],
)
def test_mistake_ends_before_anything_is_built(arguments, hint):
    result = run(*arguments)
    assert result.returncode == 2
    assert hint in result.stderr
    assert "Traceback" not in result.stderr


def test_old_findings_are_not_overwritten(tmp_path):
    (tmp_path / "soak.jsonl").touch()
    result = run("--out", str(tmp_path / "soak.jsonl"))
    assert result.returncode == 2
    assert "--resume" in result.stderr


def adversaries(num_envs: int = 16):
    return Adversaries(num_envs, 4, forward=0, step_dt=0.1, device="cpu", seed=3)


def test_actions_repeat_with_the_seed_and_keep_their_limits():
    first, second = adversaries(), adversaries()
    idle = torch.zeros(16), torch.zeros(16, dtype=torch.bool)
    for _ in range(60):
        actions = first.act(*idle)
        assert torch.equal(actions, second.act(*idle))
    size = actions.abs().amax(dim=1)
    over = first.kind == KINDS.index("overdrive")
    assert torch.all(size[over] == OVERDRIVE)
    assert torch.all(size[~over] <= 1.0)


def test_push_goes_forwards_and_seek_force_turns_when_the_force_falls():
    worlds = adversaries(8)
    held, never = torch.zeros(8, 4), torch.zeros(8, dtype=torch.bool)
    seeker, turned = KINDS.index("seek_force"), []
    for force in (1.0, 2.0, 3.0, 2.0, 1.0, 0.5, 0.4):
        before, held = held, worlds.act(torch.full((8,), force), never)
        assert held[KINDS.index("push"), 0] == held[seeker, 0] == 1.0
        turned.append(not torch.equal(held[seeker], before[seeker]))
    assert not any(turned[1:3])
    assert any(turned[3:])


def test_difference_names_the_worlds_and_takes_nan_as_equal():
    one = {"q": torch.tensor([[1.0], [float("nan")], [3.0]])}
    other = {"q": torch.tensor([[1.0], [float("nan")], [3.0000002]])}
    assert different(one, other).tolist() == [False, False, True]


def test_contacts_that_were_missed_or_found_no_room_are_violations():
    total = Tally(contact_samples=1, touching_pairs=5)
    total.add(Tally(contact_samples=1, touching_pairs=4, missed_contacts=1, dropped_contacts=2))
    assert total.violations(growth_mib=1.0) == ["2 contacts found no room", "1 of 9 pairs that touch were missed"]


def test_ends_that_no_perforating_force_explains_are_told_from_others() -> None:
    """Forces are those before the reset; one of an earlier step does not count."""
    tip, windows = torch.tensor([3.0, 20.0, 3.0, 3.0]), torch.tensor([[4.0], [4.0], [15.0], [15.0]])
    data = SimpleNamespace(tip_force_peak=tip, window_force_peak=windows)
    ended = torch.tensor([True, True, True, False])
    terminations = SimpleNamespace(active_terms=["wall_penetrated"], get_term=lambda name: ended)
    scene = {"endoscope": SimpleNamespace(data=data)}
    env = SimpleNamespace(num_envs=4, device="cpu", cfg=None, scene=scene, termination_manager=terminations)
    piercing = Piercing(env)
    piercing.before_reset()
    tip[:], windows[:] = 0.0, 0.0  # as a reset leaves them
    assert piercing.look().tolist() == [True, False, False, False]
    assert (int(piercing.ends), int(piercing.light_ends)) == (3, 1)
    ended[:] = torch.tensor([False, False, False, True])
    assert piercing.look().tolist() == [False, False, False, True]
    assert (int(piercing.ends), int(piercing.light_ends)) == (4, 2)


class LeakySim:
    """Two numbers a world; a reset of any world can also move the last one."""

    def __init__(self, leaks: bool) -> None:
        self.q, self.leaks = torch.ones(3, 2), leaks

    def world_arrays(self) -> dict[str, torch.Tensor]:
        return {"q": self.q}

    def reset(self, env_ids: torch.Tensor) -> None:
        self.q[env_ids] = 0.0
        if self.leaks:
            self.q[-1] += 1.0


@pytest.mark.parametrize("leaks", [False, True])
def test_guard_finds_worlds_that_another_reset_changed(leaks):
    sim = LeakySim(leaks)
    env = SimpleNamespace(device="cpu", sim=sim, _reset_idx=sim.reset)
    before = float(sim.q[0].sum())
    guard, calls = ResetGuard(env), []
    guard.before = lambda: calls.append(float(sim.q[0].sum()))
    with guard.watch():
        env._reset_idx(torch.tensor([0]))
    assert (int(guard.resets), int(guard.disturbed)) == (1, int(leaks))
    assert env._reset_idx == sim.reset
    assert calls == [before]


@pytest.mark.parametrize(("half_length", "radius", "first"), [(0.1, 0.1, False), (0.6, 0.1, True), (0.1, 2.2, True)])
def test_link_with_any_part_outside_a_box_is_found(half_length, radius, first):
    wp.init()
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float32)
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))])
    data = SimpleNamespace(nodal_pos_w=torch.from_numpy(corners)[None])
    colon = SimpleNamespace(wall=SimpleNamespace(triangles=triangles), data=data, num_rings=20)
    links = torch.tensor([[[0.0, 0.0, 0.5], [1.5, 0.0, 0.0], [9.0, 0.0, 0.0]]])
    upright = torch.tensor([0.0, 0.0, 0.0, 1.0]).expand(1, 3, 4)
    scope = SimpleNamespace(
        half_length=np.full(3, half_length),
        stage=SimpleNamespace(link_radius=np.full(3, radius)),
        data=SimpleNamespace(body_pos_w=links, body_quat_w=upright),
    )
    rings = {"link_ring": torch.tensor([[10, 10, 0]])}
    upwards = wp.array(np.array([[(0.0, 0.0, -2.0 + 0.1 * ring) for ring in range(20)]], np.float32), dtype=wp.vec3)
    contact = SimpleNamespace(centers=upwards)  # the first ring examined lies at -1.6 m, below all links
    sim = SimpleNamespace(
        device="cpu", num_envs=1, colon=colon, endoscope=scope, contact=contact, world_arrays=lambda: rings
    )
    outside, examined = LumenCheck(sim).outside()
    assert outside.tolist() == [[first, True, False]]
    assert examined.tolist() == [[True, True, False]]


def test_links_before_the_open_end_are_told_from_those_beside_it() -> None:
    first, last = torch.tensor([[0.0, 0.0, 0.0]]), torch.tensor([[0.0, 0.0, 0.04]])
    places = torch.tensor([[[0.0, 0.02, 0.03], [0.0, 0.02, 0.05], [0.0, 0.06, 0.03], [0.0, 0.06, -0.03]]])
    # 10 mm below, above, 10 mm below but too far aside, 70 mm below, where the cone is wider
    assert below_opening(places, first, last).tolist() == [[True, False, False, True]]


def test_findings_of_all_sessions_add_up(tmp_path):
    path = tmp_path / "soak.jsonl"
    journal = Journal(path)
    journal.write("start", TASK, seed=0)
    journal.write_part(TASK, Tally(env_steps=10, seconds=1.0, largest={"shaft_force": {"push": 3.0}}))
    again = Journal(path)
    again.write("start", TASK, seed=1)
    again.write_part(TASK, Tally(env_steps=5, recovered_worlds=1, largest={"shaft_force": {"push": 2.0}}))
    again.write("event", TASK, what="recovered", seed=1, world=2, step=7, action="push")
    total = Journal(path).tally(TASK)
    assert (again.sessions(TASK), total.env_steps, total.recovered_worlds) == (2, 15, 1)
    assert total.largest == {"shaft_force": {"push": 3.0}}
    assert [event["world"] for event in Journal(path).events(TASK)] == [2]


def test_a_line_that_was_cut_off_by_a_kill_stops_no_later_session(tmp_path):
    path = tmp_path / "soak.jsonl"
    Journal(path).write_part(TASK, Tally(env_steps=10))
    with path.open("a") as file:
        file.write('{"kind": "part", "task": "ARC-Sig')
    Journal(path).write_part(TASK, Tally(env_steps=5))
    assert Journal(path).tally(TASK).env_steps == 15


def test_broken_file_of_findings_is_named(tmp_path):
    path = tmp_path / "soak.jsonl"
    path.write_text('{"kind": "start", "task": "T"}\nnonsense\n')
    with pytest.raises(ValueError, match=r"soak\.jsonl, line 2"):
        Journal(path)


@pytest.mark.parametrize(
    ("bad", "what"),
    [
        ({"recovered_worlds": 1}, "1 worlds had to be recovered"),
        ({"not_finite": {"reward": 2}}, "reward was not finite in 2 worlds"),
        ({"outside_links": 3, "examined_links": 9}, "3 of 9 links were outside the lumen"),
        ({"disturbed_worlds": 1}, "1 worlds were changed"),
        ({"host_growth_mib": 200.0}, "host memory grew by 200 MiB"),
        ({"problems": ["world 1 terminated"]}, "world 1 terminated"),
    ],
)
def test_violation_ends_with_status_one(tmp_path, monkeypatch, capsys, bad, what):
    def fake_soak(task, env_cfg, budget, journal):
        journal.write("start", task, seed=0)
        journal.write_part(task, Tally(env_steps=16, seconds=1.0, **bad))

    monkeypatch.setattr("arcgym.benchmarks.soak.session.soak", fake_soak)
    out = tmp_path / "soak.jsonl"
    arguments = ["--robots=capsule", "--device=cpu", "--steps=16", f"--out={out}", "--json"]
    assert main(["bench", "soak", *arguments]) == 1
    report = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert report["ok"] is False
    assert report["rows"][0]["task"] == TASK
    assert what in report["rows"][0]["violations"][0]


def test_enough_steps_without_violation_end_with_status_zero(tmp_path, monkeypatch, capsys):
    out = tmp_path / "soak.jsonl"
    Journal(out).write_part(TASK, Tally(env_steps=16, seconds=1.0))

    def soak(*args):
        pytest.fail("the steps wanted were made before")

    monkeypatch.setattr("arcgym.benchmarks.soak.session.soak", soak)
    assert main(["bench", "soak", "--robots=capsule", "--device=cpu", "--steps=16", f"--resume={out}"]) == 0
    assert "no violation" in capsys.readouterr().out


def test_growth_is_that_after_the_first_quarter():
    assert growth([1.0] * 7) == 0.0
    assert growth([0.0, 0.0, 50.0, 50.0, 50.0, 50.0, 53.0, 53.0]) == 3.0
