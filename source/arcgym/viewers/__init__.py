# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures and videos of the environments for people to look at; nothing here is seen by a policy."""

from arcgym.viewers.outside_view import OutsideView, OutsideViewCfg
from arcgym.viewers.two_pane import TwoPaneCfg, TwoPaneView
from arcgym.viewers.video import VideoRecorder

__all__ = ["OutsideView", "OutsideViewCfg", "TwoPaneCfg", "TwoPaneView", "VideoRecorder"]
