# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A hand's session: steering, marks, undo, taking over, saving, and replays of what was saved."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from small_session import until

from arcgym.cli.main import main
from arcgym.managers import Episode, episode_paths, save_episode
from arcgym.recordings.pieces import mark_steps
from arcgym.teleop.choices import Choice, make_cfg
from arcgym.teleop.readouts import readouts
from arcgym.teleop.session import HAND, Session
from arcgym.utils.errors import UsageError
from arcgym.viewers.palette import FORCE_TIERS


def drive(session: Session, steps: int, *command: float) -> None:
    """Make steps with a command, one by one."""
    for _ in range(steps):
        before = session.status.steps
        session.hand.touch()
        session.hand.command("test", np.array(command))
        session.single_step().result()
        until(lambda before=before: session.status.steps == before + 1)
    session.hand.drop("test")


@pytest.fixture(scope="module")
def session(make_session) -> Session:
    return make_session()


@pytest.fixture(autouse=True)
def fresh(session) -> None:
    session.start_anew(keep=False).result()


def test_a_command_moves_the_scope_and_none_leaves_it(session) -> None:
    assert session.status.state == "paused" and session.hand.axes == ("insertion", "roll", "pitch", "yaw")
    start = session.frame.info.inserted
    drive(session, 5, 1.0, 0.0, 0.0, 0.0)
    # 50 mm/s for half a second
    assert session.frame.info.inserted - start == pytest.approx(0.025, abs=0.006)
    there = session.frame.info.inserted
    drive(session, 3, 0.0, 0.0, 0.0, 0.0)
    assert session.frame.info.inserted == pytest.approx(there, abs=0.003) and session.status.steps == 8


def test_undo_goes_back_completely_and_the_recording_replays(session) -> None:
    drive(session, 12, 1.0, 0.3, 0.2, 0.0)
    session.mark("bend").result()
    at_mark, reward = session.frame, session.frame.info.reward
    drive(session, 9, 1.0, -1.0, 1.0, 0.5)
    gone = session.frame
    assert session.undo().result() == "bend" and session.status.steps == 12
    np.testing.assert_array_equal(session.frame.nodal_pos, at_mark.nodal_pos)
    np.testing.assert_array_equal(session.frame.link_pos, at_mark.link_pos)
    assert (session.frame.info.time, session.frame.info.reward) == (at_mark.info.time, reward)
    drive(session, 9, 1.0, -1.0, 1.0, 0.5)
    np.testing.assert_array_equal(session.frame.link_pos, gone.link_pos)
    session.undo().result()
    drive(session, 14, 0.5, 0.5, -0.4, 0.2)
    path = session.save().result()
    episode = Episode.load(path)
    assert episode.info["length"] == 26 and episode.info["undone"] == 2
    assert [(mark["name"], mark["step"]) for mark in episode.info["marks"]] == [("start", 0), ("bend", 12)]
    np.testing.assert_allclose(episode.data["actions"][12:, 0], 0.5)
    assert main(["replay", str(path), "--device", "cpu"]) == 0
    assert mark_steps(episode) == [0, 12] and episode.data["marks/state/joint_q"].shape[0] == 2
    assert main(["replay", str(path), "--device", "cpu", "--pieces"]) == 0


def test_a_piece_that_was_not_recorded_so_shows(session, capsys) -> None:
    drive(session, 3, 1.0, 0.0, 0.0, 0.0)
    session.mark().result()
    drive(session, 6, 1.0, 0.0, 0.0, 0.0)
    episode = Episode.load(session.save().result())
    episode.data["actions"][3:, 0] = 0.0
    changed = save_episode(episode, session.out / "changed_000000.hdf5")
    assert main(["replay", str(changed), "--device", "cpu", "--pieces"]) == 1
    # 0.6 s at 50 mm/s are missing from the second piece alone
    said = capsys.readouterr().out
    assert "steps 0 to 3: the same, bit for bit" in said and "1 of 2 pieces the same" in said
    del episode.data["marks/step"]
    with pytest.raises(UsageError, match="no marks with complete states"):
        mark_steps(episode)


