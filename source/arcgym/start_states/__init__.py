# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Start states: complete states of scope and wall in which the tip is at the start of a segment.

The shipped colons have some beside their stages. All others are made when they are first needed, by the robot's
scripted expert, and kept in the cache folder under a hash of all that they depend on.
"""

from typing import TYPE_CHECKING

from arcgym.utils.lazy import lazy_names

if TYPE_CHECKING:
    from arcgym.start_states.drive import Drive
    from arcgym.start_states.errors import StartStateError
    from arcgym.start_states.find import ensure
    from arcgym.start_states.making import make

_LAZY = {
    "Drive": "arcgym.start_states.drive",
    "StartStateError": "arcgym.start_states.errors",
    "ensure": "arcgym.start_states.find",
    "make": "arcgym.start_states.making",
}

__all__ = ["Drive", "StartStateError", "ensure", "make"]

__getattr__ = lazy_names(__name__, _LAZY)
