# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures and videos of the environments for people to look at; nothing here is seen by a policy."""

from .outside_view import OutsideView, OutsideViewCfg
from .two_pane import TwoPaneCfg, TwoPaneView
from .video import VideoRecorder

__all__ = ["OutsideView", "OutsideViewCfg", "TwoPaneCfg", "TwoPaneView", "VideoRecorder"]
