# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures and videos of the environments for people to look at; nothing here is seen by a policy."""

from typing import TYPE_CHECKING

from arcgym.utils.lazy import lazy_names
from arcgym.viewers.viewer_cfg import OutsideViewCfg, ViewerCfg

if TYPE_CHECKING:
    from arcgym.viewers.outside_view import OutsideView
    from arcgym.viewers.two_pane import TwoPaneView
    from arcgym.viewers.video import VideoRecorder

_LAZY = {
    "OutsideView": "arcgym.viewers.outside_view",
    "TwoPaneView": "arcgym.viewers.two_pane",
    "VideoRecorder": "arcgym.viewers.video",
}

__all__ = ["OutsideView", "OutsideViewCfg", "TwoPaneView", "VideoRecorder", "ViewerCfg"]

__getattr__ = lazy_names(__name__, _LAZY)
