# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Starts a process for each number of worlds and gathers their rows. Importing this loads neither torch nor Warp."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from itertools import product
from pathlib import Path

from arcgym.benchmarks.throughput.settings import Row, Settings

WORKER = [sys.executable, "-m", "arcgym.benchmarks.throughput.worker"]
"""Command of a worker."""
MODULE_LOADED = re.compile(r"^ *Module (\S+) .* took ([\d.]+) ms +\((compiled|cached)\)", re.MULTILINE)
"""The line that Warp prints when it has loaded a module of kernels."""


def run_all(
    settings: Settings,
    num_envs: Sequence[int],
    overrides: Sequence[str],
    report: Callable[[Row], None],
    cache: Path | None = None,
    patients: Sequence[int] = (0,),
) -> list[Row]:
    """Measure every number of worlds, and of patients in them.

    Args:
        settings: What is measured.
        num_envs: Numbers of worlds.
        patients: Numbers of patients; 0 for those of the configuration.
        overrides: Texts ``env.path=value``.
        report: Called with each row as it comes.
        cache: Empty folder for kernels; with it, the first number is started twice, cold and cached.
    """
    environment = {} if cache is None else kernel_cache(cache)
    cold = {} if cache is None else run_worker(settings, num_envs[0], overrides, environment)
    rows: list[Row] = []
    for count, kinds in product(num_envs, patients):
        row = run_worker(replace(settings, patients=kinds), count, overrides, environment)
        if not rows:
            row |= {f"{name}_cold": cold[name] for name in ("compile_s", "first_step_s") if name in cold}
        rows.append(row)
        report(row)
    return rows


def kernel_cache(folder: Path) -> dict[str, str]:
    """Return the environment variables with which Warp and the driver keep their kernels in a folder."""
    return {"WARP_CACHE_PATH": str(folder / "warp"), "CUDA_CACHE_PATH": str(folder / "cuda")}


def run_worker(
    settings: Settings, num_envs: int, overrides: Sequence[str], environment: dict[str, str] | None = None
) -> Row:
    """Measure one number of worlds in a process of its own; a failure there becomes the row's ``error``."""
    command = [*WORKER, str(num_envs), json.dumps(asdict(settings)), *overrides]
    variables = {**os.environ, **(environment or {})}
    try:
        result = subprocess.run(command, timeout=settings.timeout, capture_output=True, text=True, env=variables)
    except subprocess.TimeoutExpired:
        return {"num_envs": num_envs, "error": f"not finished after {settings.timeout:g} s"}
    if result.returncode == 0:
        return json.loads(result.stdout.splitlines()[-1]) | module_loads(result.stdout)
    lines = result.stderr.strip().splitlines() or ["no message"]
    killed = f"ended by signal {-result.returncode}, perhaps for lack of memory: " if result.returncode < 0 else ""
    return {"num_envs": num_envs, "error": killed + lines[-1]}


def module_loads(output: str) -> Row:
    """Return the time that a worker spent on loading modules of kernels [s], and the modules that it compiled."""
    loads = MODULE_LOADED.findall(output)
    compiled = [name for name, _, how in loads if how == "compiled"]
    return {"compile_s": 1.0e-3 * sum(float(ms) for _, ms, _ in loads), "compiled_modules": compiled}
