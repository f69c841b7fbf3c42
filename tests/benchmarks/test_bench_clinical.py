# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Figures of drawn insertions that can be counted by hand, and the table of them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import torch

from arcgym.anatomy.segments import SEGMENTS
from arcgym.benchmarks.clinical.figures import Insertion, figures, read
from arcgym.benchmarks.clinical.record import FIELDS, Diary, lineage, past_code
from arcgym.benchmarks.clinical.table import table, write_table
from arcgym.envs.mdp.shaft_metrics import LOOPS


def insertion(arrived: bool = True, count: int = 20, **fields: object) -> Insertion:
    """An insertion of 10 cm/s along the sigmoid, whose fields are given as one value or one a step."""
    steps = np.zeros((count, len(FIELDS)), np.float32)
    steps[:, FIELDS.index("went_on")] = 1.0
    steps[:, FIELDS.index("segment")] = SEGMENTS.index("sigmoid")
    steps[:, FIELDS.index("inserted")] = steps[:, FIELDS.index("arc")] = 0.01 * np.arange(1, count + 1)
    for name, value in fields.items():
        steps[:, FIELDS.index(name)] = value
    return Insertion({"arrived": arrived, "patient": "a"}, steps)


def test_a_history_follows_the_entries_that_were_taken_over() -> None:
    before = np.array([-1, -1, 0, 1, 2, 2])  # two worlds, three steps; the second took over the first after two steps
    assert lineage(before, 5) == [0, 2, 5]
    assert lineage(before, 3) == [1, 3]


def test_a_history_goes_on_from_that_of_an_earlier_call() -> None:
    diary = Diary.__new__(Diary)
    diary._past = []
    rows = torch.arange(4.0).repeat_interleave(len(FIELDS)).view(2, 2, -1)  # entries 0 to 3: two worlds, two steps
    diary._rows, diary._before = list(rows), [torch.tensor([past_code(1), -1]), torch.tensor([0, 0])]
    first = diary.add_past([np.full((3, len(FIELDS)), value, np.float32) for value in (8.0, 9.0)])
    assert first == 0 and past_code(past_code(1)) == 1
    assert [one[:, 0].tolist() for one in diary.histories([3, 1, past_code(0)])] == [
        [9.0, 9.0, 9.0, 0.0, 3.0],
        [1.0],
        [8.0, 8.0, 8.0],
    ]
    assert diary.add_past([rows[0].numpy()]) == 2


def test_forces_leave_out_the_step_after_a_change_of_worlds() -> None:
    push = np.array([50.0] + [11.0] * 4 + [-12.0] + [0.0] * 14)
    one = insertion(push=push, went_on=[0.0] + [1.0] * 19, torque=[0.0] * 18 + [-0.4, 0.3])
    found = figures([one])
    assert (found["peak_push"], found["peak_pull"]) == (11.0, 12.0)
    assert found["time_above_10_N"] == pytest.approx(5 / 19)
    assert (found["peak_torque"], found["peak_torque_back"]) == (pytest.approx(0.3), pytest.approx(0.4))


def test_the_tip_is_placed_when_60_cm_are_first_inside() -> None:
    inside = 0.05 * np.arange(1, 21)  # 0.60 m in the 12th step
    segments = {"sigmoid": 11, "descending": 3, "splenic": 0}
    ends = [insertion(inserted=inside, segment=_then(name, SEGMENTS.index(name), at)) for name, at in segments.items()]
    short = insertion(inserted=0.3)
    assert figures([*ends, short])["place_at_60_cm"] == {
        "of": 3,
        "past": pytest.approx(1 / 3),
        "descending": pytest.approx(1 / 3),
        "sigmoid": pytest.approx(1 / 3),
    }
    assert figures([short])["place_at_60_cm"] is None


def _then(name: str, code: int, at: int) -> np.ndarray:
    """The segment after so many steps of the rectum."""
    return np.where(np.arange(20) >= at, code, 0)


def test_a_loop_counts_from_one_second_on() -> None:
    n, alpha = LOOPS.index("n"), LOOPS.index("alpha")
    lasting = insertion(loop=[n] * 10 + [0] * 10)
    brief = insertion(loop=[alpha] * 9 + [0] * 11)
    assert figures([lasting, brief])["loops"] == {"any": 0.5, "n": 0.5, "alpha": 0.0, "reverse_alpha": 0.0}


def test_the_colon_is_gathered_where_less_scope_is_inside_than_its_length() -> None:
    arrived = insertion(arc=0.1 * np.arange(1, 21), inserted=0.06 * np.arange(1, 21))
    stuck = insertion(arrived=False)
    found = figures([arrived, stuck])
    assert (found["arrived"], found["gathered"]) == (1, pytest.approx(0.6))
    assert found["shaft_at_cecum"] == pytest.approx(1.2)
    assert found["gathered_at_furthest"] == pytest.approx(0.8)  # of 0.6 and 1
    assert found["time"] == pytest.approx(2.0)
    assert figures([stuck])["gathered"] is None and figures([stuck])["gathered_most"] is None
    pulled = insertion(
        segment=_then("splenic", SEGMENTS.index("splenic"), 10), arc=0.9, inserted=[0.4] * 15 + [0.6] * 5
    )
    assert figures([pulled, stuck])["gathered_most"] == pytest.approx(0.4 / 0.9)


def test_demands_are_placed_by_the_tip_in_the_tenth_of_the_highest_tension() -> None:
    tension = [9.0] + [0.0] * 18 + [8.0]
    places = [SEGMENTS.index("transverse")] + [SEGMENTS.index("sigmoid")] * 19
    found = figures([insertion(mesentery=tension, segment=places, loop=[1] + [0] * 19)])
    assert found["demands"] == {"sigmoid": 0.5, "descending": 0.0, "splenic": 0.0, "transverse": 0.5, "proximal": 0.0}
    assert found["time_by_place"]["sigmoid"] == pytest.approx(0.95)
    assert found["demands_looped"] == 0.5 and found["tension"] == pytest.approx(8.0)


def test_the_table_puts_ours_beside_theirs(tmp_path: Path) -> None:
    one = insertion(push=20.0)
    (tmp_path / "clinical").mkdir()
    np.savez(tmp_path / "clinical" / "a.npz", steps=one.steps, about=np.array(json.dumps(one.about)))
    assert [each.about["patient"] for each in read(tmp_path / "clinical")] == ["a"]
    lines = write_table(tmp_path).splitlines()
    assert lines[0] == "|  | Published | `clinical` | Source |"
    assert "| Push or pull over 10 N | 5 % of the time | 100 % | Appleyard et al. 2000, 21 examinations |" in lines
    assert json.loads((tmp_path / "figures.json").read_text())["clinical"]["peak_push"] == 20.0
    assert table({}).splitlines()[0] == "|  | Published | Source |"


def test_a_folder_without_insertions_is_told(tmp_path: Path) -> None:
    (tmp_path / "clinical").mkdir()
    given_up = insertion(count=1, went_on=0.0)
    np.savez(tmp_path / "clinical" / "a.npz", steps=given_up.steps, about=np.array(json.dumps(given_up.about)))
    with pytest.raises(ValueError, match="there are no insertions in"):
        write_table(tmp_path)
