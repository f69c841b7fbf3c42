# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""The command ``arcgym``: finds the subcommand's module, parses its arguments, runs it."""

from __future__ import annotations

import atexit
import errno
import gc
import importlib
import os
import re
import sys
from collections.abc import Sequence
from pathlib import Path

from arcgym.cli.parser import CommandParser
from arcgym.utils.errors import UsageError
from arcgym.utils.string import did_you_mean

COMMANDS = {
    "train": ("arcgym.cli.train", "train a policy with rsl_rl"),
    "play": ("arcgym.cli.play", "run a trained policy, record it and export it"),
    "evaluate": ("arcgym.cli.evaluate", "evaluate an agent on the trials of a suite"),
    "teleop": ("arcgym.cli.teleop", "steer a robot by hand in the browser"),
    "view": ("arcgym.cli.view", "look at a recording, a colon or a policy in the browser"),
    "record": ("arcgym.cli.record", "make a data set of episodes, with pictures if wanted"),
    "convert": ("arcgym.cli.convert", "turn recordings into LeRobot's or robomimic's layout"),
    "results compare": ("arcgym.cli.results_compare", "compare two agents on the same trials"),
    "results merge": ("arcgym.cli.results_merge", "put the results of several machines into one folder"),
    "results page": ("arcgym.cli.results_page", "draw an evaluation as a page"),
    "results paper": ("arcgym.cli.results_paper", "show an evaluation beside the paper's figures"),
    "results summary": ("arcgym.cli.results_summary", "write all tables of result folders as one page"),
    "results check": ("arcgym.cli.results_check", "check a result folder before it is published"),
    "results leaderboard": ("arcgym.cli.results_leaderboard", "make the leaderboard of submitted result folders"),
    "replay": ("arcgym.cli.replay", "make a recorded episode again and compare it bit for bit"),
    "study": ("arcgym.cli.study", "train a grid of algorithms, tasks, robots and seeds"),
    "study report": ("arcgym.cli.study_report", "make table and pictures of a study's folder"),
    "list": ("arcgym.cli.list_tasks", "list the registered tasks"),
    "zero": ("arcgym.cli.zero", "run a task with raw actions that are zero"),
    "random": ("arcgym.cli.random_actions", "run a task with uniform random actions"),
    "make-colon": ("arcgym.cli.make_colon", "generate a colon from a spec file or a seed"),
    "import-colon": ("arcgym.cli.import_colon", "turn a CT segmentation or a surface into a colon"),
    "import-dataset": ("arcgym.cli.import_dataset", "turn a folder of masks into a folder of colons"),
    "validate": ("arcgym.cli.validate", "check colons"),
    "preview": ("arcgym.cli.preview", "draw a colon on one page"),
    "bench throughput": ("arcgym.cli.bench_throughput", "measure how fast a task runs"),
    "bench fidelity": ("arcgym.cli.bench_fidelity", "compare the physics with theory and references"),
    "bench experts": ("arcgym.cli.bench_experts", "measure how far scripted experts get in many patients"),
    "bench clinical": ("arcgym.cli.bench_clinical", "compare scripted insertions with published ones"),
    "bench soak": ("arcgym.cli.bench_soak", "drive the robots for a long time and look for faults"),
    "bench camera": ("arcgym.cli.bench_camera", "measure how many pictures the camera draws"),
    "bench learner": ("arcgym.cli.bench_learner", "measure how long agents take for an update"),
    "bench scaling": ("arcgym.cli.bench_scaling", "measure how much faster a run gets with more GPUs"),
    "snapshots": ("arcgym.cli.snapshots", "make the start states of a task ahead"),
}
"""Module and one line of help by subcommand. A name may have two words, such as ``bench soak``."""


INTERRUPTED = 128 + 2
"""Exit status after Ctrl-C, as shells expect it."""

