# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Contacts that the search misses, in wall gathered on the shaft."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import torch

from arcgym.benchmarks.fidelity.brute_force import sample_contacts
from arcgym.benchmarks.fidelity.insertions import CONTROL_STEP, LONGEST, Insertion, build_scene
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run, absolute

EVERY = 3
"""Control steps between two samples."""
EXPERT = {"speed": 0.04, "patience": 25.0, "least_pace": 0.15}
"""Settings of the expert: its tip catches, which gathers the wall."""
HOOK = 2.5
"""Angle of the bending section while the scope is withdrawn [rad]."""
WITHDRAWAL = 0.03
"""Speed of the withdrawal [m/s]."""
WITHDRAWN = 6.0
"""Duration of the withdrawal, and of the push after it [s]."""


def contact_search(run: Run) -> list[Row]:
    """Push the colonoscope through the sigmoid in situ, withdraw it hooked, and compare contacts with brute force.

    Colon 1, and the colons that ``--colons`` names. Sampled are all links and all faces of the wall, three times a
    second, until a link goes through the wall, which ends an episode of a task.
    """
    plot = Plot("contact_search", "time [s]", "pairs of link and face that touch")
    run.plots.append(plot)
    missed, dropped, notes = 0, 0, []
    for path in (None, *run.colons):
        name = "colon 1" if path is None else Path(path).parent.name
        samples, lost, tight, pierced = insert_and_compare(run, path)
        times = EVERY * CONTROL_STEP * np.arange(1, len(samples) + 1)
        plot.points.append((f"{name}, touching", times, samples[:, 0]))
        plot.lines.append((f"{name}, missed", times, samples[:, 1]))
        missed, dropped = missed + int(samples[:, 1].sum()), dropped + lost
        end = f", until a link goes through the wall at {times[-1]:.0f} s" if pierced else ""
        found = f"{samples[:, 0].sum():.0f} touch in {len(samples)} samples"
        notes.append(f"{name}: {found}, rings at {tight:.0%} of their distance at rest{end}")
    return [
        absolute("contact_search_missed", missed, 0.0, 0.0, "", "; ".join(notes)),
        absolute("contact_search_dropped", dropped, 0.0, 0.0),
    ]


def insert_and_compare(run: Run, colon: str | None) -> tuple[np.ndarray, int, float, bool]:
    """Drive the scope by its expert through the sigmoid, withdraw it hooked, which gathers the wall, and push again.

    Args:
        run: Device and folder.
        colon: Stage of the colon; colon 1 by default.

    Returns:
        Pairs that touch and pairs that were missed in each sample, shape (S, 2); contacts that found no slot; the
        smallest distance of five rings over that at rest; and whether it ended early because a link went through the
        wall.
    """
    scene = build_scene(Insertion("proximal", "in_situ", colon=colon, far=True), run.device, run.folder)
    sim = scene.sim
    rest = ring_spans(sim)
    samples, spans, pierced = list[tuple[int, int]](), [1.0], False
    with torch.inference_mode():
        for step, _ in enumerate(commands(scene)):
            sim.step(round(CONTROL_STEP / sim.physics_dt))
            lost = bool(sim.non_finite.any())
            pierced = lost or bool(sim.wall_penetrated.any())
            if step % EVERY == EVERY - 1 or pierced:
                (sample,) = sample_contacts(sim)
                samples.append((len(sample.missed), sim.endoscope.num_bodies if lost else int(sample.missed.sum())))
                spans.append(float((ring_spans(sim) / rest).min()))
            if pierced:
                break
    return np.array(samples), int(sim.dropped_contacts.sum()), min(spans), pierced


def commands(scene: Any) -> Iterator[None]:
    """Command the scope, control step by control step: in, out with its tip hooked, and in again."""
    from arcgym.experts import make_expert

    scope = scene.endoscope
    expert = make_expert(scene, **EXPERT)
    _, end = scene.colon.stage.segment_bounds()["sigmoid"]
    for _ in range(round(LONGEST / CONTROL_STEP)):
        expert.act()
        yield
        if float(scope.data.tip_arc_length[0]) >= end:
            break
    hook, still = torch.full_like(scope.data.base_force, HOOK), torch.zeros_like(scope.data.base_force)
    scope.set_bending_command(hook, still)
    for speed in (-WITHDRAWAL, WITHDRAWAL):
        scope.set_insertion_command(still + speed, still)
        for _ in range(round(WITHDRAWN / CONTROL_STEP)):
            yield


def ring_spans(sim: Any) -> np.ndarray:
    """Return the distances between the centers of every ring and the fifth after it [m]."""
    centers = sim.contact.centers.numpy()[0].astype(float)
    return np.linalg.norm(centers[5:] - centers[:-5], axis=1)
