#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Pushes a colonoscope through a mobile sigmoid colon, turns the shaft into an alpha loop, and straightens it.

python scripts/benchmarks/looping.py --out docs/images --json_out docs/data/looping.json

First a scripted expert pushes the tip past the sigmoid colon. It pushes on from there, once as before and once while
the shaft is rolled anticlockwise: the tip falls behind, and the loop crosses itself as seen from the front. Then the
tip is hooked and the shaft withdrawn, rolled clockwise as a colonoscopist does, not at all, and anticlockwise, each
from the same state.
Printed: looping ratio (inserted length over the tip's arc length), turning, writhe and crossings of shaft and colon,
forces. Draws the shaft from outside and the curves. Needs matplotlib (``pip install arcgym[dev]``).
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import torch
from PIL import Image

from arcgym.assets import PROXIMAL_CFG, ColonCfg
from arcgym.benchmarks.loops import Loop, crossings, from_front, measure_loop
from arcgym.experts import PushExpert
from arcgym.scene import InteractiveScene, InteractiveSceneCfg
from arcgym.sensors import SkinnedSurface
from arcgym.sim import SimulationCfg, SnapshotSet
from arcgym.sim.snapshot import fingerprint
from arcgym.viewers.outside_view import OutsideView, OutsideViewCfg

STEPS = 48
"""Physics steps in a control step of 0.1 s."""
PAST_SIGMOID = 0.12
"""How far into the descending colon the tip is pushed before the shaft is rolled [m]."""
LOOPING = {"roll": -1.0, "time": 15.0}
"""Roll rate [rad/s] and duration [s] of pushing on; positive is clockwise to the operator, who looks along the scope.
"""
WITHDRAWAL = {"speed": 0.03, "time": 9.0, "hook": 1.5}
"""Speed [m/s] and duration [s] of the withdrawal, and the bending that hooks the tip [rad]."""
ROLLS = {"clockwise": 0.6, "none": 0.0, "anticlockwise": -0.6}
"""Roll rates while withdrawing [rad/s]."""
LABELS = {"push": "push", "push on": "push on, no roll", "loop": "push on, roll anticlockwise"}
"""Legend of the runs that push."""
Row = dict[str, float]


def main() -> None:
    """Push, loop, straighten, draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--colon", default="colon_1/colon.usda", help="stage of the colon")
    parser.add_argument("--material", default="in_situ", help="tissue preset")
    parser.add_argument("--mesocolon", type=float, help="height of the sigmoid mesocolon [m] (default: the preset's)")
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--max_time", type=float, default=60.0, help="longest time of pushing [s]")
    parser.add_argument("--out", type=Path, help="folder for the pictures")
    parser.add_argument("--name", default="looping", help="first part of the pictures' names")
    parser.add_argument("--json_out", type=Path, help="file for the curves")
    args = parser.parse_args()
    slack = {} if args.mesocolon is None else {"sigmoid": args.mesocolon}
    colon = ColonCfg(usd_path=args.colon, material=args.material, anchor_slack=slack)
    scene = InteractiveScene(
        InteractiveSceneCfg(num_envs=1, colon=colon, endoscope=PROXIMAL_CFG), SimulationCfg(device=args.device)
    )
    runs, views = manoeuvre(scene, args.max_time)
    summary = {name: {"start": rows[0], "end": rows[-1]} for name, rows in runs.items()}
    if args.out:
        save_views(views, args.out / f"{args.name}_views.jpg")
        draw_curves(runs, args.out / f"{args.name}_curves.png")
    if args.json_out:
        thinned = {name: [*rows[:-1:5], rows[-1]] for name, rows in runs.items()}
        about = {"colon": args.colon, "material": args.material, "mesocolon": args.mesocolon, "every_s": 0.5}
        args.json_out.write_text(json.dumps({**about, "runs": thinned}).replace("}, {", "},\n{") + "\n")
    print(json.dumps(summary))


def manoeuvre(scene: InteractiveScene, max_time: float) -> tuple[dict[str, list[Row]], dict[str, np.ndarray]]:
    """Curves of pushing, looping and each way of straightening, and pictures after each."""
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
    expert = PushExpert(scene)
    end = scene["colon"].stage.segment_bounds()["descending"][0] + PAST_SIGMOID
    for step in range(int(10.0 * max_time)):
        expert.act()
        yield advance(scene, "push", step)
        if float(scene["endoscope"].data.tip_arc_length[0]) > end:
            return


def push_on(scene: InteractiveScene, roll_rate: float) -> Iterator[Row]:
    """Push on while rolling; one row a control step."""
    expert, endoscope = PushExpert(scene), scene["endoscope"]
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
    """One control step and what came of it."""
    scene.sim.step(STEPS)
    if bool(scene.sim.non_finite[0]):
        raise SystemExit(f"The world failed after {step / 10.0:.1f} s ({label}).")
    row = read(scene, (step + 1) / 10.0)
    if step % 10 == 9:
        print(f"[{label}] " + "  ".join(f"{name} {value:.3g}" for name, value in row.items()), flush=True)
    return row


def read(scene: InteractiveScene, time: float) -> Row:
    """State of the loop."""
    data, colon = scene["endoscope"].data, scene["colon"].data
    tip, inserted = float(data.tip_arc_length[0]), float(data.inserted_length[0])
    loop: Loop = measure_loop(shaft(scene))
    row = {"time": time, "tip_arc": tip, "inserted": inserted, "looping_ratio": inserted / max(tip, 1.0e-3)}
    row |= asdict(loop) | {"alpha": loop.alpha, "colon_crossings": crossings(from_front(left_colon(scene)))}
    row |= {"push": float(data.base_force[0])}
    row |= {"link_force": float(data.wall_force_w[0].norm(dim=1).max())}
    row |= {"wall_moved": float(colon.nodal_displacement.max()), "strain": float(colon.wall_strain.max())}
    return {name: round(float(value), 4) for name, value in row.items()}


def shaft(scene: InteractiveScene) -> np.ndarray:
    """Centres of the links inside the body [m], shape (n, 3)."""
    points = scene["endoscope"].data.body_pos_w[0].cpu().numpy()
    return points[int(np.argmax(points[:, 2] > 0.0)) :]


def left_colon(scene: InteractiveScene) -> np.ndarray:
    """Centreline from the anus to the end of the descending colon [m], shape (n, 3)."""
    end = scene["colon"].stage.segment_bounds()["descending"][1]
    data = scene["colon"].data
    return data.centerline_pos_w[0][data.centerline_arc < end].cpu().numpy()


def view_of(scene: InteractiveScene) -> Callable[[], np.ndarray]:
    """Function that draws the scene from the front."""
    colon, endoscope = scene["colon"], scene["endoscope"]
    proxy, scope = colon.stage.visual_proxy, endoscope.stage
    surface = SkinnedSurface(proxy, colon.wall, 1, scene.device)
    cfg = OutsideViewCfg(near_alpha=0.10, scope_share=0.7)
    view = OutsideView(cfg, surface, proxy.points, scope.link_length, scope.link_radius, scope.bending_links)

    def draw() -> np.ndarray:
        surface.update(colon.nodal_pos_wp)
        data: Any = endoscope.data
        pose = (data.body_pos_w[0].cpu().numpy(), data.body_quat_w[0].cpu().numpy())
        return view.render(*pose, data.wall_force_w[0].norm(dim=1).cpu().numpy())

    return draw


def save_views(views: dict[str, np.ndarray], path: Path) -> None:
    """Put the pictures of the pushed shaft, of the loop and of the one withdrawn clockwise side by side."""
    pictures = [views[name] for name in ("push", "loop", "clockwise")]
    Image.fromarray(np.concatenate(pictures, axis=1)).save(path, quality=85)


def draw_curves(runs: dict[str, list[Row]], path: Path) -> None:
    """Inserted length against tip progress; views in which the shaft crosses itself and its turning, in time."""
    figure, axes = plt.subplots(1, 3, figsize=(12.0, 3.6))
    pushed = runs["push"][-1]["time"]
    begin = {"push": 0.0, "push on": pushed, "loop": pushed}
    for name, rows in runs.items():
        label = LABELS.get(name, f"withdraw, roll {name}")
        column = {key: np.array([row[key] for row in rows]) for key in rows[0]}
        time = column["time"] + begin.get(name, pushed + LOOPING["time"])
        axes[0].plot(column["tip_arc"], column["inserted"], label=label)
        axes[1].plot(time, 100.0 * column["views"])
        axes[2].plot(time, column["turning"])
    axes[0].axline((0.2, 0.2), slope=1.0, color="0.7", lw=0.8)
    axes[0].set(xlabel="arc length of the tip [m]", ylabel="inserted length [m]")
    axes[0].legend(fontsize=7)
    axes[1].set(xlabel="time [s]", ylabel="views in which the shaft crosses itself [%]")
    axes[2].set(xlabel="time [s]", ylabel="turning of the shaft [deg]")
    figure.tight_layout()
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    with torch.inference_mode():
        main()
