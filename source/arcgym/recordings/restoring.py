# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""The environment of a recording, built again, and its worlds put where the recording begins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch

from arcgym.assets.patient_files import find_stages
from arcgym.envs.provenance import settings_hash, stage_hash, versions
from arcgym.managers import Episode
from arcgym.rl.params import differences, restore
from arcgym.utils.coerce import to_plain
from arcgym.utils.errors import UsageError
from arcgym.utils.hydra import apply_overrides
from arcgym.utils.paths import resolve_asset
from arcgym.utils.registry import load_cfg_from_registry

CHANGED_HERE = (
    "scene.num_envs",
    "scene.colon.usd_path",
    "scene.colon.num_patients",
    "sim.device",
    "events",
    "recorders",
    "autoreset",
    "viewer",
    "log_dir",
    "seed",
)
"""Settings that a replay chooses for itself and that change nothing in a world; stages count by their content."""
_PATIENT = "world_settings/patient"

REWRITTEN = {"bf1eb2764d1421ce": "3b2e8a5a64ee92f3", "e514ec17fdfb38e6": "33583df00486aa16"}
"""Hash of a shipped stage, magnetic and pushed, to that of the same stage before it had two layers."""


def restored_cfg(episode: Episode, task: str | None, device: str, overrides: Sequence[str] = ()) -> tuple[str, Any]:
    """Return the task and the configuration that an episode was recorded with, for one world without events.

    Args:
        episode: The episode.
        task: Task to use in place of the recorded one.
        device: Where it is to run.
        overrides: Texts ``env.path=value``.

    Raises:
        UsageError: If the task is unknown, or the settings do not fit this version.
    """
    task = task or episode.provenance.get("task")
    if not task:
        raise UsageError("The recording names no task, because its environment was not made by gym.make: pass --task.")
    try:
        cfg = load_cfg_from_registry(task, "env_cfg_entry_point")
    except (TypeError, ValueError) as error:
        raise UsageError(str(error)) from error
    if episode.settings:
        settings = {name: value for name, value in episode.settings.items() if name != "viewer"}
        restore(cfg, settings, "env", recorded=True)
    _choose_patient(cfg, episode)
    try:
        apply_overrides({"env": cfg}, list(overrides))
    except (TypeError, ValueError) as error:
        raise UsageError(str(error)) from error
    cfg.scene.num_envs, cfg.sim.device, cfg.seed = 1, device, episode.provenance.get("seed") or 0
    cfg.events, cfg.recorders, cfg.autoreset = None, None, False
    return task, cfg


def _choose_patient(cfg: Any, episode: Episode) -> None:
    """Take the episode's patient alone, where it was recorded with several: each goes on as if it were the only one."""
    stage = episode.provenance.get("stages", {}).get("colon", {}).get("path")
    if stage and (not isinstance(cfg.scene.colon.usd_path, str) or int(episode.data.get(_PATIENT, 0)) > 0):
        cfg.scene.colon.usd_path, cfg.scene.colon.num_patients = stage, None


def mismatches(episode: Episode, cfg: Any) -> list[str]:
    """Return what is not as it was when the episode was recorded, one line each: versions, stages, settings, device."""
    then = episode.provenance
    lines = [
        f"{name} {old or 'absent'} there, {new or 'absent'} here"
        for name, (old, new) in differences(then.get("versions", {}), versions()).items()
    ]
    for name, stage in then.get("stages", {}).items():
        given = getattr(cfg.scene, name).usd_path
        file = find_stages(given)[0] if name == "colon" else resolve_asset(given)
        now = stage_hash(file)
        if stage["sha256"] not in (now, REWRITTEN.get(now)):
            lines.append(f"the stage {file} is not the one recorded ({now}, not {stage['sha256']})")
    if episode.settings and settings_hash(episode.settings) != then.get("settings"):
        lines.append("the settings in the file are not those that it was recorded with: their hash differs")
    for path, (old, new) in differences(episode.settings, to_plain(cfg)).items():
        if not any(path == own or path.startswith(f"{own}.") for own in CHANGED_HERE):
            lines.append(f"env.{path} was {old}, is {new}")
    if cfg.sim.device.partition(":")[0] != str(then.get("device")).partition(":")[0]:
        lines.append(f"recorded on {then.get('device')} ({then.get('device_name')}), run on {cfg.sim.device}")
    if _has_interval_events(episode.settings.get("events")):
        lines.append("events between resets changed the recorded world; they are not repeated")
    return lines


def put_at_start(env: Any, episode: Episode, env_ids: Sequence[int] = (0,)) -> None:
    """Put worlds where the episode begins: complete state, and what events had made different.

    Raises:
        UsageError: If the recording lacks the state, or it does not fit this colon and robot.
    """
    if not any(name.startswith("initial_state/") for name in episode.data):
        raise UsageError("The recording has no initial_state, so nothing can start where it did.")
    put_in_state(env, _below(episode.data, "initial_state/"), _below(episode.data, "world_settings/"), env_ids)


def put_in_state(
    env: Any, state: Mapping[str, np.ndarray], settings: Mapping[str, np.ndarray], env_ids: Sequence[int] = (0,)
) -> None:
    """Put worlds in one state, given without the dimension of worlds, and look at them anew.

    Args:
        env: The environment.
        state: Arrays of :meth:`arcgym.sim.Simulation.world_arrays` by name.
        settings: Arrays of ``world_settings`` by name, those of a sensor below its name.
        env_ids: The worlds.

    Raises:
        UsageError: If the state does not fit this colon and robot.
    """
    ids = torch.tensor(list(env_ids), device=env.device)
    colon = env.scene["colon"]
    if "patient" in settings and len(colon.patients) > 1:
        colon.write_patient_to_sim(torch.full((len(ids),), int(settings["patient"])), ids)
    known = dict(env.sim.world_settings())
    for name, sensor in env.scene.sensors.items():
        known |= {f"{name}/{key}": value for key, value in sensor.world_settings().items()}
    for name, value in settings.items():
        if name in known and name != "patient":
            known[name][ids] = torch.as_tensor(value).to(known[name])
    repeat = {name: np.repeat(np.asarray(value)[None], len(ids), axis=0) for name, value in state.items()}
    try:
        env.sim.write_state({name: torch.as_tensor(value) for name, value in repeat.items()}, ids)
    except ValueError as error:
        raise UsageError(str(error)) from error
    env.sim.forward()
    env.scene.update(0.0)


def _below(data: Mapping[str, np.ndarray], prefix: str) -> dict[str, np.ndarray]:
    return {name.removeprefix(prefix): value for name, value in data.items() if name.startswith(prefix)}


def _has_interval_events(events: Any) -> bool:
    terms = events.values() if isinstance(events, dict) else ()
    return any(isinstance(term, dict) and term.get("mode") == "interval" for term in terms)
