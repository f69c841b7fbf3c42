# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""References of configuration classes, on two written here."""

from __future__ import annotations

from arcgym.utils import MISSING, configclass
from arcgym.utils.config_reference import FieldReference, fields_of, leaves_of


@configclass
class LampCfg:
    gain: float = 1.0 / 3.0
    """Brightness;
    one is full."""

    color: str = MISSING


@configclass
class RoomCfg(LampCfg):
    gain: float = 2.0
    lamp: LampCfg = LampCfg(color="red")
    """The lamp."""
    others = {"left": LampCfg(color="blue")}
    sizes: dict = {"door": 2}


def test_fields_have_type_default_and_docstring_of_the_nearest_class() -> None:
    assert fields_of(LampCfg) == [
        FieldReference("gain", "float", "0.333333", "Brightness; one is full."),
        FieldReference("color", "str", "required", ""),
    ]
    assert fields_of(RoomCfg)[0] == FieldReference("gain", "float", "2", "Brightness; one is full.")
    assert fields_of(RoomCfg)[2] == FieldReference("lamp", "LampCfg", "LampCfg()", "The lamp.")


def test_leaves_are_the_paths_of_the_command_line() -> None:
    leaves = {path: value for path, value, _ in leaves_of(RoomCfg(), "env")}
    assert leaves == {
        "env.gain": "2",
        "env.color": "required",
        "env.lamp.gain": "0.333333",
        "env.lamp.color": "'red'",
        "env.others.left.gain": "0.333333",
        "env.others.left.color": "'blue'",
        "env.sizes": "{'door': 2}",
    }
    assert [text for path, _, text in leaves_of(RoomCfg(), "env") if path == "env.lamp.gain"] == [
        "Brightness; one is full."
    ]
