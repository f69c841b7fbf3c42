# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Make a recorded episode again by its actions, and compare every step and the end with the recording.

    arcgym replay logs/episodes/episode_000000.hdf5 --video episode.mp4

Task, colon, robot and all settings are those in the file. What is not as it was recorded (versions, stages, settings,
device) is printed. On the device that it was recorded on the outcome is the same, bit for bit; if it is not, the exit
status is 1. --pieces begins anew at every mark, so that on another processor differences of rounding cannot grow.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from arcgym.cli.arguments import add_fields, argument, positive, read_fields, whole
from arcgym.utils.errors import UsageError

TAKES_OVERRIDES = True


@dataclass(frozen=True, kw_only=True)
class ReplayArguments:
    """Arguments of ``arcgym replay`` but for the file."""

    episode: int = argument("which episode of the file (default: 0)", 0, type=whole(0))
    pieces: bool = argument("from mark to mark, each from the complete state there, as far as there are marks", False)
    video: str | None = argument("draw it, to an .mp4 file", None, metavar="FILE")
    every: int = argument("draw one of so many steps, so many times as fast (default: 1)", 1, type=positive)
    task: str | None = argument("task (default: the recorded one)", None)
    device: str | None = argument("cpu, cuda or cuda:<n> (default: the kind that it was recorded on)", None)
    overrides: list[str] = field(default_factory=list)
    """Texts ``env.path=value``."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("file", type=Path, help="recording (.hdf5), finished or not")
    add_fields(parser, ReplayArguments)


def run(namespace: argparse.Namespace) -> int:
    """Replay; return 1 if the outcome differs.

    Raises:
        UsageError: The file, the task or an override is wrong.
    """
    args = read_fields(ReplayArguments, namespace)
    if args.video and not args.video.endswith(".mp4"):
        raise UsageError(f"--video is '{args.video}', expected a name that ends in .mp4")
    if args.video and args.pieces:
        raise UsageError("--pieces draws no video: choose one of the two.")
    from arcgym.managers import Episode, RecordingError

    try:
        episode = Episode.load(namespace.file, args.episode)
    except RecordingError as error:
        raise UsageError(str(error)) from error
    if not episode.info["length"]:
        raise UsageError(f"{namespace.file} has no steps.")
    return _replay(episode, args)


def _replay(episode: Any, args: ReplayArguments) -> int:
    import gymnasium as gym

    from arcgym.recordings.pieces import replay_pieces
    from arcgym.recordings.replay import replay
    from arcgym.recordings.restoring import mismatches, restored_cfg
    from arcgym.rl.device import choose_device
    from arcgym.rl.preflight import check_environment
    from arcgym.utils.progress import counted, shown

    kind = str(episode.provenance.get("device", "cpu")).partition(":")[0]
    task, cfg = restored_cfg(episode, args.task, choose_device(args.device or kind), args.overrides)
    check_environment(cfg, cfg.sim.device)
    seed, length = episode.provenance.get("seed"), episode.info["length"]
    print(f"recording: {task}, {length} steps, world {episode.provenance.get('env_id')}, seed {seed}")
    for line in mismatches(episode, cfg):
        print(f"differs: {line}")
    with shown("environment"):
        env: Any = gym.make(task, cfg=cfg, render_mode="rgb_array" if args.video else None).unwrapped
    try:
        with _video(args.video, env) as draw, counted("replaying", length) as show:

            def on_step(step: int) -> None:
                if step % args.every == 0:
                    draw()
                if step:
                    show(step)

            if args.pieces:
                return _tell_pieces(replay_pieces(env, episode, on_step=show))
            result = replay(env, episode, on_step)
    finally:
        env.close()
    if args.video:
        print(f"video: {args.video}")
    print(f"replayed: {result.steps} steps in {result.seconds:.1f} s")
    print(f"outcome: {result}")
    return 0 if result.is_exact else 1


def _tell_pieces(pieces: Any) -> int:
    """Print what came of each piece; return 1 if one differs."""
    for piece in pieces:
        print(piece)
    exact = sum(piece.is_exact for piece in pieces)
    farthest = 1000.0 * max((piece.tip_distance for piece in pieces), default=0.0)
    print(f"outcome: {exact} of {len(pieces)} pieces the same, bit for bit; tips end at most {farthest:.2f} mm off")
    return 0 if exact == len(pieces) else 1


def _video(path: str | None, env: Any) -> Any:
    """Return a context whose value draws a frame."""
    from contextlib import contextmanager, nullcontext

    if path is None:
        return nullcontext(lambda: None)
    from arcgym.viewers import VideoRecorder

    @contextmanager
    def open_video() -> Any:
        with VideoRecorder(path, round(1.0 / env.step_dt)) as video:
            yield lambda: video.write(env.render())

    return open_video()
