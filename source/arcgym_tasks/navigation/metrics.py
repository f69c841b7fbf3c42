# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""What is reported of an episode of a navigation task."""

from __future__ import annotations

from arcgym.envs import mdp
from arcgym.managers import MetricsTermCfg as MetricsTerm
from arcgym.utils.configclass import configclass


@configclass
class MetricsCfg:
    """What an episode is judged by.

    Unit and meaning of each are in its function's docstring and in docs/metrics.md. ``s_c`` and ``s_o`` are the paper's
    measures of how well the lumen is centered and how open it lies; ``red_out_rate`` is the share of steps in which the
    view is blocked.
    """

    success = MetricsTerm(func=mdp.success, reduce="max")
    patient_index = MetricsTerm(func=mdp.patient_index, reduce="last", log=False)
    progress = MetricsTerm(func=mdp.progress_fraction, reduce="max")
    time_to_success = MetricsTerm(func=mdp.time_to_success, reduce="last")
    s_c = MetricsTerm(func=mdp.lumen_centering, reduce="mean")
    s_o = MetricsTerm(func=mdp.lumen_visibility, reduce="mean")
    centered_rate = MetricsTerm(func=mdp.centered_rate, reduce="mean")
    visible_rate = MetricsTerm(func=mdp.visible_rate, reduce="mean")
    red_out_rate = MetricsTerm(func=mdp.view_blocked, reduce="mean")
    centerline_distance = MetricsTerm(func=mdp.centerline_distance, reduce="mean")
    max_tip_force = MetricsTerm(func=mdp.load, reduce="max", params={"kind": "tip_force"})
    mean_tip_force = MetricsTerm(func=mdp.load, reduce="mean", params={"kind": "tip_force"})
    p95_tip_force = MetricsTerm(
        func=mdp.load_percentile, reduce="last", params={"kind": "tip_force", "percentile": 95.0}
    )
    peak_tip_force = MetricsTerm(func=mdp.load, reduce="max", params={"kind": "tip_force", "reduce": "peak"})
    tip_impulse = MetricsTerm(func=mdp.load_impulse, reduce="sum", params={"kind": "tip_force"})
    tip_time_above_comfort = MetricsTerm(
        func=mdp.load_time_above, reduce="sum", params={"kind": "tip_force", "limit": "comfort"}
    )
    tip_time_above_unsafe = MetricsTerm(
        func=mdp.load_time_above, reduce="sum", params={"kind": "tip_force", "limit": "unsafe"}
    )
    tip_time_above_perforation = MetricsTerm(
        func=mdp.load_time_above, reduce="sum", params={"kind": "tip_force", "limit": "perforation"}
    )
    max_shaft_force = MetricsTerm(func=mdp.load, reduce="max", params={"kind": "shaft_force"})
    mean_shaft_force = MetricsTerm(func=mdp.load, reduce="mean", params={"kind": "shaft_force"})
    p95_shaft_force = MetricsTerm(
        func=mdp.load_percentile, reduce="last", params={"kind": "shaft_force", "percentile": 95.0}
    )
    peak_shaft_force = MetricsTerm(func=mdp.load, reduce="max", params={"kind": "shaft_force", "reduce": "peak"})
    shaft_impulse = MetricsTerm(func=mdp.load_impulse, reduce="sum", params={"kind": "shaft_force"})
    shaft_time_above_comfort = MetricsTerm(
        func=mdp.load_time_above, reduce="sum", params={"kind": "shaft_force", "limit": "comfort"}
    )
    shaft_time_above_unsafe = MetricsTerm(
        func=mdp.load_time_above, reduce="sum", params={"kind": "shaft_force", "limit": "unsafe"}
    )
    shaft_time_above_perforation = MetricsTerm(
        func=mdp.load_time_above, reduce="sum", params={"kind": "shaft_force", "limit": "perforation"}
    )
    max_base_force = MetricsTerm(func=mdp.base_force_magnitude, reduce="max")
    max_wall_strain = MetricsTerm(func=mdp.load, reduce="max", params={"kind": "wall_strain", "reduce": "peak"})
    max_anchor_tension = MetricsTerm(func=mdp.load, reduce="max", params={"kind": "anchor_tension", "reduce": "peak"})
    inserted_length = MetricsTerm(func=mdp.inserted_scope, reduce="max")
    max_mesentery_stretch = MetricsTerm(func=mdp.mesentery_stretch, reduce="max")
    looping_ratio = MetricsTerm(func=mdp.looping_ratio, reduce="last")
    loop_type = MetricsTerm(func=mdp.loop_type, reduce="last", log=False)
    n_loop_rate = MetricsTerm(func=mdp.loop_rate, reduce="mean", params={"kind": "n"})
    alpha_rate = MetricsTerm(func=mdp.loop_rate, reduce="mean", params={"kind": "alpha"})
    reverse_alpha_rate = MetricsTerm(func=mdp.loop_rate, reduce="mean", params={"kind": "reverse_alpha"})
    paradoxical_motion = MetricsTerm(func=mdp.paradoxical_motion, reduce="sum")
    path_efficiency = MetricsTerm(func=mdp.path_efficiency, reduce="last")
    mean_lumen_pressure: MetricsTerm | None = None
    """Off unless ``env.gas`` is on [Pa]."""
    max_lumen_pressure: MetricsTerm | None = None
    """Off unless ``env.gas`` is on: the peak [Pa]."""
