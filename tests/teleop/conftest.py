# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A session in the tiny colon, with small pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest
from small_session import choice, until

import arcgym_tasks  # noqa: F401
from arcgym.rl.rollout import UNTRAINED_POLICIES
from arcgym.teleop.session import Session


@pytest.fixture(scope="session")
def make_session(tiny_colon_path, tmp_path_factory) -> Iterator[Callable[..., Session]]:
    """Starts sessions, which run as fast as they can and need no page, and closes them at the end."""
    made: list[Session] = []

    def make(robot: str = "Proximal", **changes) -> Session:
        session = Session(
            choice(tiny_colon_path, robot, **changes), tmp_path_factory.mktemp("teleop"), UNTRAINED_POLICIES
        )
        session.needs_page, session.speed = False, 100.0
        session.start()
        until(lambda: session.status.state in ("paused", "failed"))
        made.append(session)
        return session

    yield make
    for session in made:
        session.close()
