# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Scripted experts: they drive robots to the start states and are a baseline. They see what no camera sees: the wall.

``EndoscopeCfg.expert`` names the expert of a robot; one of your own is a subclass of :class:`ExpertBase`.
"""

from typing import TYPE_CHECKING

from arcgym.utils.lazy import lazy_names

if TYPE_CHECKING:
    from arcgym.experts.examiner_expert import ExaminerExpert
    from arcgym.experts.expert_base import ExpertBase, make_expert
    from arcgym.experts.pull_expert import PullExpert
    from arcgym.experts.push_expert import PushExpert

_LAZY = {
    "ExaminerExpert": "arcgym.experts.examiner_expert",
    "ExpertBase": "arcgym.experts.expert_base",
    "PullExpert": "arcgym.experts.pull_expert",
    "PushExpert": "arcgym.experts.push_expert",
    "make_expert": "arcgym.experts.expert_base",
}

__all__ = ["ExaminerExpert", "ExpertBase", "PullExpert", "PushExpert", "make_expert"]

__getattr__ = lazy_names(__name__, _LAZY)
