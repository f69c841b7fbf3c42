# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Learning settings shared by the navigation tasks. Importing this loads none of them."""

from __future__ import annotations

AGENTS: dict[str, str] = {
    "rsl_rl_cfg_entry_point": "arcgym_tasks.navigation.agents.rsl_rl_cfg:NavigationPPORunnerCfg",
}
"""Agent configurations of every navigation task by registry key (``--agent KEY``). A line here is for all tasks."""