def test_the_first_of_two_worlds_is_steered_and_replays_alone(make_session) -> None:
    two = make_session(num_envs=2)
    inserted = two.env.scene["endoscope"].data.inserted_length.clone()
    drive(two, 6, 1.0, 0.0, 0.3, 0.0)
    moved = two.env.scene["endoscope"].data.inserted_length - inserted
    assert moved[0] > 0.02 and abs(moved[1]) < 0.003
    two.mark().result()
    two.give("expert").result()
    drive(two, 4, 0.0, 0.0, 0.0, 0.0)
    assert (two.env.scene["endoscope"].data.inserted_length - inserted)[1] > 0.005
    two.undo().result()
    drive(two, 2, 0.5, 0.0, 0.0, 0.0)
    path = two.save().result()
    assert Episode.load(path).info["length"] == 8 and main(["replay", str(path), "--device", "cpu"]) == 0


def test_a_reduced_session_records_and_replays(make_session) -> None:
    reduced = make_session(reduced=True)
    drive(reduced, 6, 1.0, 0.0, 0.3, 0.0)
    assert reduced.frame.progress > 0.0 and not reduced.env.obs_buf
    reduced.give("expert").result()
    drive(reduced, 3, 0.0, 0.0, 0.0, 0.0)
    assert main(["replay", str(reduced.save().result()), "--device", "cpu"]) == 0


def test_what_follows_a_save_is_a_recording_of_its_own(session) -> None:
    drive(session, 4, 1.0, 0.0, 0.0, 0.0)
    first = session.save().result()
    with pytest.raises(UsageError, match="nothing to save"):
        session.save().result()
    drive(session, 3, 0.5, 0.0, 0.0, 0.0)
    second = session.save().result()
    assert first != second and [Episode.load(path).info["length"] for path in (first, second)] == [4, 3]
    assert main(["replay", str(second), "--device", "cpu"]) == 0


def test_a_hand_takes_over_from_a_policy_and_that_is_recorded(session) -> None:
    session.give("expert").result()
    start = session.frame.info.inserted
    drive(session, 6, 0.0, 0.0, 0.0, 0.0)
    assert session.frame.info.inserted > start + 0.01 and session.status.driver == "expert"
    drive(session, 2, -0.5, 0.0, 0.0, 0.0)
    assert session.status.driver == HAND and session.status.interventions == 1
    session.give("zero").result()
    drive(session, 1, 0.0, 0.0, 0.0, 0.0)
    episode = Episode.load(session.save().result())
    assert episode.data["hand/leads"].tolist() == [0] * 6 + [1] * 2 + [0]
    np.testing.assert_allclose(episode.data["actions"][6:8, 0], -0.5)
    assert episode.info["interventions"] == 1
    session.give(HAND).result()


def test_discarding_leaves_no_file_and_starting_anew_saves(session) -> None:
    before = len(episode_paths(session.out))
    drive(session, 2, 1.0, 0.0, 0.0, 0.0)
    session.start_anew(keep=False).result()
    assert len(episode_paths(session.out)) == before and session.status.steps == 0
    drive(session, 2, 1.0, 0.0, 0.0, 0.0)
    session.start_anew().result()
    assert len(episode_paths(session.out)) == before + 1 and session.status.marks == ("start",)


def test_it_runs_and_pauses(session) -> None:
    session.pause(False).result()
    until(lambda: session.status.steps > 5)
    assert session.status.state == "running"
    session.pause(True).result()
    steps = session.status.steps
    session.ask(lambda: None).result()
    assert session.status.steps == steps and session.status.state == "paused"


