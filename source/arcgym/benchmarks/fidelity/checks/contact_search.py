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


def contact_search(run: Run) -> list[Row]:
    """Push the colonoscope through the sigmoid in situ and compare the contacts with those of brute force.

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
    """Drive the scope by its expert through the sigmoid.

    Args:
        run: Device and folder.
        colon: Stage of the colon; colon 1 by default.

    Returns:
        Pairs that touch and pairs that were missed in each sample, shape (S, 2); contacts that found no slot; and the
        smallest distance of five rings over that at rest.
    """
    from arcgym.experts import make_expert

    scene = build_scene(Insertion("proximal", "in_situ"), run.device, run.folder, colon)
    expert, sim = make_expert(scene, speed=SPEED), scene.sim
    _, end = scene.colon.stage.segment_bounds()["sigmoid"]
    faces, samples = lumen_triangles(sim.colon.wall), []
    rest, tight = ring_spans(sim), 1.0
    with torch.inference_mode():
        for step in range(round(LONGEST / CONTROL_STEP)):
            expert.act()
            sim.step(round(CONTROL_STEP / sim.physics_dt))
            if step % EVERY == EVERY - 1:
                samples.append((len(touching(sim, faces)), len(missed_contacts(sim))))
                tight = min(tight, float((ring_spans(sim) / rest).min()))
            if float(scene.endoscope.data.tip_arc_length[0]) >= end:
                break
    return np.array(samples), int(sim.contact.records.dropped.numpy().sum()), tight


def ring_spans(sim: Any) -> np.ndarray:
    """Return the distances between the centers of every ring and the fifth after it [m]."""
    centers = sim.contact.centers.numpy()[0].astype(float)
    return np.linalg.norm(centers[5:] - centers[:-5], axis=1)
