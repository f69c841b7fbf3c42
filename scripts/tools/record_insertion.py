#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Record an insertion that ``search_insertion.py`` found as a small file, with a complete state every few seconds.

    python scripts/tools/record_insertion.py logs/insertion/best.npz insertion.hdf5 --tissue in_situ

The task is the one from the anus to the end of the colon, with everything that belongs to it. The file has what
``arcgym replay`` compares of tip and forces; poses of the links and of the wall are left out.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

TASK = "ARC-Cecum-Proximal"
KEPT = (
    "actions",
    "marks/",
    "initial_state/",
    "final_state/",
    "world_settings/",
    "metrics/",
    "forces/tip",
    "forces/base",
)
KEPT += ("forces/window_peak", "poses/tip_", "poses/inserted_length", "hand/leads")
"""Names, or beginnings of names, of what the file keeps."""


def main() -> int:
    """Parse the command line and record."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("actions", type=Path, help="best.npz of a search")
    parser.add_argument("file", type=Path, help="recording to write (.hdf5)")
    parser.add_argument("--tissue", default="in_situ", help="preset of the tissue (in_situ)")
    parser.add_argument("--patient", default="colon_1/colon.usda", help="stage of the colon (colon_1)")
    parser.add_argument("--every", type=float, default=5.0, help="time between two states [s] (5)")
    parser.add_argument("--first", type=int, default=0, help="control steps before the recording begins (0)")
    parser.add_argument("--last", type=int, help="control step at which it ends (all)")
    parser.add_argument("--overrides", nargs="*", default=[], help="env.path=value")
    args = parser.parse_args()
    from arcgym.managers import Episode, save_episode

    found = np.load(args.actions)
    with tempfile.TemporaryDirectory() as folder:
        whole = Episode.load(record(found["actions"], len(found["steps"]) - 1, args, Path(folder)))
    data = {name: value for name, value in whole.data.items() if name.startswith(KEPT)}
    args.file.parent.mkdir(parents=True, exist_ok=True)
    save_episode(replace(whole, data=data, steps=frozenset(whole.steps & data.keys())), args.file)
    arc = data["poses/tip_arc_length"]
    print(
        f"{args.file}: {len(arc)} steps, {arc[-1]:.3f} m, tip at most {data['forces/tip_peak'].max():.1f} N, shaft "
        f"{data['forces/window_peak'].max():.1f} N, {args.file.stat().st_size / 1e6:.2f} MB"
    )
    return 0


def record(actions: np.ndarray, tried: int, args: argparse.Namespace, folder: Path) -> Path:
    """Drive by the actions and return the complete recording."""
    import gymnasium as gym
    import torch

    from arcgym.envs.memory import EnvMemory
    from arcgym.teleop.choices import Choice, make_cfg
    from arcgym.utils.registry import load_task_packages
    from arcgym.utils.threads import one_thread

    load_task_packages()
    chosen = Choice(TASK, args.patient, args.tissue, "rest", overrides=tuple(args.overrides))
    name, cfg = make_cfg(chosen, folder)
    cfg.autoreset, cfg.recorders.wall = False, None
    env: Any = gym.make(name, cfg=cfg).unwrapped
    env.hand_leads, env.hand_marks = torch.zeros(1, dtype=torch.uint8), []
    env.reset()
    world, marks, recorder = torch.zeros(1, dtype=torch.long), env.hand_marks, env.recorder_manager
    with torch.inference_mode(), one_thread():
        recorder.ignore([0])
        for action in actions[: args.first]:
            env.step(torch.as_tensor(action)[None])
        recorder.ignore([])
        recorder.record_post_reset(world)
        for step, action in enumerate(actions[args.first : args.last]):
            if not marks or (step - marks[-1][0]) * env.step_dt > args.every - 0.5 * env.step_dt:
                marks.append((step, EnvMemory(env).worlds))
                arc = float(env.scene["endoscope"].data.tip_arc_length)
                print(f"{step} of {len(actions)} steps, {arc:.3f} m", flush=True)
            env.step(torch.as_tensor(action)[None])
        kept = [{"name": f"{step * env.step_dt:.1f} s", "step": step} for step, _ in marks]
        recorder.notes = {"marks": kept, "undone": tried}
        recorder.record_pre_reset(world)
    return env.recorder_manager.paths[-1]


if __name__ == "__main__":
    sys.exit(main())
