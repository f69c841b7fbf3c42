# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The throughput benchmark: command line, rows, stages."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
import warp as wp

from arcgym.benchmarks.throughput import launch, report
from arcgym.benchmarks.throughput.settings import Settings
from arcgym.benchmarks.throughput.stages import silenced
from arcgym.benchmarks.throughput.traffic import device_arrays
from arcgym.benchmarks.timing import median_ms

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "scripts" / "benchmarks"
ROW = {
    "num_envs": 4,
    "env_steps_per_s": 8.0,
    "sim_s_per_wall_s": 0.8,
    "ms": {"total": 500.0},
    "device_mib": None,
    "host_mib": 900.0,
    "links_touching": 12.0,
    "first_step_s": 10.0,
    "compile_s": 0.5,
    "compiled_modules": [],
}


def run(*arguments: str, flags: tuple[str, ...] = (), timeout: float = 300.0) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *flags, str(FOLDER / "throughput.py"), *arguments]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=timeout)


def test_help_needs_no_heavy_imports():
    result = run("--help", flags=("-X", "importtime"))
    assert result.returncode == 0, result.stderr
    imported = {line.split("|")[-1].strip() for line in result.stderr.splitlines()}
    assert not {"torch", "warp", "newton", "mujoco"} & imported


def test_unknown_task_ends_before_anything_is_built():
    result = run("--task", "ARC-Splenic-Proxmal", "--device", "cpu")
    assert result.returncode == 2
    assert "ARC-Splenic-Proximal" in result.stderr


SETTINGS = Settings(task="T", device="cpu", steps=1, repeats=1, start="entry", timeout=60.0)


@pytest.mark.parametrize(
    ("code", "error"),
    [
        ("raise SystemExit('out of memory')", "out of memory"),
        ("import os; os.kill(os.getpid(), 9)", "ended by signal 9, perhaps for lack of memory: no message"),
    ],
)
def test_failed_worker_gives_a_row_with_its_last_words(monkeypatch, tmp_path, code, error):
    script = tmp_path / "worker.py"
    script.write_text(code)
    monkeypatch.setattr(launch, "WORKER", [sys.executable, str(script)])
    assert launch.run_worker(SETTINGS, 4096, []) == {"num_envs": 4096, "error": error}


def test_row_is_the_last_line_of_the_worker(monkeypatch, tmp_path):
    script = tmp_path / "worker.py"
    script.write_text(f"print('Module loaded'); print({json.dumps(ROW)!r})")
    monkeypatch.setattr(launch, "WORKER", [sys.executable, str(script)])
    assert launch.run_worker(SETTINGS, 4, []) == {**ROW, "compile_s": 0.0}


def test_time_of_kernels_is_read_from_what_warp_prints():
    output = (
        "Module arcgym.sim.contact.contact_kernels 0a1b2c3 load on device 'cuda:0' took 1500.00 ms  (compiled)\n"
        "    Module torch_like load on device 'cuda:0' took 250.00 ms  (cached)\n{}"
    )
    expected = {"compile_s": 1.75, "compiled_modules": ["arcgym.sim.contact.contact_kernels"]}
    assert launch.module_loads(output) == expected


def test_cold_start_fills_the_cache_that_all_rows_use(monkeypatch):
    calls = []

    def worker(args, num_envs, overrides, environment):
        calls.append((num_envs, environment))
        return {**ROW, "num_envs": num_envs, "compile_s": 90.0 if len(calls) == 1 else 1.0}

    monkeypatch.setattr(launch, "run_worker", worker)
    first, second = launch.run_all(SETTINGS, [4, 8], [], lambda row: None, cache=Path("somewhere"))
    assert [num_envs for num_envs, _ in calls] == [4, 4, 8]
    assert {environment["WARP_CACHE_PATH"] for _, environment in calls} == {"somewhere/warp"}
    assert (first["compile_s_cold"], first["compile_s"], first["first_step_s_cold"]) == (90.0, 1.0, 10.0)
    assert "compile_s_cold" not in second


def test_shared_arrays_count_once():
    wp.init()
    held = wp.zeros(256, dtype=wp.vec3, device="cpu")
    view, others = wp.to_torch(held), [wp.zeros(64, dtype=float, device="cpu")]
    part = type("Part", (SimpleNamespace,), {"__module__": "arcgym.sim"})(view=view, held=held, others=others)
    assert sum(device_arrays(part).values()) == 256 * 12 + 64 * 4


def test_line_has_a_dash_for_the_memory_of_no_device():
    assert report.describe(ROW).split() == ["4", "1", "8.0", "0.80", "500.00", "-", "900", "12.0", "0.5", "-", "10.0"]


def test_median_leaves_the_first_call_out():
    wp.init()
    waits = iter([0.2, 0.01, 0.01, 0.01])
    assert 10.0 <= median_ms(lambda: time.sleep(next(waits)), "cpu", repeats=3) < 100.0


def test_silenced_method_comes_back():
    owner = SimpleNamespace(double=lambda number: 2 * number)
    with silenced((owner, "double")):
        assert owner.double(3) is None
    assert owner.double(3) == 6


@pytest.mark.slow
def test_measures_every_stage_on_the_cpu():
    arguments = ["--task=ARC-Rectum-Capsule", "--num_envs=1", "--steps=2", "--repeats=1", "--device=cpu"]
    result = run(*arguments, "--bandwidth", "--json")
    assert result.returncode == 0, result.stderr
    measured = json.loads(result.stdout.splitlines()[-1])
    (row,) = measured["rows"]
    assert row["num_envs"] == 1 and row["device_mib"] is None
    assert row["sim_s_per_wall_s"] == pytest.approx(0.1 * row["env_steps_per_s"])
    parts = {"total", "physics", "contact", "scope", "wall", "camera", "managers", "observation", "reset"}
    assert parts <= row["ms"].keys()
    assert min(row["ms"].values()) > 0.0
    assert 0.0 < row["bandwidth"]["share"] < 1.0