def test_nothing_moves_without_a_page(session) -> None:
    session.needs_page = True
    session.hand.command("test", np.array([1.0, 0.0, 0.0, 0.0]))
    session.hand._alive -= 10.0
    session.pause(False).result()
    until(lambda: session.status.state == "waiting")
    assert session.status.steps == 0 and not session.hand.value().any()
    session.hand.touch()
    until(lambda: session.status.steps > 0)
    session.needs_page = False


def test_the_end_of_the_task_pauses_and_one_may_go_on(session) -> None:
    session.hand.command("test", np.array([1.0, 0.0, 0.0, 0.0]))
    session.pause(False).result()
    until(lambda: session.hand.touch() or session.status.state == "ended")
    assert "reached the goal" in session.status.message
    steps = session.status.steps
    drive(session, 2, -1.0, 0.0, 0.0, 0.0)
    assert session.status.steps == steps + 2


def test_a_wrong_choice_leaves_the_session_as_it_was(session) -> None:
    drive(session, 2, 1.0, 0.0, 0.0, 0.0)
    with pytest.raises(UsageError, match="ARC-Nowhere-Proximal"):
        session.load(dataclasses.replace(session.status.choice, task="ARC-Nowhere-Proximal")).result()
    assert session.status.steps == 2 and "ARC-Nowhere" in session.status.message
    with pytest.raises(UsageError, match="no driver 'chauffeur'; there are hand, zero"):
        session.give("chauffeur").result()


def test_another_robot_can_be_loaded_and_what_was_recorded_is_saved(session, make_session) -> None:
    other = make_session("Capsule")
    drive(other, 2, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    other.load(session.status.choice).result()
    assert other.hand.axes == session.hand.axes and len(episode_paths(other.out)) == 1
    drive(other, 2, 1.0, 0.0, 0.0, 0.0)
    assert other.status.steps == 2


def test_gas_is_felt_undone_and_replayed(make_session, capsys) -> None:
    session = make_session(gas=True)
    assert session.hand.axes[-1] == "insufflation"
    drive(session, 4, 0.0, 0.0, 0.0, 0.0, 1.0)
    session.mark().result()
    high = session.frame.lumen_pressure
    assert high > 21.0 * 133.3
    drive(session, 4, 0.5, 0.0, 0.0, 0.0, -1.0)
    assert session.frame.lumen_pressure < high - 300.0
    session.undo().result()
    assert session.frame.lumen_pressure == high
    drive(session, 6, 1.0, 0.2, 0.0, 0.0, -0.5)
    path = session.save().result()
    episode = Episode.load(path)
    assert episode.settings["gas"] == "commanded" and episode.data["actions"].shape == (10, 5)
    assert episode.data["wall/lumen_pressure"][3] == np.float32(high)
    assert main(["replay", str(path), "--device", "cpu"]) == 0
    assert "the same, bit for bit" in capsys.readouterr().out
    assert main(["replay", str(path), "--device", "cpu", "--pieces"]) == 0


def test_without_gas_the_page_says_so(session) -> None:
    assert np.isnan(session.frame.lumen_pressure)
    assert "no gas" in readouts(session.frame, session.status, FORCE_TIERS, 0.0, 0.0)
    blown = dataclasses.replace(session.frame, lumen_pressure=40.0 * 133.322)
    assert "40.0 mmHg" in readouts(blown, session.status, FORCE_TIERS, 0.0, 0.0)


def test_a_session_has_gas_where_it_can(tmp_path) -> None:
    def gas(*overrides: str) -> str:
        return make_cfg(Choice("ARC-Splenic-Proximal", gas=True, overrides=overrides), tmp_path)[1].gas

    assert gas() == "commanded" and gas("env.gas=none") == "none" and gas("env.gas=present") == "present"
    assert gas("env.scene.colon.wall_model=solid") == "none" and gas("env.sim.solver=newton") == "none"
    assert make_cfg(Choice("ARC-Splenic-Proximal"), tmp_path)[1].gas == "none"
