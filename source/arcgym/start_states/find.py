# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Finds the start states of a scene, and has missing ones made."""

from __future__ import annotations

from pathlib import Path

from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.sim import SnapshotSet
from arcgym.start_states import store
from arcgym.start_states.errors import StartStateError
from arcgym.start_states.making import key_of, make
from arcgym.start_states.progress import say
from arcgym.utils.progress import report


def ensure(scene: InteractiveScene, segment: str, patient: int = 0) -> SnapshotSet:
    """Return start states that fit a patient of the scene and hold a segment's; they are made if there are none.

    Looked for beside the colon's stage, then in the cache folder.

    Args:
        scene: The scene, as built for a task.
        segment: Segment whose start is wanted.
        patient: Which of the colon's patients.

    Raises:
        StartStateError: If the robot's expert does not get there, with how far it came and what can be used.
    """
    found = find_stored(scene, segment, patient)
    if found is not None:
        return found
    key = key_of(scene, patient)
    path = store.in_cache(scene.colon, scene.endoscope, key, patient)
    with store.locked(path):
        found = store.load(path)
        if found is None or not _settled(found, segment):
            _say_why(path, found, store.outdated(path, key))
            found, _ = make(scene.cfg, scene.sim.cfg, segment, patient=scene.colon.patients[patient].path)
    if segment not in found.names:
        raise StartStateError(_failure(scene, segment, found, patient))
    return found


def ensure_all(scene: InteractiveScene, segment: str) -> list[SnapshotSet]:
    """Return the start states of every patient of the scene, see :func:`ensure`.

    Raises:
        StartStateError: If the robot's expert does not get there in some patients; names them.
    """
    states: list[SnapshotSet] = []
    failures: dict[str, StartStateError] = {}
    for index, patient in enumerate(scene.colon.patients):
        report(f"start states of {patient.name} ({index + 1} of {len(scene.colon.patients)})")
        try:
            states.append(ensure(scene, segment, index))
        except StartStateError as error:
            failures[patient.name] = error
    if len(failures) == 1:
        raise next(iter(failures.values()))
    if failures:
        names = ", ".join(list(failures)[:5])
        raise StartStateError(
            f"The expert of {scene.endoscope.path.name} does not reach the {segment} of {len(failures)} of "
            f"{len(scene.colon.patients)} patients ({names}{', ...' if len(failures) > 5 else ''}). Leave them out of "
            "env.scene.colon.usd_path, or begin at the anus with env.start=rest."
        )
    return states


def find_stored(scene: InteractiveScene, segment: str, patient: int = 0) -> SnapshotSet | None:
    """Return stored states that fit a patient of the scene and hold a segment's, or None; nothing is made.

    Args:
        scene: The scene.
        segment: Segment whose start is wanted.
        patient: Which of the colon's patients.
    """
    shipped = _beside_colon(scene, patient)
    if shipped is not None and segment in shipped.names:
        return shipped
    found = store.load(store.in_cache(scene.colon, scene.endoscope, key_of(scene, patient), patient))
    return found if found is not None and segment in found.names else None


def _beside_colon(scene: InteractiveScene, patient: int) -> SnapshotSet | None:
    path = store.find_beside_colon(scene.colon, scene.endoscope, patient)
    if path is None:
        return None
    states = SnapshotSet.load(path)
    problem = states.mismatch(scene.sim, patient)
    if problem:
        say(f"start states {path} are stale: {problem}")
        return None
    return states


def _settled(states: SnapshotSet, segment: str) -> bool:
    """Whether the state is there, or a drive has shown that the expert does not get there."""
    return segment in states.names or bool(states.about.get("problem"))


def _say_why(path: Path, found: SnapshotSet | None, changed: list[str]) -> None:
    """Say why states are made though there are some."""
    if found is not None:
        say(f"start states {path} end at {found.names[-1]}; driving farther")
    elif changed:
        say(f"start states in {path.parent} are stale: {' and '.join(changed)} changed; making new ones")


def _failure(scene: InteractiveScene, segment: str, found: SnapshotSet, patient: int) -> str:
    colon = scene.colon.patients[patient].path
    return (
        f"The expert of {scene.endoscope.path.name} does not reach the {segment} of {colon}: it came "
        f"{float(found.about['arc']):.2f} m far, into the {found.names[-1]} ({found.about['problem']}). Tasks of "
        f"{', '.join(found.names)} can be used (env.segment={found.names[-1]}), or env.start=rest; "
        "'arcgym snapshots --task NAME --force --speed 0.02' tries again."
    )
