# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What ``arcgym view`` shows of a recording and of a stage, and how it is drawn."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from small_session import until

from arcgym.cli.main import main
from arcgym.cli.view import ViewArguments, make_player
from arcgym.managers import Episode, save_episode
from arcgym.teleop.looker import Looker, link_mesh
from arcgym.teleop.readouts import readouts
from arcgym.viewers.palette import FORCE_TIERS


@pytest.fixture(scope="module")
def recorded(make_session) -> SimpleNamespace:
    """Six steps by hand: the file, and the last frame that the session showed."""
    session = make_session()
    for _ in range(6):
        session.hand.touch()
        session.hand.command("test", np.array([1.0, 0.2, 0.4, 0.0]))
        before = session.status.steps
        session.single_step().result()
        until(lambda before=before: session.status.steps == before + 1)
    shown = session.frame
    return SimpleNamespace(path=session.save().result(), frame=shown)


@pytest.fixture(scope="module")
def player(recorded):
    player = make_player(recorded.path, ViewArguments(device="cpu"))
    yield player
    player.env.close()


def test_recording_shows_what_the_session_showed(recorded, player) -> None:
    player.seek(5)
    now, then = player.frame, recorded.frame
    for name in ("nodal_pos", "link_pos", "link_quat"):
        np.testing.assert_array_equal(getattr(now, name), getattr(then, name))
    np.testing.assert_allclose(now.window_force, then.window_force, atol=1e-5)
    np.testing.assert_allclose(now.camera_pose, then.camera_pose, atol=2e-5)
    assert now.info.time == pytest.approx(then.info.time) and now.info.segment == then.info.segment
    assert now.progress == pytest.approx(then.progress) and now.tier == then.tier
    assert now.wall_strain == pytest.approx(then.wall_strain) and then.wall_strain > 0.0
    assert now.anchor_tension == pytest.approx(then.anchor_tension)


def test_playing_ends_with_the_last_frame_and_begins_again(player) -> None:
    player.seek(0)
    player.speed = 50.0
    player.start()
    until(lambda: player.index == 5 and player.status.state == "paused")
    player.play(True)
    assert player.index == 0
    until(lambda: player.index == 5)
    player.seek(99)
    assert player.index == 5


def test_pictures_and_surface_follow_the_frames(player) -> None:
    looker = Looker(player.env, FORCE_TIERS, 48)
    player.seek(0)
    first, wall = looker.picture(player.frame), looker.surface(player.frame)
    player.seek(5)
    last = looker.picture(player.frame)
    assert first.shape == (48, 48, 3) and np.abs(first.astype(int) - last).mean() > 2.0
    assert wall.shape == (len(player.env.scene["colon"].patients[0].visual.points), 3)
    assert looker.link_colors(player.frame).shape == (len(player.frame.link_pos), 3)
    np.testing.assert_array_equal(looker.picture(player.frame), last)


def test_links_are_closed_and_look_outwards() -> None:
    vertices, faces = link_mesh()
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    corners = vertices[faces]
    volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6.0
    assert 3.0 < volume < 3.6  # a cylinder of radius and length one has pi


def test_numbers_name_force_and_tier(player) -> None:
    text = readouts(player.frame, player.status, FORCE_TIERS, 0.0123, 9.0)
    assert "force on tip" in text and player.frame.tier in text and "12 ms" in text
    assert f"{100 * player.frame.wall_strain:.1f} %" in text and f"{player.frame.anchor_tension:.2f} N" in text
    assert "&lt;b&gt;" in readouts(None, SimpleNamespace(state="x", driver="<b>", message=""), FORCE_TIERS, 0.0, 0.0)


def test_a_stage_is_walked_through(tiny_colon_path) -> None:
    player = make_player(tiny_colon_path, ViewArguments(device="cpu", overrides=["env.scene.camera.width=36"]))
    first, last = (player._make(step) for step in (0, player.count - 1))
    # a straight tube of 200 mm along Z, from 20 mm to 40 mm before its end
    np.testing.assert_allclose(first.camera_pose[:3], [0.0, 0.0, 0.02], atol=1e-3)
    assert 0.15 < last.camera_pose[2] < 0.165 and (first.info.segment, last.info.segment) == ("rectum", "splenic")
    player.env.close()


def test_what_cannot_be_shown_is_named(tmp_path, capsys) -> None:
    bare = save_episode(Episode({"actions": np.zeros((2, 4))}, {"length": 2}), tmp_path / "bare_000000.hdf5")
    for what, message in (
        (tmp_path / "none", "There is no"),
        (bare, "lacks forces/tip"),
        (tmp_path, "no folder of a run"),
    ):
        with pytest.raises(SystemExit):
            main(["view", str(what)])
        assert message in capsys.readouterr().err
