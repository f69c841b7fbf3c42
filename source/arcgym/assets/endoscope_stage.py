# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""The USD stage of an endoscope: the data class and the functions that write and read it."""

from __future__ import annotations

from arcgym.assets.endoscope_reader import EndoscopeStage, read_endoscope
from arcgym.assets.endoscope_writer import (
    ENDOSCOPE_PATH,
    JOINTS_PATH,
    LINKS_PATH,
    ROOT_JOINT_PATH,
    TURNS,
    author_endoscopes,
    link_name,
    turn_name,
    write_endoscope,
)

__all__ = [
    "ENDOSCOPE_PATH",
    "JOINTS_PATH",
    "LINKS_PATH",
    "ROOT_JOINT_PATH",
    "TURNS",
    "EndoscopeStage",
    "author_endoscopes",
    "link_name",
    "read_endoscope",
    "turn_name",
    "write_endoscope",
]
