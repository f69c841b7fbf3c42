# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The references that the fidelity table trusts, against textbook values."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from arcgym.anatomy import ANCHOR_FIXED
from arcgym.assets import PROXIMAL_CFG
from arcgym.assets.endoscope_spec import EndoscopeSpec, magnetic_spec, proximal_spec
from arcgym.benchmarks.fidelity.beams import clamped_pinned_load, elastica_deflection, small_deflection
from arcgym.benchmarks.fidelity.brute_force import sample_contacts, segment_triangle
from arcgym.benchmarks.fidelity.checks.commands import Watched
from arcgym.benchmarks.fidelity.checks.sensitivity import is_timed, sensitivity, standard_error
from arcgym.benchmarks.fidelity.indenter import Curve, join_curves
from arcgym.benchmarks.fidelity.insertions import (
    METRICS,
    SCENES,
    Insertion,
    cut,
    figures_of,
    figures_to_ends,
    halved,
    longest_halt,
    numbers_on,
)
from arcgym.benchmarks.fidelity.models import build
from arcgym.benchmarks.fidelity.placement import follow
from arcgym.benchmarks.fidelity.processes import in_processes
from arcgym.benchmarks.fidelity.pushes import BEND, DEPTH
from arcgym.benchmarks.fidelity.rows import Run
from arcgym.benchmarks.fidelity.smooth_colon import smooth_stage
from arcgym.benchmarks.fidelity.tube_model import TubeModel, load_size
from arcgym.benchmarks.fidelity.tubes import Tube, shipped_stage, tube_stage, wall_measures
from arcgym.benchmarks.fidelity.volumes import shell_volume_ratio
from arcgym.sim import ContactCfg


def test_elastica_of_a_small_load_is_a_beam() -> None:
    assert elastica_deflection(1e-3, 0.5, 0.025) == pytest.approx(small_deflection(1e-3, 0.5, 0.025), rel=1e-4)


@pytest.mark.parametrize(("load", "deflection"), [(1.0, 0.3017), (2.0, 0.4935), (4.0, 0.6700), (5.0, 0.7138)])
def test_elastica_is_that_of_the_tables(load: float, deflection: float) -> None:
    """Mattiasson 1981, Int. J. Numer. Methods Eng. 17: w/L of a cantilever by F L^2 / EI."""
    assert elastica_deflection(load, 1.0, 1.0) == pytest.approx(deflection, abs=1e-4)


def test_clamped_and_guided_column() -> None:
    # 20.19 EI / L^2 (Timoshenko and Gere, Theory of Elastic Stability, section 2.1)
    assert clamped_pinned_load(0.5, 0.025) == pytest.approx(20.19 * 0.025 / 0.25, rel=1e-3)


def test_a_stretched_brick_tube_follows_hooke() -> None:
    tube = TubeModel(0.1, 0.02, 0.002, 5.0e6, 0.0, around=8, along=4)
    z = tube.points()[:, 2]
    stretch = np.zeros((len(z), 3))
    stretch[:, 2] = 0.01 * z
    force = (tube.stiffness() @ stretch.ravel()).reshape(-1, 3)
    area = math.pi * (0.022**2 - 0.020**2)
    # Without lateral contraction the force is E A strain; the bricks' outline is made of parabolas.
    assert force[np.isclose(z, 0.1), 2].sum() == pytest.approx(5.0e6 * area * 0.01, rel=2e-3)
    assert np.abs(force[(z > 1e-9) & (z < 0.1 - 1e-9)]).max() < 1e-6


def test_a_long_brick_tube_bends_like_a_beam() -> None:
    length, radius = 1.0, 0.01
    tube = TubeModel(length, radius, 0.002, 5.0e6, 0.3, around=8, along=40)
    inertia = math.pi / 4.0 * (0.012**4 - 0.010**4)

    def middle(angle: np.ndarray, z: np.ndarray) -> np.ndarray:
        return np.exp(-(((z - 0.5 * length) / 0.03) ** 2))[:, None] * np.array([1.0, 0.0, 0.0])

    # L^3 / 192 EI, and a few per cent for shear and for the load's width.
    assert tube.compliance(middle) == pytest.approx(length**3 / (192.0 * 5.0e6 * inertia), rel=0.05)


