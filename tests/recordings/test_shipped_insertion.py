# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The shipped insertion of the pushed scope, from the anus to the cecum of colon 1."""

from __future__ import annotations

import dataclasses
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

from arcgym.anatomy import read_colon
from arcgym.envs import mdp
from arcgym.managers import Episode
from arcgym.recordings.pieces import SETTINGS, STATE, mark_steps, replay_pieces
from arcgym.recordings.replay import replay
from arcgym.recordings.restoring import mismatches, put_in_state, restored_cfg
from arcgym.utils.paths import assets_dir

FILE = assets_dir() / "colon_1" / "insertions" / "proximal.hdf5"
END = "final_state/"
NEAR = 0.01
"""How far from the recorded place the tip may end after a piece on another processor [m]; the lumen is 40 mm wide."""


@pytest.fixture(scope="module")
def insertion() -> Episode:
    return Episode.load(FILE)


@pytest.fixture(scope="module")
def env(insertion) -> Any:
    task, cfg = restored_cfg(insertion, None, "cpu")
    return gym.make(task, cfg=cfg).unwrapped


def first(episode: Episode, length: int) -> Episode:
    """The first steps of an episode, without its end."""
    data = {name: value[:length] if name in episode.steps else value for name, value in episode.data.items()}
    cut = {name: value for name, value in data.items() if not name.startswith("final_state/")}
    return dataclasses.replace(episode, data=cut, info={**episode.info, "length": length})


def test_it_goes_from_the_anus_into_the_cecum_at_bearable_forces(insertion) -> None:
    bounds, arc = (
        read_colon(assets_dir() / "colon_1" / "colon.usda").segment_bounds(),
        insertion.data["poses/tip_arc_length"],
    )
    assert arc[0] < 0.04 and arc[-1] > bounds["cecum"][0]
    assert all((arc > start).any() for start, _ in bounds.values())  # through every segment
    assert arc.min() > 0.0  # never out
    moved = np.linalg.norm(np.diff(insertion.data["poses/tip_pos_w"], axis=0), axis=1)
    assert moved.max() < 0.08  # one continuous insertion: where a tip springs free round a bend, it moves at 0.5 m/s
    # below what perforates, and the drive's limit
    assert insertion.data["forces/tip_peak"].max() < 14.1 and np.abs(insertion.data["forces/base"]).max() <= 43.0
    assert insertion.info["undone"] > 0 and FILE.stat().st_size < 3e6


def test_it_ends_in_success(insertion, env) -> None:
    """At the last mark, eleven steps before the end, the tip is short of the middle of the cecum."""
    settings = {
        name.removeprefix(SETTINGS): value for name, value in insertion.data.items() if name.startswith(SETTINGS)
    }
    mark = {name.removeprefix(STATE): value[-1] for name, value in insertion.data.items() if name.startswith(STATE)}
    end = {name.removeprefix(END): value for name, value in insertion.data.items() if name.startswith(END)}
    reached = []
    for state in (mark, end):
        put_in_state(env, state, settings)
        reached.append(mdp.success(env).tolist())
    assert reached == [[False], [True]] and mark_steps(insertion)[-1] == insertion.info["length"] - 11


def test_it_is_of_the_stages_that_ship(insertion) -> None:
    _, cfg = restored_cfg(insertion, None, "cpu")
    said = [line for line in mismatches(insertion, cfg) if "stage" in line or "settings" in line]
    assert said == []


def test_its_first_second_replays(insertion, env) -> None:
    short = first(insertion, 10)
    result = replay(env, short)
    off = np.linalg.norm(env.scene["endoscope"].data.tip_pos_w[0].numpy() - insertion.data["poses/tip_pos_w"][9])
    assert result.steps == 10 and (result.is_exact or off < 1e-3), str(result)


@pytest.mark.slow
def test_all_of_it_replays_from_mark_to_mark(insertion, env) -> None:
    pieces = replay_pieces(env, insertion)
    assert [piece.start for piece in pieces] == mark_steps(insertion) and pieces[-1].end == insertion.info["length"]
    for piece in pieces:
        assert piece.is_exact or piece.tip_distance < NEAR, str(piece)


@pytest.mark.slow
def test_it_replays_from_the_anus_on_the_processor_that_it_was_recorded_on(insertion, env) -> None:
    result = replay(env, insertion)
    there, here = insertion.provenance["device_name"], env.provenance()[0]["device_name"]
    if not result.is_exact and there != here:
        pytest.skip(f"recorded on {there}, this is {here}: {result}")
    assert result.is_exact, str(result)
