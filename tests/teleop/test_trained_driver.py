# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A trained policy drives a session in the world that it was trained in, and a hand takes over."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import urllib.request
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_session import choice, until

from arcgym.cli.main import main
from arcgym.cli.teleop import TeleopArguments, make_drivers
from arcgym.managers import Episode
from arcgym.teleop.session import HAND, Session

SMALL = ["agent.num_steps_per_env=4", "agent.algorithm.num_mini_batches=2", "env.scene.camera.width=36"]
SMALL += ["env.scene.camera.height=36", "env.start=rest"]


@pytest.fixture(scope="module")
def checkpoint(tiny_colon_path, tmp_path_factory) -> Path:
    """A policy after one update in the tiny colon."""
    folder = tmp_path_factory.mktemp("run")
    words = ["--task", "ARC-Splenic-Proximal", "--num_envs", "1", "--device", "cpu", "--max_iterations", "1"]
    colon = f"env.scene.colon.usd_path={tiny_colon_path}"
    assert main(["train", *words, "--log_dir", str(folder), colon, *SMALL]) == 0
    return next(folder.glob("model_*.pt"))


@pytest.mark.slow
def test_a_trained_policy_drives_until_a_hand_takes_over(checkpoint, tiny_colon_path, tmp_path) -> None:
    args = TeleopArguments(task="ARC-Splenic-Proximal", checkpoint=str(checkpoint), driver="policy")
    drivers, settings = make_drivers(args)
    session = Session(choice(tiny_colon_path, driver="policy", settings=settings), tmp_path, drivers)
    session.needs_page, session.speed = False, 100.0
    session.start()
    try:
        until(lambda: session.status.message == "policy drives" or session.status.state == "failed")
        assert session.status.driver == "policy", session.status.message
        step(session, 4)
        session.hand.command("test", np.array([-0.5, 0.0, 0.0, 0.0]))
        step(session, 3)
        episode = Episode.load(session.save().result())
    finally:
        session.close()
    assert session.status.driver == HAND and episode.info["interventions"] == 1
    assert episode.data["hand/leads"].tolist() == [0] * 4 + [1] * 3
    np.testing.assert_allclose(episode.data["actions"][4:], [[-0.5, 0.0, 0.0, 0.0]] * 3)
    assert np.abs(episode.data["actions"][:4]).max(axis=1).min() > 0.0  # the network's, which are never quite zero


@pytest.mark.slow
def test_a_run_is_looked_at_in_the_browser_and_cannot_be_steered(checkpoint, tmp_path) -> None:
    pytest.importorskip("viser")
    from websockets.sync.client import connect

    command = [sys.executable, "-u", "-m", "arcgym", "view", str(checkpoint.parent), "--port", "0", "--size", "64"]
    with subprocess.Popen(
        [*command, "--device", "cpu"], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as shown:
        try:
            address = next(line for line in shown.stdout if line.startswith("page: ")).split()[1]
            assert b"<title>ARCGym</title>" in urllib.request.urlopen(address, timeout=30).read()
            with connect(address.replace("http", "ws").rstrip("/") + "/hand") as page:
                until(lambda: ask(page, keys=["KeyS"])["steps"] >= 3, 120.0)
        finally:
            shown.send_signal(signal.SIGINT)
            said = shown.stdout.read()
    assert shown.returncode == 0 and "closing" in said
    (path,) = (tmp_path / "logs" / "view").glob("teleop_*.hdf5")
    leads = Episode.load(path).data["hand/leads"]
    assert len(leads) >= 3 and not leads.any()  # the policy led, whatever key was held


def ask(page: Any, **said: Any) -> dict[str, Any]:
    """Send a page's message and return the answer."""
    page.send(json.dumps({"n": 1, **said}))
    return json.loads(page.recv(timeout=30.0))


def step(session: Session, count: int) -> None:
    """Make some steps, one by one."""
    for _ in range(count):
        before = session.status.steps
        session.hand.touch()
        session.single_step().result()
        until(lambda before=before: session.status.steps == before + 1)
