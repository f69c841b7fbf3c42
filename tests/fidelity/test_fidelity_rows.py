# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rows of the fidelity table stay within their bounds."""

from __future__ import annotations

import pytest

from arcgym.benchmarks.fidelity.rows import Run
from arcgym.benchmarks.fidelity.table import choose
from arcgym.cli.bench_fidelity import describe

QUICK = [
    "cantilever_small,cantilever_large",
    "torsion",
    "buckling",
    "cantilever_graded",
    "weight_scope",
    "wall_beam",
    "weight_wall",
    "gas_pressure,gas_radius",
    "gas_collapse",
    "tension_oval",
    "abdomen_stop",
    "hand_dent,hand_push",
    "mesentery_swing,mesentery_strain",
    "loop_friction",
    "stiffening_hoop",
    "thickness_hoop",
    "relaxation_quick,relaxation_slow",
    "straight_advance",
    "action_reaction_moving_paper,action_reaction_worst_paper",
    "friction_stop_low,friction_hold_low,friction_stop_high,friction_hold_high",
    "capstan",
    "bend_loss",
    "energy",
    "energy_loss",
]
"""Rows that the fast tests measure, those of one check together."""
SLOW = [
    "wall_ring",
    "wall_oval_paper",
    "wall_oval_in_situ",
    "indentation_paper",
    "indentation_in_situ",
    "links_bend,links_tight_bend",
    "damping_bend",
    "indentation_solid_paper",
    "indentation_solid_in_situ",
    "volume_stiff,volume_soft",
    "bend_force,bend_tip",
    "folded_paper_force,folded_paper_tip",
    "folded_in_situ_force,folded_in_situ_tip",
    "sigmoid_force,sigmoid_tip",
    "bend_rod_force,bend_rod_tip",
    "sigmoid_rod_force,sigmoid_rod_tip",
    "wall_motion_stiff,wall_motion_soft",
    "action_reaction,base_force",
    "action_reaction_moving_in_situ,action_reaction_worst_in_situ",
    "tunnelling",
    "speed_capsule",
    "speed_magnetic",
    "speed_proximal",
    "random_capsule",
    "parked_drift",
]
"""Rows that ``make test-all`` measures as well."""
LONG = [
    "contact_search_missed,contact_search_dropped",
    "sigmoid_deep_force,sigmoid_deep_tip",
    "step_damping_force,step_damping_tip",
    "light_dent",
    "newton_force,newton_tip",
    "random_magnetic",
    "random_proximal",
    "start_rest_capsule_paper",
    "start_rest_capsule_in_situ",
    "start_rest_magnetic_paper",
    "start_rest_magnetic_in_situ",
    "start_rest_proximal_paper",
    "start_rest_proximal_in_situ",
    "start_rest_capsule_clinical",
    "start_rest_magnetic_clinical",
    "start_rest_proximal_clinical",
    "sensitivity_contact_double,sensitivity_contact_double_time",
    "sensitivity_contact_half,sensitivity_contact_half_time",
    "sensitivity_dt_half,sensitivity_dt_half_time",
    "sensitivity_damping_fifth,sensitivity_damping_fifth_time",
    "sensitivity_links_half,sensitivity_links_half_time",
    "sensitivity_wall_half,sensitivity_wall_half_time",
    "sensitivity_noise,sensitivity_noise_time",
]
"""Rows that take minutes each and are left to the script."""


def check_rows(run: Run, names: str) -> None:
    """Measure the one check that gives the rows, and look at each."""
    (check,) = choose(names, quick=False)
    rows = check.measure(run)
    assert [row.name for row in rows] == names.split(",")
    assert all(row.ok for row in rows), "\n".join(describe(row) for row in rows)


@pytest.mark.parametrize("names", QUICK)
def test_quick_rows_are_within_their_bounds(run: Run, names: str) -> None:
    check_rows(run, names)


@pytest.mark.slow
@pytest.mark.parametrize("names", SLOW)
def test_rows_are_within_their_bounds(run: Run, names: str) -> None:
    check_rows(run, names)


def test_no_row_is_left_out() -> None:
    quick = [name for check in choose(None, quick=True) for name in check.rows]
    every = [name for check in choose(None, quick=False) for name in check.rows]
    assert sorted(quick) == sorted(",".join(QUICK).split(","))
    assert sorted(every) == sorted(",".join(QUICK + SLOW + LONG).split(","))
