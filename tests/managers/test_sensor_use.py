# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

from functools import partial

from arcgym.managers import reads_no_sensor
from arcgym.managers.sensor_use import may_read_sensors


@reads_no_sensor
class Blind:
    def __call__(self) -> bool:
        return True


class Seeing(Blind):
    pass


@reads_no_sensor
def blind() -> bool:
    return True


def test_functions_and_classes_that_were_marked_read_no_sensor() -> None:
    assert not may_read_sensors(blind) and not may_read_sensors(Blind())


def test_all_others_may_also_subclasses_and_wrapped_functions() -> None:
    assert all(may_read_sensors(term) for term in (Seeing(), partial(blind), lambda: True))
