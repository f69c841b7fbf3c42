# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Learning settings shared by the navigation tasks. Importing this loads none of them."""

from __future__ import annotations

_AGENTS = "arcgym_tasks.navigation.agents"

AGENTS: dict[str, str] = {
    "rsl_rl_cfg_entry_point": f"{_AGENTS}.rsl_rl_cfg:NavigationPPORunnerCfg",
    "rsl_rl_ppo_small_cfg_entry_point": f"{_AGENTS}.ppo_variants_cfg:NavigationSmallPPORunnerCfg",
    "rsl_rl_ppo_recurrent_cfg_entry_point": f"{_AGENTS}.ppo_variants_cfg:NavigationRecurrentPPORunnerCfg",
    "rsl_rl_ppo_masked_cfg_entry_point": f"{_AGENTS}.ppo_variants_cfg:NavigationMaskedPPORunnerCfg",
    "rsl_rl_ppo_lagrangian_cfg_entry_point": f"{_AGENTS}.ppo_variants_cfg:NavigationLagrangianPPORunnerCfg",
    "rsl_rl_ppo_predicting_cfg_entry_point": f"{_AGENTS}.ppo_variants_cfg:NavigationPredictingPPORunnerCfg",
    "rsl_rl_ppo_bounded_cfg_entry_point": f"{_AGENTS}.ppo_variants_cfg:NavigationBoundedPPORunnerCfg",
    "rsl_rl_a2c_cfg_entry_point": f"{_AGENTS}.ppo_variants_cfg:NavigationA2CRunnerCfg",
    "rsl_rl_sac_cfg_entry_point": f"{_AGENTS}.sac_cfg:NavigationSACRunnerCfg",
    "rsl_rl_sac_squint_cfg_entry_point": f"{_AGENTS}.sac_cfg:SquintSACRunnerCfg",
    "rsl_rl_sac_paper_cfg_entry_point": f"{_AGENTS}.sac_cfg:PaperSACRunnerCfg",
    "rsl_rl_ppo_teacher_cfg_entry_point": f"{_AGENTS}.imitation_cfg:NavigationTeacherRunnerCfg",
    "rsl_rl_ppo_teacher_rgb_cfg_entry_point": f"{_AGENTS}.imitation_cfg:NavigationRgbTeacherRunnerCfg",
    "rsl_rl_distillation_cfg_entry_point": f"{_AGENTS}.imitation_cfg:NavigationDistillationRunnerCfg",
    "rsl_rl_distillation_recurrent_cfg_entry_point": f"{_AGENTS}.imitation_cfg:RecurrentDistillationRunnerCfg",
    "rsl_rl_distillation_rgb_cfg_entry_point": f"{_AGENTS}.imitation_cfg:RgbDistillationRunnerCfg",
    "rsl_rl_ppo_taught_cfg_entry_point": f"{_AGENTS}.imitation_cfg:NavigationTaughtPPORunnerCfg",
    "rsl_rl_bc_cfg_entry_point": f"{_AGENTS}.imitation_cfg:NavigationBehaviorCloningRunnerCfg",
    "rsl_rl_bc_small_cfg_entry_point": f"{_AGENTS}.imitation_cfg:NavigationSmallBehaviorCloningRunnerCfg",
}
"""Agent configurations of every navigation task by registry key (``--agent KEY``, where ``sac`` is enough for
``rsl_rl_sac_cfg_entry_point``). A line here is for all tasks."""
