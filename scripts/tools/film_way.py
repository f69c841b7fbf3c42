#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Film the way of an expert: the states that ``arcgym bench experts --ways FOLDER`` keeps, every 4 cm, one a frame.

    python scripts/tools/film_way.py ways/ct_1-magnetic_2400mm-paper ct_1.mp4 --task ARC-Cecum-Magnetic \\
        env.scene.colon.usd_path=ct_1 env.scene.endoscope.length=2.4

Each state is held for a control step without commands, so that the forces drawn are those of that place: the worlds of
a drive take over from one another, and what lies between two frames is not one episode. With ``--held 4`` the robot's
own expert goes on from the last state for 4 s, an episode of its own: what holds a scope that does not get on.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import torch

sys.path.insert(0, str(Path(__file__).parent))  # the gallery's way to make a film small
from make_gallery import QUALITY, shrink

FPS = 4.0
"""States shown in a second."""
EVERY = 2
"""Control steps from one frame to the next where the expert goes on."""


def main() -> int:
    """Parse the command line and film."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("way", type=Path, help="folder of the states")
    parser.add_argument("film", type=Path, help="file to write, .mp4")
    parser.add_argument("--task", required=True, help="task of the robot")
    parser.add_argument(
        "--every", type=int, default=1, help="states kept for one that is shown; the last is shown, too"
    )
    parser.add_argument("--quality", type=int, default=QUALITY, help="constant rate factor of x264, 0 is without loss")
    parser.add_argument("--held", type=float, default=0.0, help="time that the expert goes on from the last state [s]")
    parser.add_argument("--device", default="cpu", help="device of the run")
    args, overrides = parser.parse_known_args()
    if args.every < 1:
        parser.error(f"--every is {args.every}, expected 1 or more states for one that is shown")
    from arcgym.benchmarks.experts.ways import read_way
    from arcgym.viewers import VideoRecorder

    kept = list(read_way(args.way).values())
    states = [*kept[: -1 : args.every], *kept[-1:]]
    if not states:
        parser.error(f"there are no states in {args.way}; expected files named by arc length, such as 0.9600.npz")
    env = environment(args.task, args.device, overrides)
    with tempfile.TemporaryDirectory() as folder:
        raw = Path(folder) / "film.mp4"
        with VideoRecorder(raw, FPS) as video:
            for state in states:
                video.write(picture(env, state))
            for frame in going_on(env, args.held):
                video.write(frame)
        env.close()
        shrink(raw, args.film, 1, FPS, args.quality)
    print(f"{args.film}: {len(states)} states, {args.film.stat().st_size / 1e3:.0f} kB")
    return 0


def environment(task: str, device: str, overrides: list[str]) -> Any:
    """Return one world of a task that begins at rest, in the tissue as configured, and whose episodes do not end."""
    import gymnasium as gym

    from arcgym.benchmarks.worlds import load_env_cfg

    words = ("env.scene.num_envs=1", "env.start=rest", *overrides)
    cfg = load_env_cfg(task, words, 0, device=device)
    for name in vars(cfg.terminations):
        setattr(cfg.terminations, name, None)
    for name in ("aim", "stiffness", "friction"):  # drawn anew for every episode, and no part of the states
        setattr(cfg.events, name, None)
    env: Any = gym.make(task, cfg=cfg, render_mode="rgb_array").unwrapped
    env.reset()
    return env


def picture(env: Any, state: Any) -> Any:
    """Return the picture of a state."""
    sim = env.scene.sim
    arrays = {name: torch.from_numpy(array)[None].to(sim.device) for name, array in state.arrays.items()}
    sim.write_state(arrays, [0])
    sim.forward()
    env.step(torch.zeros(1, env.action_manager.total_action_dim, device=sim.device))
    return env.render()


def going_on(env: Any, seconds: float) -> Iterator[Any]:
    """Yield pictures of the robot's own expert, which goes on from the state that the environment is in."""
    from arcgym.rl.expert_policy import ExpertPolicy

    policy = ExpertPolicy(env)
    for step in range(round(seconds / env.step_dt)):
        env.step(policy())
        if step % EVERY == EVERY - 1:
            yield env.render()


if __name__ == "__main__":
    sys.exit(main())