def oval(angle: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Press a tube oval with the same load everywhere."""
    return np.cos(2.0 * angle)[:, None] * np.stack([np.cos(angle), np.sin(angle), 0.0 * z], axis=1)


def test_size_of_a_load_is_its_integral() -> None:
    # the integral of |cos 2 angle| around is 4, times the length
    assert load_size(oval, 0.1) == pytest.approx(0.4, rel=1e-4)


def test_an_octant_is_the_whole_tube() -> None:
    whole = TubeModel(0.1, 0.02, 0.002, 5.0e6, 0.3, around=16, along=4)
    octant = TubeModel(0.1, 0.02, 0.002, 5.0e6, 0.3, around=16, along=4, octant=True)
    assert octant.compliance(oval) == pytest.approx(whole.compliance(oval), rel=1e-6)


@pytest.mark.parametrize(("poissons_ratio", "ratio"), [(0.0, 1.01), (0.5, 1.0)])
def test_volume_of_a_stretched_shell(poissons_ratio: float, ratio: float) -> None:
    """Pulled by 1 % and free sideways, it keeps its volume if incompressible, and grows by 1 % without contraction."""
    rest = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0]])
    now = rest * np.array([1.01, 1.0 - 0.01 * poissons_ratio, 1.0])
    volume = shell_volume_ratio(rest, now, np.array([[0, 1, 2]]), poissons_ratio)
    assert volume[0] == pytest.approx(ratio, abs=2e-4)


def test_depth_under_a_load_is_interpolated() -> None:
    curve = Curve(np.array([[0.0, 1.0, 2.0]]), np.array([[0.0, 10.0, 30.0]]))
    assert curve.depth_at(20.0)[0] == pytest.approx(1.5)
    assert math.isnan(curve.depth_at(40.0)[0])


@pytest.mark.parametrize("spec", [magnetic_spec(), proximal_spec()], ids=lambda spec: spec.name)
def test_a_halved_scope_is_the_same_shaft(spec: EndoscopeSpec) -> None:
    fine = halved(spec)
    assert len(fine.link_length) == 2 * len(spec.link_length) - 2
    assert fine.total_length == pytest.approx(spec.total_length)
    assert fine.link_mass.sum() == pytest.approx(spec.link_mass.sum())
    # Every hinge of the shaft has half the lever and is twice as stiff: the same curvature under the same torque.
    assert fine.hinge_stiffness[6] == pytest.approx(2.0 * spec.hinge_stiffness[3])
    # All in all they give as much: the whole shaft from the base to the middle of the last link.
    assert (1.0 / fine.hinge_stiffness).sum() == pytest.approx((1.0 / spec.hinge_stiffness).sum())
    bent, fine_bent = spec.bending_links, fine.bending_links
    if bent:
        total = spec.hinge_limit[-bent:].sum(axis=0)
        np.testing.assert_allclose(fine.hinge_limit[-fine_bent:].sum(axis=0), total, rtol=0.01)


def test_a_finer_colon_has_the_shipped_vertices_among_its_own() -> None:
    shipped, fine = shipped_stage().wall, smooth_stage(2).wall
    rings = len(shipped.ring_arc)
    every_second = fine.points.reshape(2, 2 * rings - 1, -1, 3)[:, ::2, ::2].reshape(-1, 3)
    np.testing.assert_allclose(every_second, shipped.points, atol=1e-6)
    still = fine.ring_arc[fine.ring[fine.anchor == ANCHOR_FIXED]]
    held = shipped.ring_arc[shipped.ring[shipped.anchor == ANCHOR_FIXED]]
    np.testing.assert_allclose(np.unique(still)[[0, -1]], np.unique(held)[[0, -1]], atol=1e-6)
    assert np.isin(np.unique(held), np.unique(still)).all() and len(np.unique(still)) == 8  # 5 and 3 for 3 and 2


def test_figures_of_an_insertion() -> None:
    samples = np.array([[1.0, 2.0, 3.0, -0.01], [1.0, 6.0, 5.0, 0.001]])
    figures = figures_of(samples)
    assert figures["through"] == 1.0 and figures["peak_base_force"] == 5.0 and figures["time_near_5N"] == 0.0
    assert figures["mean_window_force"] == 4.0 and figures["peak_window_force"] == 6.0
    assert figures["time_above_5N"] == pytest.approx(0.1) and figures["mean_base_force"] == 4.0


def test_a_halt_is_the_longest_time_without_two_millimeters() -> None:
    arc = 0.001 * np.array([0.0, 3.0, 3.5, 1.0, 4.0, 4.5, 8.0])
    assert longest_halt(arc) == 4  # from 3 mm, in the second sample, to 4.5 mm in the sixth


def test_an_insertion_is_cut_where_the_tip_first_comes_through() -> None:
    series = np.zeros((4, 4))
    series[:, 3] = -0.1, 0.0, -0.1, 0.1
    assert len(cut(series)) == 2 and len(cut(series[:1])) == 1 and len(cut(series, 0.05)) == 4


def test_figures_of_the_whole_way_have_names_of_their_own() -> None:
    samples = np.array([[1.0, 2.0, 3.0, -0.01], [1.0, 6.0, 5.0, 0.001], [1.0, 7.0, 5.0, 0.3]])
    figures = figures_to_ends(Insertion("proximal", "in_situ", far=True), samples)
    assert figures["peak_window_force"] == 6.0 and figures["far_peak_window_force"] == 7.0
    assert "far_time" not in figures_to_ends(Insertion("proximal", "paper"), samples)


def test_a_cpu_makes_every_fourth_insertion_from_the_slowest_to_the_fastest() -> None:
    assert (
        list(numbers_on("cpu", "proximal"))
        == [0, 4, 8, 12, 16, 20, 24, 28]
        == list(numbers_on("cuda:0", "proximal"))[::4]
    )
    assert list(numbers_on("cpu", "magnetic")) == [0, 4, 8, 12]


def test_standard_error_of_a_change_is_that_of_the_pairs() -> None:
    old, new = ([{"mean_base_force": f} for f in of] for of in ((1.0, 2.0, 3.0), (1.1, 2.3, 3.2)))
    # changes of 0.1, 0.3 and 0.2 N have a standard deviation of 0.1 N; the mean before is 2 N
    assert standard_error(old, new, "mean_base_force") == pytest.approx(0.1 / 3**0.5 / 2.0)


def test_a_time_is_judged_from_a_tenth_of_the_insertion_on() -> None:
    assert is_timed({"time_above_5N": 2.0, "time": 20.0}) and not is_timed({"time_above_5N": 1.9, "time": 20.0})


def test_rows_of_a_setting_are_the_largest_changes_of_what_is_judged(tmp_path: Path) -> None:
    # Of 20 s, 5 s are above 5 N with a friction of 0.2, 1 s else: twice that is not judged, 5.2 s for 5 s are.
    run = Run("cpu", tmp_path)
    short, long = (dict.fromkeys(METRICS, 1.0) | {"time": 20.0, "time_above_5N": above} for above in (1.0, 5.0))
    for case in SCENES:
        for number in numbers_on(run.device, case.robot):
            before = long if case.friction else short
            after = {"time_above_5N": 5.2, "p95_tip_force": 0.93} if case.friction else {"time_above_5N": 2.0}
            run.shared["insertion", case, number] = before
            run.shared["insertion", replace(case, setting="noise"), number] = before | after
    forces, time = sensitivity(run, "noise")
    assert forces.error == pytest.approx(-0.07) and "p95_tip_force of proximal, in_situ, friction 0.2" in forces.note
    assert time.error == pytest.approx(0.04) and time.reference == pytest.approx(5.0)


def test_curves_of_places_that_end_at_other_loads_are_joined() -> None:
    short = Curve(np.array([[0.0, 0.001]]), np.array([[0.0, 2.0]]))
    long = Curve(np.array([[0.0, 0.001, 0.002]]), np.array([[0.0, 1.0, 2.0]]))
    both = join_curves([short, long])
    np.testing.assert_allclose(both.depth_at(1.0), [0.0005, 0.001])
    assert both.force_at(0.001) == 1.5


def test_calls_in_processes_keep_their_order() -> None:
    assert in_processes(pow, [(2, 3), (3, 2)]) == [8, 9]
    assert in_processes(pow, [(2, 4)]) == [16]


def test_what_was_seen_of_worlds_is_joined() -> None:
    left = Watched(np.array([True, False]), outside=2, broken=0, force=[np.array([1.0, 2.0])])
    left.join(Watched(np.array([True]), outside=1, broken=1, force=[np.array([3.0])]))
    row = left.row("random_x", "10 min")
    assert row.value == 4.0 and row.note == "10 min: 2 of 3 worlds, 1 not finite"
    np.testing.assert_array_equal(left.force, [[1.0, 2.0, 3.0]])


def test_a_bend_has_a_line_of_vertices_on_its_outside() -> None:
    tube = Tube(0.4, np.radians(90.0), 0.15, 0.05)
    inner = tube_stage(tube).wall.points.reshape(2, -1, wall_measures().sectors, 3)[0]
    assert abs(inner[-1, 0, 0]) < 1e-6 and inner[-1, 0, 2] == inner[-1, :, 2].max()  # the bend turns Z to Y


def test_distance_of_segment_and_triangle_is_that_of_a_dense_search() -> None:
    rng = np.random.default_rng(0)
    p, q, corners = rng.normal(size=(40, 3)), rng.normal(size=(40, 3)), rng.normal(size=(40, 3, 3))
    t = np.linspace(0.0, 1.0, 61)
    bary = np.array([(i, j, 60 - i - j) for i in range(61) for j in range(61 - i)]) / 60.0
    for k, distance in enumerate(segment_triangle(p, q, corners)[0]):
        along, across = p[k] + t[:, None] * (q[k] - p[k]), bary @ corners[k]
        dense = np.linalg.norm(along[:, None] - across, axis=2).min()
        assert distance <= dense + 1e-12
        assert dense - distance < 0.06


def test_side_of_a_triangle_that_a_segment_is_on() -> None:
    corners = np.tile(np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), (3, 1, 1))  # normal +Z
    p = np.array([[0.2, 0.2, -1.0], [0.2, 0.2, 1.0], [0.2, 0.2, -1.0]])
    q = np.array([[0.2, 0.2, -2.0], [0.2, 0.2, 3.0], [0.2, 0.2, 0.5]])
    distance, lumen_side = segment_triangle(p, q, corners)
    np.testing.assert_allclose(distance, [1.0, 1.0, 0.0])
    np.testing.assert_array_equal(lumen_side, [True, False, True])


@pytest.mark.parametrize(("room", "misses"), [(24, False), (1, True)])
def test_brute_force_finds_contacts_without_a_record(run: Run, room: int, misses: bool) -> None:
    contact = ContactCfg(patch_capacity=room)
    sim = build(run, PROXIMAL_CFG, BEND, colon={"material": "in_situ"}, contact=contact, use_graph=False)
    follow(sim, BEND, DEPTH)
    sim.colon.data.nodal_pos_w[..., 0] += 0.011  # the lumen's radius is 17 mm, that of the links 6 mm
    assert sample_contacts(sim)[0].missed.any() == misses
    assert (int(sim.contact.records.dropped.numpy()[0]) > 0) == misses
