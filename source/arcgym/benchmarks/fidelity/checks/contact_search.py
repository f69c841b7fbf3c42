# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Contacts that the search misses, in wall gathered on the shaft."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import torch

from arcgym.benchmarks.fidelity.brute_force import missed_contacts, touching
from arcgym.benchmarks.fidelity.insertions import CONTROL_STEP, LONGEST, SPEED, Insertion, build_scene
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run, absolute
from arcgym.benchmarks.lumen import lumen_triangles

EVERY = 3
"""Control steps between two samples."""
HOOK = 2.5
"""Angle of the bending section while the scope is withdrawn [rad]."""
WITHDRAWAL = 0.03
"""Speed of the withdrawal [m/s]."""
WITHDRAWN = 6.0
"""Duration of the withdrawal, and of the push after it [s]."""


def contact_search(run: Run) -> list[Row]:
    """Push the colonoscope through the sigmoid in situ, withdraw it hooked, and compare contacts with brute force.

    Colon 1, and the colons that ``--colons`` names. Sampled are all links and all faces of the wall, three times a
    second.
    """
    plot = Plot("contact_search", "time [s]", "pairs of link and face that touch")
    run.plots.append(plot)
    missed, dropped, notes = 0, 0, []
    for path in (None, *run.colons):
        name = "colon 1" if path is None else Path(path).parent.name
        samples, lost, tight = insert_and_compare(run, path)
        times = EVERY * CONTROL_STEP * np.arange(1, len(samples) + 1)
        plot.points.append((f"{name}, touching", times, samples[:, 0]))
        plot.lines.append((f"{name}, missed", times, samples[:, 1]))
        missed, dropped = missed + int(samples[:, 1].sum()), dropped + lost
        notes.append(f"{name}: {samples[:, 0].sum():.0f} touch in {len(samples)} samples, rings at {tight:.0%}")
    return [
        absolute("contact_search_missed", missed, 0.0, 0.0, "", "; ".join(notes) + " of their distance at rest"),
        absolute("contact_search_dropped", dropped, 0.0, 0.0),
    ]


def insert_and_compare(run: Run, colon: str | None) -> tuple[np.ndarray, int, float]:
    """Drive the scope by its expert through the sigmoid, withdraw it hooked, which gathers the wall, and push again.

    Args:
        run: Device and folder.
        colon: Stage of the colon; colon 1 by default.

    Returns:
        Pairs that touch and pairs that were missed in each sample, shape (S, 2); contacts that found no slot; and the
        smallest distance of five rings over that at rest.
    """
    from arcgym.experts import make_expert

    scene = build_scene(Insertion("proximal", "in_situ"), run.device, run.folder, colon)
    expert, sim, data = make_expert(scene, speed=SPEED), scene.sim, scene.endoscope.data
    _, end = scene.colon.stage.segment_bounds()["sigmoid"]
    faces, rest = lumen_triangles(sim.colon.wall), ring_spans(sim)
    samples, spans = list[tuple[int, int]](), [1.0]

    def go_on(steps: int) -> None:
        sim.step(round(CONTROL_STEP / sim.physics_dt))
        if steps % EVERY == EVERY - 1:
            samples.append((len(touching(sim, faces)), len(missed_contacts(sim))))
            spans.append(float((ring_spans(sim) / rest).min()))

    with torch.inference_mode():
        for step in range(round(LONGEST / CONTROL_STEP)):
            expert.act()
            go_on(step)
            if float(data.tip_arc_length[0]) >= end:
                break
        hook, still = torch.full_like(data.base_force, HOOK), torch.zeros_like(data.base_force)
        scene.endoscope.set_bending_command(hook, still)
        for speed in (-WITHDRAWAL, WITHDRAWAL):
            scene.endoscope.set_insertion_command(still + speed, still)
            for step in range(round(WITHDRAWN / CONTROL_STEP)):
                go_on(step)
    return np.array(samples), int(sim.contact.records.dropped.numpy().sum()), min(spans)


def ring_spans(sim: Any) -> np.ndarray:
    """Return the distances between the centers of every ring and the fifth after it [m]."""
    centers = sim.contact.centers.numpy()[0].astype(float)
    return np.linalg.norm(centers[5:] - centers[:-5], axis=1)
