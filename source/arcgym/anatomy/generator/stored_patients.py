# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Stages of the population's patients in the cache folder; missing ones are generated, on all cores.

As a program, ``python -m arcgym.anatomy.generator.stored_patients FOLDER SEED ...``, it generates patients one by one;
without seeds those of its standard input, which several such programs may share.
"""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from arcgym.anatomy.generator.splits import given_patients, read_splits, split_seeds
from arcgym.anatomy.grid_shape import GridShape
from arcgym.utils.paths import cache_dir
from arcgym.utils.progress import report

MOST = 1024
"""Patients that are generated without being asked for by number."""
ONE_CORE = {
    "OMP_NUM_THREADS": "1",
    "MALLOC_MMAP_MAX_": "0",
    "MALLOC_TRIM_THRESHOLD_": "8000000000",
    "MALLOC_TOP_PAD_": "67108864",
}
"""Environment of a process that generates patients: one thread, and memory that glibc keeps for the next array.

A virtual machine may give freed pages back to its host: with 18 processes on an H200's host a patient took 39 s, so 27.
"""

_RECORD = 32
"""Bytes of a patient's name in the list that the processes share."""

LOOK_EVERY = 0.5
"""Time between two looks at how many are there [s]."""


def population_stages(split: str, count: int | None) -> list[Path]:
    """Return the stages of a split's patients by ascending seed; those that are missing are generated.

    Args:
        split: Name of a split, see :mod:`arcgym.anatomy.generator.splits`, or patients by seed, see
            :func:`arcgym.anatomy.generator.splits.given_patients`.
        count: Number of patients, from the first; None for all of a split that is not large.

    Raises:
        ValueError: If there is no such split, it has fewer patients, it is large and no number is given, or a patient
            cannot be generated.
    """
    seeds: Sequence[int | str] = given_patients(split) or split_seeds(split)
    if count is None and len(seeds) > MOST:
        raise ValueError(
            f"population:{split} has {len(seeds)} patients, which would take hours to generate: say how many with "
            "env.scene.colon.num_patients."
        )
    if count is not None and count > len(seeds):
        raise ValueError(f"ColonCfg.num_patients is {count}, but population:{split} has {len(seeds)} patients.")
    folder = store_folder()
    stages = {seed: stage_of(folder, seed) for seed in seeds[:count]}
    missing = [seed for seed, stage in stages.items() if not stage.is_file()]
    if missing:
        _generate(folder, missing)
    return list(stages.values())


def store_folder() -> Path:
    """Return the folder of the patients that this version makes: of the generator's version and the wall's grid."""
    grid = GridShape()
    return cache_dir() / "population" / f"generator_{read_splits().generator}_{grid.rings}x{grid.sectors}"


def stage_of(folder: Path, patient: int | str) -> Path:
    """Return where the stage of a patient lies, named by seed, or by seed and gas: ``20000*0.8``."""
    seed, _, gas = str(patient).partition("*")
    return folder / f"patient_{int(seed):05d}{f'_gas_{gas}' if gas else ''}" / "colon.usda"


def main(folder: str, *patients: str) -> None:
    """Generate patients that are not there; those of the standard input where none are given."""
    from arcgym.anatomy.generator.output import make_to_folder
    from arcgym.anatomy.generator.population import draw_spec

    for patient in patients or _next_of_all():
        stage = stage_of(Path(folder), patient)
        if stage.is_file():
            continue
        seed, _, gas = patient.partition("*")
        spec = draw_spec(int(seed))
        if gas:
            spec = replace(spec, inflation=round(spec.inflation * float(gas), 4), head_room=False)
        try:
            make_to_folder(spec, stage.parent)
        except (OSError, ValueError):
            if not stage.is_file():  # else another process, which makes the same one, was first
                raise


def _next_of_all() -> Iterator[str]:
    """Yield names from the standard input, each of which one process gets: all read on in the same open file.

    They end where the process that asked for them is gone, as one that was killed.
    """
    asked_by = os.getppid()
    while os.getppid() == asked_by and (record := os.read(0, _RECORD)):
        yield record.decode().strip()


def _generate(folder: Path, seeds: Sequence[int | str]) -> None:
    """Generate patients in as many processes as there are cores.

    Raises:
        ValueError: If one cannot be generated; with what the generator says.
    """
    workers = min(len(seeds), len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1)
    command = [sys.executable, "-m", __name__, str(folder)]
    with contextlib.ExitStack() as stack:
        said = [stack.enter_context(tempfile.TemporaryFile("w+")) for _ in range(workers)]
        wanted = stack.enter_context(tempfile.TemporaryFile())
        wanted.write(b"".join(f"{seed!s:<{_RECORD}}".encode() for seed in seeds))
        wanted.seek(0)
        processes = [
            subprocess.Popen(
                command,
                stdin=wanted,
                stdout=subprocess.DEVNULL,
                stderr=said[k],
                env={**ONE_CORE, **os.environ, "OMP_NUM_THREADS": "1"},
            )
            for k in range(workers)
        ]
        try:
            failed = _wait(processes, folder, seeds)
        finally:
            for process in processes:
                process.kill()
                process.wait()
        if failed is not None:
            said[failed].seek(0)
            lines = said[failed].read().strip().splitlines() or ["no message"]
            raise ValueError(f"A patient of the population cannot be generated: {lines[-1]}")


def _wait(processes: Sequence[subprocess.Popen], folder: Path, seeds: Sequence[int | str]) -> int | None:
    """Wait until all have ended or one has failed, whose number is returned, and report how far it is."""
    shown = -1
    while True:
        codes = [process.poll() for process in processes]
        failed = next((k for k, code in enumerate(codes) if code), None)
        if failed is not None or None not in codes:
            return failed
        done = sum(stage_of(folder, seed).is_file() for seed in seeds)
        if done != shown:
            report(f"generating patients: {done} of {len(seeds)} in {folder}; this happens once")
            shown = done
        time.sleep(LOOK_EVERY)


if __name__ == "__main__":
    main(*sys.argv[1:])
