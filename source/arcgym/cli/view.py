# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Look at a recording, a colon or a trained policy in the browser; nothing can be steered.

    arcgym view logs/teleop/teleop_000000.hdf5
    arcgym view assets/usd/colon_2/colon.usda
    arcgym view logs/rsl_rl/arc_sigmoid_magnetic/2026-11-20_10-00-00

A recording plays as it was recorded; its wall moves if wall positions were recorded. A stage is walked through along
its centerline. A run folder drives its newest checkpoint in its task.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from arcgym.cli.arguments import add_fields, argument, positive, read_fields, whole
from arcgym.utils.errors import UsageError
from arcgym.utils.paths import resolve_stage

TAKES_OVERRIDES = True
WALKER = "ARC-Rectum-Capsule"
"""Task whose scene a stage is put into."""


@dataclass(frozen=True, kw_only=True)
class ViewArguments:
    """Arguments of ``arcgym view`` but for what is looked at."""

    episode: int = argument("which episode of a recording (default: 0)", 0, type=whole(0))
    checkpoint: str | None = argument("checkpoint of a run (default: latest)", None)
    device: str | None = argument("cpu, cuda or cuda:<n> (default: cpu, for a run cuda:0 where there is one)", None)
    host: str = argument("address to listen at (default: 127.0.0.1, this machine alone)", "127.0.0.1")
    port: int = argument("port (default: 8080; 0 takes a free one)", 8080, type=whole(0))
    size: int = argument("width and height of the endoscope's view [px] (default: 320)", 320, type=positive)
    overrides: list[str] = field(default_factory=list)
    """Texts ``env.path=value``."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("what", type=Path, help="recording (.hdf5), stage (colon.usda, or colon_1) or folder of a run")
    add_fields(parser, ViewArguments)


def run(namespace: argparse.Namespace) -> None:
    """Open the page until Ctrl-C.

    Raises:
        UsageError: There is nothing to look at.
    """
    args, what = read_fields(ViewArguments, namespace), namespace.what
    from arcgym.rl.agent_checks import check_installed

    check_installed("viser", "the page", extra="teleop")
    if not what.exists() or (what / "colon.usda").is_file():
        what = resolve_stage(what)
    if not what.exists():
        raise UsageError(f"There is no '{what}'; expected a recording, a stage or the folder of a run.")
    if what.is_dir():
        return _view_run(what, args)
    from arcgym.cli.teleop import show

    show(make_player(what, args), args, steers=False)


def make_player(what: Path, args: ViewArguments) -> Any:
    """Return what plays a recording or a stage.

    Raises:
        UsageError: The file is neither.
    """
    import gymnasium as gym

    from arcgym.rl.preflight import check_environment
    from arcgym.teleop.player import Player, recorded_frames, walk_frames
    from arcgym.utils.progress import shown

    episode, task, cfg = _recording(what, args) if what.suffix == ".hdf5" else (None, WALKER, _stage(what, args))
    check_environment(cfg, cfg.sim.device)
    with shown("environment"):
        env: Any = gym.make(task, cfg=cfg).unwrapped
        env.reset()
    if episode is None:
        make, count = walk_frames(env)
        return Player(env, make, count, 0.1, f"{what.parent.name}: a walk along the centerline")
    return Player(env, recorded_frames(env, episode), episode.info["length"], episode.info["step_dt"], what.name)


def _recording(what: Path, args: ViewArguments) -> tuple[Any, str, Any]:
    from arcgym.managers import Episode, RecordingError
    from arcgym.recordings.restoring import mismatches, restored_cfg
    from arcgym.rl.device import choose_device

    try:
        episode = Episode.load(what, args.episode)
    except RecordingError as error:
        raise UsageError(str(error)) from error
    needed = {"poses/body_pos_w", "poses/body_quat_w", "forces/window", "forces/tip"} - episode.steps
    if needed or not episode.info["length"]:
        raise UsageError(f"{what} cannot be shown: it has no steps, or lacks {', '.join(sorted(needed)) or 'all'}.")
    task, cfg = restored_cfg(episode, None, choose_device(args.device or "cpu"), args.overrides)
    for line in mismatches(episode, cfg):
        print(f"differs: {line}")
    if "wall/positions" not in episode.steps:
        print("the recording has no wall positions: the wall stays as it was at the start")
    return episode, task, cfg


def _stage(what: Path, args: ViewArguments) -> Any:
    from arcgym.rl.device import choose_device
    from arcgym.utils.hydra import apply_overrides
    from arcgym.utils.registry import load_cfg_from_registry

    cfg = load_cfg_from_registry(WALKER, "env_cfg_entry_point")
    cfg.scene.num_envs, cfg.scene.colon.usd_path, cfg.sim.device = 1, str(what), choose_device(args.device or "cpu")
    cfg.events, cfg.scene.colon.rigid = None, True
    try:
        apply_overrides({"env": cfg}, list(args.overrides))
    except (TypeError, ValueError) as error:
        raise UsageError(str(error)) from error
    return cfg


def _view_run(folder: Path, args: ViewArguments) -> None:
    """Let the policy of a run drive."""
    from arcgym.cli.teleop import TeleopArguments, serve
    from arcgym.rl.params import read_params
    from arcgym.rl.run_folder import newest_checkpoint
    from arcgym.utils.registry import plain_task

    params = read_params(folder)
    if params is None:
        raise UsageError(f"{folder} is no folder of a run: it has no params.")
    checkpoint = args.checkpoint or str(newest_checkpoint(folder))
    asked = TeleopArguments(
        task=plain_task(params.task), checkpoint=checkpoint, driver="policy", device=args.device,
        host=args.host, port=args.port, size=args.size, overrides=args.overrides, out="logs/view",
    )  # fmt: skip
    serve(asked, steers=False)
