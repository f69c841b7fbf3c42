# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The page's servers without a browser."""

from __future__ import annotations

import re
from types import SimpleNamespace

import pytest
from small_session import choice

from arcgym.teleop.session import Session


def test_page_can_be_used_before_there_is_a_world(tiny_colon_path, tmp_path) -> None:
    pytest.importorskip("viser")
    from arcgym.teleop.page import Page

    page = Page(Session(choice(tiny_colon_path), tmp_path, {}), "127.0.0.1", 0, None, size=64)
    try:
        camera = SimpleNamespace()
        page._turn(SimpleNamespace(camera=camera), "front")
        page._fade()
        assert camera.look_at == (0.0, 0.0, 0.0) and camera.position == (0.0, 0.62, 0.08)
    finally:
        page.close()


def test_speed_is_measured_without_a_browser(make_session) -> None:
    pytest.importorskip("viser")
    from arcgym.teleop.page import Page

    session = make_session()
    session.speed, session.starts_paused = 2.0, False  # episodes follow each other, as with --seconds
    page = Page(session, "127.0.0.1", 0, None, size=64)
    session.pause(False).result()
    said = page.measure(1.0)
    session.pause(True).result()
    page.close()
    found = re.search(
        r"([\d.]+) control steps/s, ([\d.]+) pictures/s of 64 px; .* (\d+) ms a step .* (\d+) ms a pic", said
    )
    assert found, said
    steps, pictures, stepping, drawing = map(float, found.groups())
    # a thread cannot take more processor time than has passed
    assert steps > 0.0 and pictures > 0.0 and 0.0 < stepping <= 1000.0 / steps * 1.2 and drawing >= 0.0
