# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Finds the start states of a scene, and has missing ones made."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from pathlib import Path

from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.sim import SnapshotSet
from arcgym.start_states import store
from arcgym.start_states.errors import StartStateError
from arcgym.start_states.making import key_of, make_all
from arcgym.start_states.progress import say
from arcgym.utils.progress import report

AT_ONCE = 32
"""Patients whose states are made at once."""


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
    return _ensure(scene, segment, [patient])[0]


def ensure_all(scene: InteractiveScene, segment: str) -> list[SnapshotSet]:
    """Return the start states of every patient of the scene, see :func:`ensure`; missing ones are made many at once.

    Raises:
        StartStateError: If the robot's expert does not get there in some patients; names them.
    """
    return _ensure(scene, segment, range(len(scene.colon.patients)))


def _ensure(scene: InteractiveScene, segment: str, patients: Sequence[int]) -> list[SnapshotSet]:
    found = {patient: find_stored(scene, segment, patient) for patient in patients}
    missing = [patient for patient, states in found.items() if states is None]
    for first in range(0, len(missing), AT_ONCE):
        report(f"start states: {first} of {len(missing)} patients made")
        found |= _make(scene, segment, missing[first : first + AT_ONCE])
    failed = [patient for patient, states in found.items() if states is None or segment not in states.names]
    if len(failed) == 1:
        raise StartStateError(_failure(scene, segment, found[failed[0]], failed[0]))
    if failed:
        raise StartStateError(_failures(scene, segment, failed))
    return [states for states in found.values() if states is not None]


def _make(scene: InteractiveScene, segment: str, patients: Sequence[int]) -> dict[int, SnapshotSet]:
    """Make the states of some patients at once, but for those that another process makes meanwhile."""
    keys = {patient: key_of(scene, patient) for patient in patients}
    paths = {patient: store.in_cache(scene.colon, scene.endoscope, keys[patient], patient) for patient in patients}
    made: dict[int, SnapshotSet] = {}
    with contextlib.ExitStack() as stack:
        for path in sorted(paths.values()):
            stack.enter_context(store.locked(path))
        for patient, path in paths.items():
            stored = store.load(path)
            if stored is not None and _settled(stored, segment):
                made[patient] = stored
            else:
                _say_why(path, stored, store.outdated(path, keys[patient]))
        left = [patient for patient in patients if patient not in made]
        if left:
            stages = [scene.colon.patients[patient].path for patient in left]
            sets = make_all(scene.cfg, scene.sim.cfg, segment, stages)
            made |= {patient: states for patient, (states, _) in zip(left, sets, strict=True)}
    return made


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
        say(f"start states {path} do not fit: {problem}; those in the cache are taken, or made now")
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


def _failure(scene: InteractiveScene, segment: str, found: SnapshotSet | None, patient: int) -> str:
    colon = scene.colon.patients[patient].path
    assert found is not None  # those that are missing were made as far as the expert came
    return (
        f"The expert of {scene.endoscope.path.name} does not reach the {segment} of {colon}: it came "
        f"{float(found.about['arc']):.2f} m far, into the {found.names[-1]} ({found.about['problem']}). Tasks of "
        f"{', '.join(found.names)} can be used (env.segment={found.names[-1]}), or env.start=rest; "
        "'arcgym snapshots --task NAME --force --speed 0.02' tries again."
    )


def _failures(scene: InteractiveScene, segment: str, failed: Sequence[int]) -> str:
    names = [scene.colon.patients[patient].name for patient in failed]
    return (
        f"The expert of {scene.endoscope.path.name} does not reach the {segment} of {len(failed)} of "
        f"{len(scene.colon.patients)} patients ({', '.join(names[:5])}{', ...' if len(failed) > 5 else ''}). Leave "
        "them out of env.scene.colon.usd_path, or begin at the anus with env.start=rest."
    )