DISK_TROUBLE = (errno.EACCES, errno.EDQUOT, errno.ENOSPC, errno.EROFS)
"""Errors of a folder that may not be written or of a disk that is full: one line says all."""

DISK_FAILED = 74
"""Exit status after one of them, ``EX_IOERR`` of sysexits.h."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run ``arcgym <subcommand> …`` and return its exit status.

    Args:
        argv: Arguments without the program's name; None takes those of the process.

    Raises:
        SystemExit: With status 2 after a mistake in the arguments.
    """
    if argv is None:
        _end_quickly()
    words = list(sys.argv[1:] if argv is None else argv)
    name = " ".join(words[:2]) if " ".join(words[:2]) in COMMANDS else "".join(words[:1])
    if name in COMMANDS:
        status = run_command(name, words[len(name.split()) :])
        return status if argv is not None else _ended(status)
    if not words or words[0] in ("-h", "--help"):
        print(_overview())
        return 0
    if words[0] == "--version":
        from arcgym import __version__

        print(f"arcgym {__version__}")
        return 0
    group = [command for command in COMMANDS if command.startswith(f"{name} ")]
    given = " ".join(words[:2]) if group and len(words) > 1 else name
    if group and words[1:] in ([], ["-h"], ["--help"]):
        print(_overview(group))
        return 0
    CommandParser("arcgym", None).error(f"unknown subcommand '{given}'. {did_you_mean(given, group or COMMANDS)}")


def run_command(name: str, argv: Sequence[str] | None = None, prog: str | None = None) -> int:
    """Run one subcommand and return its exit status.

    Args:
        name: A key of :data:`COMMANDS`.
        argv: Its arguments; None takes those of the process.
        prog: Name to show in messages; None takes ``arcgym <name>``.
    """
    prog = prog or f"arcgym {name}"
    try:
        module = importlib.import_module(COMMANDS[name][0])
        accepts = (getattr(module, mark, False) for mark in ("TAKES_OVERRIDES", "PASSES_ON"))
        parser = CommandParser(prog, module.__doc__, *accepts)
        module.add_arguments(parser)
        args = parser.parse(sys.argv[1:] if argv is None else argv)
        try:
            return int(module.run(args) or 0)
        except UsageError as error:
            parser.error(str(error))
    except KeyboardInterrupt:
        print(f"{prog}: stopped by SIGINT", file=sys.stderr)
        return INTERRUPTED
    except OSError as error:
        if error.errno not in DISK_TROUBLE:
            raise
        print(f"{prog}: error: {os.strerror(error.errno)}{_where(error)}", file=sys.stderr)
        return DISK_FAILED


def run_script(name: str) -> int:
    """Run a subcommand as the script that the process was started with, such as ``train.py``."""
    _end_quickly()
    return _ended(run_command(name, prog=Path(sys.argv[0]).name))


def _where(error: OSError) -> str:
    """Return the file of an error behind a colon; HDF5 names it in its message."""
    found = re.search(r"filename = '([^']+)'", str(error))
    name = error.filename or (found and found[1])
    return f": {name}" if name else ""


def _ended(status: int) -> int:
    """Return the exit status; after trouble with the disk end at once, for HDF5 crashes on what it could not write."""
    if status == DISK_FAILED:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)
    return status


def _end_quickly() -> None:
    """Let the process end without a last search for garbage among the objects of all libraries.

    That search took 1.7 of the 1.8 s that ``import torch, newton, arcgym.envs`` needed to end, on an AMD EPYC.
    """
    atexit.register(gc.freeze)


def _overview(names: Sequence[str] | None = None) -> str:
    """Return the help of ``arcgym`` itself, or of the group that the subcommands ``names`` make."""
    shown = list(COMMANDS if names is None else names)
    width = max(map(len, shown))
    rows = [f"  {name:<{width}}  {COMMANDS[name][1]}" for name in shown]
    return "\n".join(["usage: arcgym <subcommand> [--help] …", "", *rows])
