# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Settings that experts take."""

from __future__ import annotations

import pytest

from arcgym.benchmarks.clinical.record import RecordedExaminer, RecordedPushExpert
from arcgym.experts import ExaminerExpert, PushExpert
from arcgym.experts.expert_base import ExpertBase, setting_names


@pytest.mark.parametrize(("recorded", "plain"), [(RecordedPushExpert, PushExpert), (RecordedExaminer, ExaminerExpert)])
def test_an_expert_that_hands_settings_on_takes_those_of_its_base(
    recorded: type[ExpertBase], plain: type[ExpertBase]
) -> None:
    assert "speed" in setting_names(recorded)
    assert setting_names(recorded) == setting_names(plain)


def test_a_function_takes_what_it_names() -> None:
    def made(scene: object, speed: float) -> ExpertBase: ...

    assert setting_names(made) == ["speed"]
