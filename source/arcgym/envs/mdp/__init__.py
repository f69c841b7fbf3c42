# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Terms of the Markov decision process, one module for each kind; import as ``from arcgym.envs import mdp``."""

from __future__ import annotations

from arcgym.envs.mdp.actions import InsertionAction, InsertionActionCfg, TipVelocityAction, TipVelocityActionCfg
from arcgym.envs.mdp.costs import tip_force_above, view_blocked
from arcgym.envs.mdp.curriculums import widen_reset
from arcgym.envs.mdp.events import (
    perturb_tip,
    randomize_color,
    randomize_friction,
    randomize_light,
    randomize_texture,
    randomize_tissue_stiffness,
    reset_to_segment_start,
)
from arcgym.envs.mdp.lumen import (
    LUMEN_PRESETS,
    METRIC,
    PAPER,
    LumenCfg,
    LumenScores,
    lumen_scores,
    resolve_lumen,
    score_depth,
)
from arcgym.envs.mdp.metrics import (
    centered_rate,
    centerline_distance,
    looping_ratio,
    max_wall_force,
    mean_speed,
    progress_fraction,
    time_to_success,
    visible_rate,
)
from arcgym.envs.mdp.observations import (
    centerline_ahead,
    depth,
    drive_forces,
    inserted_length,
    last_action,
    lumen_state,
    rgb,
    tip_axis_distance,
    tip_bending,
    tip_lumen_direction,
    tip_progress,
    tip_velocity,
    wall_forces,
)
from arcgym.envs.mdp.rewards import (
    action_l2,
    action_rate_l2,
    excess_wall_force,
    is_terminated,
    lumen_centering,
    lumen_reward,
    lumen_visibility,
    progress,
    success,
)
from arcgym.envs.mdp.segments import segment_progress, segment_span
from arcgym.envs.mdp.terminations import excess_force, lumen_lost, segment_passed, stuck, time_out

__all__ = [
    "LUMEN_PRESETS",
    "METRIC",
    "PAPER",
    "InsertionAction",
    "InsertionActionCfg",
    "LumenCfg",
    "LumenScores",
    "TipVelocityAction",
    "TipVelocityActionCfg",
    "action_l2",
    "action_rate_l2",
    "centered_rate",
    "centerline_ahead",
    "centerline_distance",
    "depth",
    "drive_forces",
    "excess_force",
    "excess_wall_force",
    "inserted_length",
    "is_terminated",
    "last_action",
    "looping_ratio",
    "lumen_centering",
    "lumen_lost",
    "lumen_reward",
    "lumen_scores",
    "lumen_state",
    "lumen_visibility",
    "max_wall_force",
    "mean_speed",
    "perturb_tip",
    "progress",
    "progress_fraction",
    "randomize_color",
    "randomize_friction",
    "randomize_light",
    "randomize_texture",
    "randomize_tissue_stiffness",
    "reset_to_segment_start",
    "resolve_lumen",
    "rgb",
    "score_depth",
    "segment_passed",
    "segment_progress",
    "segment_span",
    "stuck",
    "success",
    "time_out",
    "time_to_success",
    "tip_axis_distance",
    "tip_bending",
    "tip_force_above",
    "tip_lumen_direction",
    "tip_progress",
    "tip_velocity",
    "view_blocked",
    "visible_rate",
    "wall_forces",
    "widen_reset",
]
