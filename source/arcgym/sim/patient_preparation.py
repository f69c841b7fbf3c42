# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Many patients read, and their walls prepared, by processes side by side, before an environment takes them.

What they make lies in the cache folder, see :mod:`arcgym.assets.patient_cache` and :mod:`arcgym.sim.patient_walls`.
Threads of one process do not run side by side here. As a program, it prepares the patients of its standard input.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from arcgym.assets.colon_cfg import ColonCfg
from arcgym.assets.patient_files import find_stages
from arcgym.sim.patient_walls import BUILDING_CODE, NOT_IN_WALL, patient_walls
from arcgym.utils.class_type import construct
from arcgym.utils.coerce import to_plain
from arcgym.utils.paths import cache_dir
from arcgym.utils.progress import report
from arcgym.utils.source_digest import source_digest

FEW = 16
"""Patients that the environment's own threads prepare as fast: a process takes seconds to start."""


def prepare_patients(cfg: ColonCfg) -> None:
    """Leave the patients of an environment in the cache folder, those that no call has prepared before.

    Nothing is done for few patients. What cannot be prepared is left to the environment, which says why.
    """
    paths = find_stages(cfg.usd_path, cfg.num_patients)
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    marks = {path: _mark(cfg, path) for path in paths} if min(cores, len(paths)) > 1 and len(paths) > FEW else {}
    missing = [path for path, mark in marks.items() if not mark.is_file()]
    if len(missing) > FEW:
        report(f"preparing {len(missing)} patients in {min(cores, len(missing) // 2)} processes; this happens once")
        for path in _prepare(cfg, missing, min(cores, len(missing) // 2)):
            marks[path].parent.mkdir(parents=True, exist_ok=True)
            marks[path].touch()


def _mark(cfg: ColonCfg, path: Path) -> Path:
    """Return the empty file that says that a stage has been prepared with these settings, by this code."""
    settings = {name: value for name, value in to_plain(cfg).items() if name not in NOT_IN_WALL}
    key = (sorted(settings.items()), source_digest(*BUILDING_CODE), str(path.resolve()), path.stat().st_mtime_ns)
    return cache_dir() / "prepared" / f"{path.parent.name}-{hashlib.sha256(repr(key).encode()).hexdigest()[:20]}"


def _prepare(cfg: ColonCfg, paths: Sequence[Path], workers: int) -> list[Path]:
    """Run the processes and return the stages of those that ended well."""
    shares = [list(paths[k::workers]) for k in range(workers)]
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "CUDA_VISIBLE_DEVICES": ""}
    running: list[subprocess.Popen] = []
    try:
        for share in shares:
            with tempfile.TemporaryFile() as order:
                pickle.dump((cfg, [str(path) for path in share]), order)
                order.seek(0)
                command = [sys.executable, "-m", __name__]
                nowhere = subprocess.DEVNULL
                running.append(subprocess.Popen(command, stdin=order, stdout=nowhere, stderr=nowhere, env=environment))
        return [path for share, process in zip(shares, running, strict=True) if process.wait() == 0 for path in share]
    finally:
        for process in running:
            process.kill()
            process.wait()


def main() -> None:
    """Prepare the patients of the standard input: a configuration and paths of stages, pickled."""
    cfg, paths = pickle.load(sys.stdin.buffer)
    for part in (paths[:1], paths):  # kernels that are not in their cache are compiled for the first, by one thread
        cfg.usd_path, cfg.num_patients = part, None
        patient_walls(construct(cfg))


if __name__ == "__main__":
    main()
