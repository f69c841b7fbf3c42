#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the start states of the tasks: a scripted expert drives each endoscope up the colon.

The first segment starts from the rest pose. Whenever the tip enters another one, the complete state is kept once it has
settled for a second without commands, with velocities of zero; the drive then goes on from before. The file lies beside
the colon's stage: ``snapshots/<endoscope>.npz``, with the tissue's name added if it is not the default one.
"""

from __future__ import annotations

import argparse
import time

import torch

from arcgym.assets import CAPSULE_CFG, MAGNETIC_CFG, PROXIMAL_CFG, ColonCfg
from arcgym.assets.materials import TISSUE_PRESETS
from arcgym.experts import make_expert
from arcgym.experts.lumen_ahead import tip_angle
from arcgym.scene import InteractiveScene, InteractiveSceneCfg
from arcgym.sim import SimulationCfg, SnapshotSet
from arcgym.sim.snapshot import DEFAULT_MATERIAL, Snapshot, fingerprint, snapshot_path

ENDOSCOPES = {"capsule": CAPSULE_CFG, "magnetic": MAGNETIC_CFG, "proximal": PROXIMAL_CFG}
STEPS_PER_CONTROL = 48
SETTLING = 10
"""Control steps without commands before a state is kept."""


def main() -> None:
    """Parse the arguments and make the files."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--colon", default="colon_1/colon.usda", help="stage of the colon")
    parser.add_argument("--material", choices=TISSUE_PRESETS, default=DEFAULT_MATERIAL, help="tissue of the colon")
    parser.add_argument("--endoscope", choices=ENDOSCOPES, nargs="+", default=list(ENDOSCOPES))
    parser.add_argument("--until", default="splenic", help="last segment to pass")
    parser.add_argument("--speed", type=float, default=0.04, help="speed of the expert [m/s]")
    parser.add_argument("--max_time", type=float, default=90.0, help="simulated time after which to give up [s]")
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--dry_run", action="store_true", help="drive, but write no file")
    args = parser.parse_args()
    for name in args.endoscope:
        snapshots, scene = drive(name, args)
        path = snapshot_path(scene.colon.path, scene.endoscope.path, args.material)
        if not args.dry_run:
            SnapshotSet(tuple(snapshots), tuple(snapshots.values()), fingerprint(scene.sim)).save(path)
            print(f"[{name}] {list(snapshots)} -> {path}")


def drive(name: str, args: argparse.Namespace) -> tuple[dict[str, Snapshot], InteractiveScene]:
    """Drive one endoscope up the colon and keep its state at the start of each segment."""
    colon = ColonCfg(usd_path=args.colon, material=args.material)
    cfg = InteractiveSceneCfg(num_envs=1, colon=colon, endoscope=ENDOSCOPES[name])
    scene = InteractiveScene(cfg, SimulationCfg(device=args.device))
    data, expert = scene["endoscope"].data, make_expert(scene, speed=args.speed)
    bounds = scene["colon"].stage.segment_bounds()
    segments = list(bounds)[: list(bounds).index(args.until) + 1]
    kept: dict[str, Snapshot] = {segments[0]: settled(scene)}
    began, step = time.perf_counter(), 0
    while float(data.tip_arc_length[0]) < bounds[args.until][1] + 0.02:
        expert.act()
        scene.sim.step(STEPS_PER_CONTROL)
        step += 1
        arc = float(data.tip_arc_length[0])
        for segment in segments:
            if arc > bounds[segment][0] and segment not in kept:
                kept[segment] = settled(scene)
                print(f"[{name}] enters {segment} after {step * 0.1:.1f} s", flush=True)
        if step % 20 == 0:
            report(name, step, scene, time.perf_counter() - began)
        if bool(scene.sim.non_finite[0]) or step * 0.1 > args.max_time:
            raise SystemExit(f"[{name}] gave up after {step * 0.1:.1f} s at s = {arc:.3f} m; kept {list(kept)}.")
    report(name, step, scene, time.perf_counter() - began)
    return kept, scene


def settled(scene: InteractiveScene) -> Snapshot:
    """State after a second without commands; the simulation itself stays where it is."""
    sim = scene.sim
    now = SnapshotSet(("now",), (sim.read_snapshot(0),), fingerprint(sim))
    sim.load_snapshots(now)
    sim.write_snapshot(0)
    sim.step(SETTLING * STEPS_PER_CONTROL)
    state = sim.read_snapshot(0).at_rest()
    sim.write_snapshot(0)
    sim.forward()
    return state


def report(name: str, step: int, scene: InteractiveScene, wall_s: float) -> None:
    """Print one line of progress."""
    data, colon = scene["endoscope"].data, scene["colon"].data
    force = data.wall_force_w[0].norm(dim=1)
    print(
        f"[{name}] t {step * 0.1:5.1f} s  s {float(data.tip_arc_length[0]):.3f} m  "
        f"inserted {float(data.inserted_length[0]):.3f} m  push {float(data.base_force[0]):5.1f} N  "
        f"pull {float(data.tip_pull_force_w[0].norm()):4.2f} N  links {float(force.sum()):5.1f} N "
        f"(max {float(force.max()):4.1f} at {int(force.argmax())})  "
        f"wall {1e3 * float(colon.nodal_displacement.max()):5.1f} mm  "
        f"tip off axis {1e3 * float(data.tip_centerline_distance[0]):4.1f} mm, {float(tip_angle(scene)[0]):3.0f} deg  "
        f"wall clock {wall_s:.0f} s",
        flush=True,
    )


if __name__ == "__main__":
    with torch.inference_mode():
        main()
