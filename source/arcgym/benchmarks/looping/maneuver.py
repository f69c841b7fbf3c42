# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Pushes a colonoscope through a mobile sigmoid colon, turns the shaft into a loop and straightens it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict

import numpy as np
import torch

from arcgym.benchmarks.looping.pictures import view_of
from arcgym.benchmarks.looping.shape import Loop, crossings, from_front, measure_loop
from arcgym.experts import PushExpert
from arcgym.experts.expert_base import CONTROL_STEP
from arcgym.scene import InteractiveScene
from arcgym.sim import SnapshotSet
from arcgym.sim.snapshot import fingerprint

PAST_SIGMOID = 0.12
"""How far into the descending colon the tip is pushed before the shaft is rolled [m]."""
LOOPING = {"roll": -1.0, "time": 15.0}
"""Roll rate [rad/s] and duration [s] of pushing on; positive is clockwise to the operator, who looks along the scope.
"""
WITHDRAWAL = {"speed": 0.03, "time": 9.0, "hook": 1.5}
"""Speed [m/s] and duration [s] of the withdrawal, and the bending that hooks the tip [rad]."""
ROLLS = {"clockwise": 0.6, "none": 0.0, "anticlockwise": -0.6}
"""Roll rates while withdrawing [rad/s]."""
STEERING = {"patience": 25.0, "least_pace": 0.15}
"""Settings of the expert that brings the tip past the sigmoid colon."""
PUSHING = {**STEERING, "patience": math.inf}
"""Settings of the expert that pushes on: it withdraws nothing where the tip does not get on."""
Row = dict[str, float]
"""Figures of one control step."""


def maneuver(scene: InteractiveScene, max_time: float) -> tuple[dict[str, list[Row]], dict[str, np.ndarray]]:
    """Return the curves of pushing, looping and each way of straightening, and pictures after each."""
    draw_view = view_of(scene)
    runs = {"push": list(push(scene, max_time))}
    views = {"push": draw_view()}
    keep_state(scene)
    runs["push on"] = list(push_on(scene, 0.0))
    back_to_kept(scene)
    runs["loop"] = list(push_on(scene, LOOPING["roll"]))
    views["loop"] = draw_view()
    keep_state(scene)
    for name, rate in ROLLS.items():
        back_to_kept(scene)
        runs[name] = list(withdraw(scene, rate))
        views[name] = draw_view()
    return runs, views


def keep_state(scene: InteractiveScene) -> None:
    """Keep the scene as it is, at rest."""
    sim = scene.sim
    sim.load_snapshots(SnapshotSet(("kept",), (sim.read_snapshot(0).at_rest(),), fingerprint(sim)))
    back_to_kept(scene)


def back_to_kept(scene: InteractiveScene) -> None:
    """Put the scene into the state last kept."""
    scene.sim.write_snapshot(0)
    scene.sim.forward()


def push(scene: InteractiveScene, max_time: float) -> Iterator[Row]:
    """Drive the tip past the sigmoid colon; one row a control step."""
    expert = PushExpert(scene, **STEERING)
    end = scene["colon"].stage.segment_bounds()["descending"][0] + PAST_SIGMOID
    for step in range(int(10.0 * max_time)):
        expert.act()
        yield advance(scene, "push", step)
        if float(scene["endoscope"].data.tip_arc_length[0]) > end:
            return


def push_on(scene: InteractiveScene, roll_rate: float) -> Iterator[Row]:
    """Push on while rolling; one row a control step."""
    expert, endoscope = PushExpert(scene, **PUSHING), scene["endoscope"]
    expert.bending += endoscope.data.bending
    for step in range(int(10.0 * LOOPING["time"])):
        expert.act()
        endoscope.set_insertion_command(expert.velocity, torch.full_like(expert.velocity, roll_rate))
        yield advance(scene, f"push, roll {roll_rate:+.1f}", step)


def withdraw(scene: InteractiveScene, roll_rate: float) -> Iterator[Row]:
    """Withdraw with a hooked tip while rolling; one row a control step."""
    endoscope = scene["endoscope"]
    bending = endoscope.data.bending.clone()
    hook = bending / bending.norm(dim=1, keepdim=True).clamp(min=1.0e-3) * WITHDRAWAL["hook"]
    speed = torch.full((1,), -WITHDRAWAL["speed"], device=scene.device)
    for step in range(int(10.0 * WITHDRAWAL["time"])):
        endoscope.set_bending_command(hook[:, 0], hook[:, 1])
        endoscope.set_insertion_command(speed, torch.full_like(speed, roll_rate))
        yield advance(scene, f"withdraw, roll {roll_rate:+.1f}", step)


def advance(scene: InteractiveScene, label: str, step: int) -> Row:
    """Make one control step and return what came of it."""
    scene.sim.step(round(CONTROL_STEP / scene.sim.physics_dt))
    if bool(scene.sim.non_finite[0]):
        raise SystemExit(f"The world failed after {step / 10.0:.1f} s ({label}).")
    row = read(scene, (step + 1) / 10.0)
    if step % 10 == 9:
        print(f"[{label}] " + "  ".join(f"{name} {value:.3g}" for name, value in row.items()), flush=True)
    return row


def read(scene: InteractiveScene, time: float) -> Row:
    """Return the findings since the last call, and the events with all that finds them again; wait for the device."""
    data, colon = scene["endoscope"].data, scene["colon"].data
    tip, inserted = float(data.tip_arc_length[0]), float(data.inserted_length[0])
    loop: Loop = measure_loop(shaft(scene))
    row = {"time": time, "tip_arc": tip, "inserted": inserted, "looping_ratio": inserted / max(tip, 1.0e-3)}
    row |= asdict(loop) | {"alpha": loop.alpha, "colon_crossings": crossings(from_front(left_colon(scene)))}
    row |= {"push": float(data.base_force[0])}
    row |= {"shaft_force": float(data.window_force_norm[0].max())}
    row |= {"wall_moved": float(colon.nodal_displacement.max()), "strain": float(colon.wall_strain.max())}
    return {name: round(float(value), 4) for name, value in row.items()}


def shaft(scene: InteractiveScene) -> np.ndarray:
    """Return the centers of the links inside the body [m], shape (n, 3)."""
    points = scene["endoscope"].data.body_pos_w[0].cpu().numpy()
    return points[int(np.argmax(points[:, 2] > 0.0)) :]


def left_colon(scene: InteractiveScene) -> np.ndarray:
    """Return the centerline from the anus to the end of the descending colon [m], shape (n, 3)."""
    end = scene["colon"].stage.segment_bounds()["descending"][1]
    data = scene["colon"].data
    return data.centerline_pos_w[0][data.centerline_arc[0] < end].cpu().numpy()
