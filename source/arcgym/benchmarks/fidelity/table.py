# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The rows of the fidelity table, in order. Importing this loads neither torch nor Warp.

A new row is a function in :mod:`arcgym.benchmarks.fidelity.checks` that takes a :class:`~.rows.Run` and returns
:class:`~.rows.Row` objects, and one line in :data:`TABLE`.
"""

from __future__ import annotations

from typing import Any

from arcgym.benchmarks.fidelity.rows import Check


def line(rows: str, function: str, quick: bool = False, **params: Any) -> Check:
    """Return the check of one line.

    Args:
        rows: Names of its rows, separated by blanks.
        function: ``module:name`` of the function in ``checks``.
        quick: Whether it takes seconds only.
        params: Further arguments of the function.
    """
    return Check(tuple(rows.split()), function, params, quick)


TABLE: tuple[Check, ...] = (
    line("cantilever_small cantilever_large", "shaft:cantilever", quick=True),
    line("torsion", "shaft:torsion", quick=True),
    line("buckling", "shaft:buckling", quick=True),
    line("cantilever_graded", "shaft:graded", quick=True),
    line("weight_scope", "weight:scope_sag", quick=True),
    line("links_bend links_tight_bend", "links:link_length"),
    line("damping_bend", "links:damping"),
    line("wall_beam", "wall:beam_mode", quick=True),
    line("weight_wall", "weight:wall_sag", quick=True),
    line("stiffening_hoop", "wall_law:hoop", quick=True, radius=0.016),
    line("thickness_hoop", "wall_law:hoop", quick=True, radius=0.03, name="thickness_hoop", thinned=True),
    line("relaxation_quick relaxation_slow", "wall_law:relaxation", quick=True),
    line("wall_ring", "wall:ring_mode"),
    line("wall_oval_paper", "wall:oval_mode", material="paper"),
    line("wall_oval_in_situ", "wall:oval_mode", material="in_situ"),
    line("gas_pressure gas_radius", "gas:inflation", quick=True),
    line("gas_collapse", "gas:collapse", quick=True),
    line("tension_oval", "tension:press_oval", quick=True),
    line("abdomen_stop", "abdomen:stop", quick=True),
    line("hand_dent hand_push", "abdomen:hand", quick=True),
    line("mesentery_swing mesentery_strain", "mesentery:hang", quick=True),
    line("loop_friction", "loops:slide", quick=True),
    line("indentation_paper", "indentation:indentation", material="paper"),
    line("indentation_in_situ", "indentation:indentation", material="in_situ"),
    line("light_dent", "indentation:light"),
    line("indentation_solid_paper", "solids:indentation", material="paper"),
    line("indentation_solid_in_situ", "solids:indentation", material="in_situ"),
    line("straight_advance", "insertion:straight_advance", quick=True),
    line("volume_stiff volume_soft", "insertion:volume"),
    line("bend_force bend_tip", "insertion:bend"),
    line("folded_paper_force folded_paper_tip", "folded:folded", material="paper"),
    line("folded_in_situ_force folded_in_situ_tip", "folded:folded", material="in_situ"),
    line("sigmoid_force sigmoid_tip", "insertion:sigmoid"),
    line("sigmoid_deep_force sigmoid_deep_tip", "insertion:sigmoid_deep"),
    line("step_damping_force step_damping_tip", "insertion:sigmoid_deep", name="step_damping", step_damping=0.5),
    line("bend_rod_force bend_rod_tip", "rods:bend"),
    line("sigmoid_rod_force sigmoid_rod_tip", "rods:sigmoid"),
    line("newton_force newton_tip", "insertion:plain_newton"),
    line("wall_motion_stiff wall_motion_soft", "insertion:wall_motion"),
    line("action_reaction base_force", "balance:balance"),
    line(
        "action_reaction_moving_paper action_reaction_worst_paper",
        "moving:action_reaction",
        quick=True,
        material="paper",
    ),
    line(
        "action_reaction_moving_in_situ action_reaction_worst_in_situ",
        "moving:action_reaction",
        material="in_situ",
    ),
    line(
        "friction_stop_low friction_hold_low friction_stop_high friction_hold_high", "holding:friction_hold", quick=True
    ),
    line("capstan", "friction:capstan", quick=True),
    line("contact_search_missed contact_search_dropped", "contact_search:contact_search"),
    line("tunnelling", "tunnelling:tunnelling"),
    line("bend_loss", "friction:bend_loss", quick=True),
    line("speed_capsule", "commands:speeds", robot="capsule"),
    line("random_capsule", "commands:random_actions", robot="capsule"),
    line("speed_magnetic", "commands:speeds", robot="magnetic"),
    line("random_magnetic", "commands:random_actions", robot="magnetic"),
    line("speed_proximal", "commands:speeds", robot="proximal"),
    line("random_proximal", "commands:random_actions", robot="proximal"),
    line("energy", "stability:energy", quick=True),
    line("energy_loss", "stability:energy_loss", quick=True),
    line("parked_drift", "stability:parked"),
    line("start_rest_capsule_paper", "resting:start_rest", robot="capsule", material="paper"),
    line("start_rest_capsule_in_situ", "resting:start_rest", robot="capsule", material="in_situ"),
    line("start_rest_magnetic_paper", "resting:start_rest", robot="magnetic", material="paper"),
    line("start_rest_magnetic_in_situ", "resting:start_rest", robot="magnetic", material="in_situ"),
    line("start_rest_proximal_paper", "resting:start_rest", robot="proximal", material="paper"),
    line("start_rest_proximal_in_situ", "resting:start_rest", robot="proximal", material="in_situ"),
    line("start_rest_capsule_clinical", "resting:start_rest_clinical", robot="capsule", until="sigmoid"),
    line("start_rest_magnetic_clinical", "resting:start_rest_clinical", robot="magnetic", until="sigmoid"),
    line("start_rest_proximal_clinical", "resting:start_rest_clinical", robot="proximal", until="sigmoid"),
    line(
        "sensitivity_contact_double sensitivity_contact_double_time",
        "sensitivity:sensitivity",
        setting="contact_double",
    ),
    line("sensitivity_contact_half sensitivity_contact_half_time", "sensitivity:sensitivity", setting="contact_half"),
    line("sensitivity_dt_half sensitivity_dt_half_time", "sensitivity:sensitivity", setting="dt_half"),
    line(
        "sensitivity_damping_fifth sensitivity_damping_fifth_time", "sensitivity:sensitivity", setting="damping_fifth"
    ),
    line("sensitivity_links_half sensitivity_links_half_time", "sensitivity:sensitivity", setting="links_half"),
    line("sensitivity_wall_half sensitivity_wall_half_time", "sensitivity:sensitivity", setting="wall_half"),
    line("sensitivity_noise sensitivity_noise_time", "sensitivity:sensitivity", setting="noise"),
)
"""All checks."""


def choose(rows: str | None, quick: bool) -> list[Check]:
    """Return the checks that give the named rows, or all; only the quick ones if so wished.

    Args:
        rows: Names separated by commas, or None for all.
        quick: Whether checks of more than seconds are left out.

    Raises:
        ValueError: If there is no row of a name.
    """
    known = [name for check in TABLE for name in check.rows]
    wanted = set(rows.split(",")) if rows else set(known)
    unknown = sorted(wanted - set(known))
    if unknown:
        raise ValueError(f"--rows names {unknown}; the rows are {', '.join(known)}")
    return [check for check in TABLE if wanted & set(check.rows) and (check.quick or not quick)]
