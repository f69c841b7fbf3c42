# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Turn recordings into another layout: LeRobot 3.0, robomimic, or one file of ARCGym's own.

    arcgym convert logs/datasets/sigmoid logs/sigmoid_lerobot --to lerobot
    arcgym convert logs/episodes logs/episodes.hdf5 --to robomimic --only_successes

Each sample has what was recorded after the step before, the action, and what came of it; an episode's first step,
before which nothing is recorded, is left out.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

from arcgym.cli.arguments import add_fields, argument, read_fields
from arcgym.utils.errors import UsageError


@dataclass(frozen=True, kw_only=True)
class ConvertArguments:
    """Arguments of ``arcgym convert`` but for its paths."""

    to: str = argument("layout", choices=("lerobot", "robomimic", "arcgym"))
    state: str | None = argument(
        "values of steps that make the state, separated by commas (default: tip and force)", None
    )
    image: str = argument("pictures (default: images/rgb); none for none", "images/rgb")
    only_successes: bool = argument("leave episodes out that did not reach their goal", False)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("source", type=Path, nargs="+", help="recordings, or folders with recordings below them")
    parser.add_argument("out", type=Path, help="folder (lerobot) or .hdf5 file (robomimic, arcgym) to write")
    add_fields(parser, ConvertArguments)


def run(namespace: argparse.Namespace) -> None:
    """Convert.

    Raises:
        UsageError: A path or a value is wrong, or a package is missing.
    """
    args = read_fields(ConvertArguments, namespace)
    sources, out = namespace.source, namespace.out
    for source in sources:
        if not source.exists():
            raise UsageError(f"There is no recording '{source}'.")
    if out.exists():
        raise UsageError(f"{out} exists; name a path that does not.")
    if args.to != "lerobot" and out.suffix != ".hdf5":
        raise UsageError(f"'{out}' is to be a file, expected a name that ends in .hdf5")
    from arcgym.managers import RecordingError

    try:
        print(f"converted: {_convert(args, sources, out)} episodes to {out}")
    except RecordingError as error:
        raise UsageError(str(error)) from error


def _convert(args: ConvertArguments, sources: list[Path], out: Path) -> int:
    from arcgym.recordings.samples import STATE, read_samples, recordings

    if args.to == "arcgym":
        from arcgym.managers.recorder_joining import join

        return join(recordings(sources), out, args.only_successes)
    state = tuple(args.state.split(",")) if args.state else STATE
    image = None if args.image == "none" else args.image
    samples = read_samples(sources, state, image, args.only_successes)
    if args.to == "robomimic":
        from arcgym.recordings.robomimic import write_robomimic

        return write_robomimic(samples, out)
    from arcgym.rl.agent_checks import check_installed

    check_installed("pyarrow", "--to lerobot", extra="lerobot")
    from arcgym.recordings.lerobot import write_lerobot

    return write_lerobot(samples, out)
