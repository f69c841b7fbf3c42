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


def ensure(scene: InteractiveScene, segment: str) -> SnapshotSet:
    """Return start states that fit the scene and hold a segment's; they are made if there are none.

    Looked for beside the colon's stage, then in the cache folder.

    Args:
        scene: The scene, as built for a task.
        segment: Segment whose start is wanted.

    Raises:
        StartStateError: If the robot's expert does not get there, with how far it came and what can be used.
    """
    found = find_stored(scene, segment)
    if found is not None:
        return found
    key = key_of(scene)
    path = store.in_cache(scene.colon, scene.endoscope, key)
    with store.locked(path):
        found = store.load(path)
        if found is None or not _settled(found, segment):
            _say_why(path, found, store.outdated(path, key))
            found, _ = make(scene.cfg, scene.sim.cfg, segment)
    if segment not in found.names:
        raise StartStateError(_failure(scene, segment, found))
    return found


def find_stored(scene: InteractiveScene, segment: str) -> SnapshotSet | None:
    """Return stored states that fit the scene and hold a segment's, or None; nothing is made.

    Args:
        scene: The scene.
        segment: Segment whose start is wanted.
    """
    shipped = _beside_colon(scene)
    if shipped is not None and segment in shipped.names:
        return shipped
    found = store.load(store.in_cache(scene.colon, scene.endoscope, key_of(scene)))
    return found if found is not None and segment in found.names else None


def _beside_colon(scene: InteractiveScene) -> SnapshotSet | None:
    path = store.find_beside_colon(scene.colon, scene.endoscope)
    if path is None:
        return None
    states = SnapshotSet.load(path)
    problem = states.mismatch(scene.sim)
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


def _failure(scene: InteractiveScene, segment: str, found: SnapshotSet) -> str:
    return (
        f"The expert of {scene.endoscope.path.name} does not reach the {segment} of {scene.colon.path}: it came "
        f"{float(found.about['arc']):.2f} m far, into the {found.names[-1]} ({found.about['problem']}). Tasks of "
        f"{', '.join(found.names)} can be used (env.segment={found.names[-1]}), or env.start=rest; "
        "'arcgym snapshots --task NAME --force --speed 0.02' tries again."
    )
