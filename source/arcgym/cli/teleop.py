# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Steer a robot by hand in the browser, let a policy drive and take over, and record it.

    arcgym teleop --task ARC-Sigmoid-Proximal
    arcgym teleop --task ARC-Cecum-Proximal --start rest --host 0.0.0.0

The page is open to this machine alone, at the address that is printed. --host opens it to others, with a token in the
address; the connection is not encrypted, so prefer an SSH tunnel. Recordings go to --out as they are made.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arcgym.cli.arguments import RunArguments, add_fields, argument, positive, read_fields, whole
from arcgym.utils.errors import UsageError
from arcgym.utils.untrained import UNTRAINED

TAKES_OVERRIDES = True
SIZE, REDUCED_SIZE = 320, 192
"""Width and height of the endoscope's view, and of that of a reduced session [px]."""
UNPACED = 100.0
"""Simulated seconds a second that a measurement aims at: more than any machine reaches."""


@dataclass(frozen=True, kw_only=True)
class TeleopArguments(RunArguments):
    """Arguments of ``arcgym teleop``."""

    driver: str = argument("who drives at first: hand (default), expert, zero, random or policy", "hand")
    patient: str | None = argument("colon: colon_1, a stage file or population:20000 (default: the task's)", None)
    tissue: str | None = argument("preset of the tissue (default: the task's)", None)
    start: str | None = argument("where to begin (default: the task's)", None, choices=("segment", "rest"))
    out: str = argument("folder of the recordings (default: logs/teleop)", "logs/teleop")
    no_gas: bool = argument(
        "leave the gas in the lumen out: no pressure, no insufflation (so with a checkpoint, too)", False
    )
    reduced: bool = argument(
        "faster: no observations, rewards and costs; a smaller view, a colon drawn once a second", False
    )
    host: str = argument("address to listen at (default: 127.0.0.1, this machine alone)", "127.0.0.1", group="page")
    port: int = argument("port (default: 8080; 0 takes a free one)", 8080, type=whole(0), group="page")
    seconds: int | None = argument(
        "measure: run by itself so long, as fast as it goes, say how fast, and close", None, type=positive
    )
    size: int | None = argument(
        "width and height of the endoscope's view [px] (default: 320, reduced 192)", None, type=positive, group="page"
    )


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_fields(parser, TeleopArguments)


def run(namespace: argparse.Namespace) -> None:
    """Open the page until Ctrl-C.

    Raises:
        UsageError: Something is wrong that can be known before.
    """
    args = read_fields(TeleopArguments, namespace)
    from arcgym.rl.agent_checks import check_installed

    check_installed("viser", "teleoperation", extra="teleop")
    if args.driver not in ("hand", "policy", *UNTRAINED):
        raise UsageError(f"--driver is '{args.driver}', expected hand, policy, {', '.join(UNTRAINED)}.")
    if args.reduced and (args.driver == "policy" or args.checkpoint or args.load_run):
        raise UsageError("--reduced leaves out what a policy sees: choose one of --reduced and a policy.")
    serve(args, steers=True)


def make_drivers(args: Any) -> tuple[dict[str, Any], dict[str, Any] | None]:
    """Return makers of policies by name, and what the environment of the trained one was configured with.

    ``policy`` is there where a checkpoint was asked for.
    """
    from arcgym.rl.rollout import UNTRAINED_POLICIES

    drivers: dict[str, Any] = dict(UNTRAINED_POLICIES)
    if not (args.driver == "policy" or args.checkpoint or args.load_run):
        return drivers, None
    from arcgym.cli.task import load_run_cfgs
    from arcgym.rl.params import read_params
    from arcgym.rl.playing import load_policy
    from arcgym.utils.registry import plain_task

    _, agent_cfg, checkpoint = load_run_cfgs(args)
    drivers["policy"] = lambda env: load_policy(env, agent_cfg, checkpoint)
    saved = None if args.no_params else read_params(checkpoint.parent)
    fits = saved is not None and plain_task(saved.task) == plain_task(args.task)
    return drivers, saved.env if saved is not None and fits else None


def serve(args: Any, steers: bool) -> None:
    """Run a session and its page until Ctrl-C; without a hand it goes on by itself."""
    from arcgym.rl.device import choose_device
    from arcgym.rl.preflight import check_environment
    from arcgym.teleop.choices import Choice, make_cfg
    from arcgym.teleop.session import Session

    drivers, settings = make_drivers(args)
    choice = Choice(
        args.task, _patient(args.patient), args.tissue, args.start, args.driver, choose_device(args.device),
        args.seed or 0,
        overrides=tuple(text for text in args.overrides if text.startswith("env.")), settings=settings,
        num_envs=args.num_envs or 1, reduced=getattr(args, "reduced", False),
        gas=steers and not args.no_gas and "policy" not in drivers,
    )  # fmt: skip
    out = Path(args.out)
    check_environment(make_cfg(choice, out)[1], args.device, [out])
    session = Session(choice, out, drivers)
    session.needs_page = session.starts_paused = steers and args.seconds is None
    show(session, args, steers)


def _patient(name: str | None) -> str | None:
    from arcgym.assets.patient_files import named_colon

    try:
        return None if name is None else named_colon(name)
    except ValueError as error:
        raise UsageError(f"--patient: {error}") from error


def show(session: Any, args: Any, steers: bool) -> None:
    """Show a session, or a player, until Ctrl-C."""
    import secrets
    import signal
    import time

    from arcgym.teleop.gate import LOOPBACK
    from arcgym.teleop.page import Page

    token = None if args.host in LOOPBACK else secrets.token_urlsafe(16)
    size = args.size or (REDUCED_SIZE if getattr(args, "reduced", False) else SIZE)
    try:
        page = Page(session, args.host, args.port, token, size, steers)
    except OSError as error:
        raise UsageError(f"--port {args.port} at {args.host} cannot be opened: {error}.") from error
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # a polite kill ends as Ctrl-C does
    session.start()
    print(f"page: {page.gate.url}", flush=True)
    try:
        if getattr(args, "seconds", None):
            session.speed = UNPACED
            print(page.measure(args.seconds))
        else:
            while True:
                time.sleep(0.5)
    except KeyboardInterrupt:
        print("closing; what is under way is saved")
    finally:
        page.close()
        session.close()
