# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Where a recording comes from: task, seed, device, versions, and hashes of stages and settings."""

from __future__ import annotations

import hashlib
import json
import os
import platform
import subprocess
from functools import lru_cache
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

import warp as wp

from arcgym import __version__
from arcgym.utils.coerce import to_plain
from arcgym.utils.paths import portable_asset
from arcgym.utils.source_digest import source_digest

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv

PACKAGES = ("newton", "warp-lang", "torch", "numpy", "mujoco-warp")
"""Packages whose versions a result may depend on."""
COMMIT, CHANGED = "arcgym commit", " with changes"
"""Name of ARCGym's commit among the versions, and its ending where the code is not that of the commit."""
CODE = "arcgym code"
"""Name of the hash of ARCGym's code among the versions, where there is no commit to name."""
NOT_PHYSICS = ("recorders", "viewer", "log_dir")
"""Fields of a configuration that change nothing that happens."""


def provenance(env: ManagerBasedEnv, world: int = 0) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return what a recording of a world must say about its environment; the colon's stage is that of its patient.

    Returns:
        Facts (``task``, ``seed``, ``device``, ``device_name``, ``num_envs``, ``step_dt`` [s], ``versions``, ``stages``
        and ``settings``, the hash of the second), and the configuration as plain values.
    """
    settings = _without_folders(to_plain(env.cfg))
    stages = {name: getattr(env.scene[name], "path", None) for name in env.scene.keys()}  # noqa: SIM118
    patient = _patient(env, world)
    if patient is not None:
        stages["colon"] = patient.path
    facts = {
        "task": env.spec.id if env.spec else None,
        "seed": env.cfg.seed,
        "device": str(env.device),
        "device_name": _device_name(str(env.device)),
        "num_envs": env.num_envs,
        "step_dt": env.step_dt,
        "versions": versions(),
        "stages": {
            name: {"path": portable_asset(path), "sha256": stage_hash(path)}
            for name, path in stages.items()
            if path is not None
        },
        "settings": settings_hash(settings),
    }
    return facts, settings


def _without_folders(settings: dict[str, Any]) -> dict[str, Any]:
    """Return a configuration in which of the folders that a machine writes to only the names are left."""
    if settings.get("log_dir"):
        settings["log_dir"] = Path(settings["log_dir"]).name
    recorders = settings.get("recorders")
    if recorders and recorders.get("dataset_export_dir_path"):
        recorders["dataset_export_dir_path"] = Path(recorders["dataset_export_dir_path"]).name
    return settings


def episode_facts(env: ManagerBasedEnv, world: int) -> dict[str, Any]:
    """Return what distinguishes the episode under way in a world: ``patient``, the name of its patient."""
    patient = _patient(env, world)
    return {} if patient is None else {"patient": patient.name}


def _patient(env: ManagerBasedEnv, world: int) -> Any:
    """Return the patient of a world, None if the scene has no colon."""
    return env.scene["colon"].patient_of(world) if "colon" in env.scene.keys() else None  # noqa: SIM118


def settings_hash(settings: dict[str, Any]) -> str:
    """Return the hash of a configuration without what changes nothing that happens, 16 hexadecimal digits."""
    kept = {name: value for name, value in settings.items() if name not in NOT_PHYSICS}
    return hashlib.sha256(json.dumps(kept, sort_keys=True).encode()).hexdigest()[:16]


@lru_cache
def versions() -> dict[str, str]:
    """Return the versions of ARCGym, Python and the packages that results may depend on; of a checkout the commit."""
    found = {"arcgym": __version__, "python": platform.python_version(), **_commit()}
    for name in PACKAGES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def _commit() -> dict[str, str]:
    """Return the commit of ARCGym's own checkout, marked where files differ from it.

    A copy without a checkout, such as one on a cluster, has what the variable ``ARCGYM_COMMIT`` says, else, as a wheel,
    the hash of its code.
    """
    root = Path(__file__).resolve().parents[3]
    if not (root / ".git").exists():
        said = os.environ.get("ARCGYM_COMMIT", "")
        return {COMMIT: said} if said else {CODE: source_digest("arcgym", "arcgym_tasks")}
    try:
        commit, changed = (
            subprocess.run(["git", "-C", str(root), *words], capture_output=True, text=True, timeout=10).stdout.strip()
            for words in (("rev-parse", "--short=12", "HEAD"), ("status", "--porcelain", "--", "source"))
        )
    except (OSError, subprocess.SubprocessError):
        return {}
    return {COMMIT: commit + (CHANGED if changed else "")} if commit else {}


def stage_hash(path: str | Path) -> str:
    """Return the hash of a stage with all its layers and textures, 16 hexadecimal digits."""
    path = Path(path).resolve()
    return _stage_hash(path, path.stat().st_mtime_ns)


@lru_cache(maxsize=4096)
def _stage_hash(path: Path, changed: int) -> str:
    from pxr import UsdUtils

    layers, assets, _ = UsdUtils.ComputeAllDependencies(str(path))
    files = {Path(name).resolve() for name in [str(path), *(layer.realPath for layer in layers), *assets] if name}
    digest = hashlib.sha256()
    for file in sorted(files, key=lambda file: file.name):
        digest.update(file.name.encode() + hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()[:16]


def _device_name(device: str) -> str:
    """Return the model of a GPU, or of the machine's processor."""
    if device != "cpu":
        return str(wp.get_device(device).name)
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()
