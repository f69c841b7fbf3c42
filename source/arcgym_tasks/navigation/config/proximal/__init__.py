# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Registers ``ARC-{Rectum,Sigmoid,Descending,Splenic}-Proximal`` and their ``-Play`` variants."""

from __future__ import annotations

from arcgym_tasks.navigation.registration import register_robot

register_robot("Proximal", package=__name__)
