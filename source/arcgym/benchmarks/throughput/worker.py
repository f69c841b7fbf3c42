# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Measure one number of worlds in a process of its own and print its row as JSON.

``python -m arcgym.benchmarks.throughput.worker NUM_ENVS '{"task": ..., "device": ...}' [env.path=value ...]``
"""

from __future__ import annotations

import json
import statistics
import sys
import time
from typing import Any

from arcgym.anatomy.segments import SEGMENTS
from arcgym.benchmarks.hardware import device_mib, peak_host_mib
from arcgym.benchmarks.throughput.settings import Row, Settings
from arcgym.benchmarks.worlds import advance, forward_axis, load_env_cfg, make_env, random_actions

STARTED = time.perf_counter()
"""When this process began [s]."""
WARM_UP = 3
"""Control steps before the timed ones: the first compiles and captures, the others settle the contacts."""
BEFORE_END = 0.03
"""Way to the end of the segment that the tip has before it when timing begins [m], so that few worlds succeed."""
MOST_WITHDRAWING = 60
"""Control steps after which a tip that does not come back is left where it is."""


def main(num_envs: str, settings: str, *overrides: str) -> None:
    """Measure and print the row."""
    chosen = Settings(**json.loads(settings))
    env_cfg = load_env_cfg(chosen.task, overrides, chosen.seed, int(num_envs), chosen.device)
    choose_patients(chosen, env_cfg)
    print(json.dumps(measure(chosen, env_cfg)))


def choose_patients(settings: Settings, env_cfg: Any) -> None:
    """Give the configuration as many patients as are wanted: the first of its own, or stand-ins for its one colon."""
    colon = env_cfg.scene.colon
    if not settings.patients:
        return
    from arcgym.assets.patient_files import find_stages
    from arcgym.benchmarks.throughput.stand_ins import stand_ins

    if is_one_stage(colon.usd_path):
        colon.usd_path = list(map(str, stand_ins(find_stages(colon.usd_path)[0], settings.patients)))
        env_cfg.start = "rest"
    colon.num_patients = settings.patients


def is_one_stage(usd_path: Any) -> bool:
    """Return whether a configuration names one stage file."""
    return isinstance(usd_path, str) and usd_path.endswith((".usda", ".usdc", ".usd", ".usdz"))


def measure(settings: Settings, env_cfg: Any) -> Row:
    """Build the environment, step it under random actions and return the row."""
    from arcgym.benchmarks.timing import time_ms

    device, num_envs = env_cfg.sim.device, env_cfg.scene.num_envs
    began = time.perf_counter()
    env, used_before = build(settings.task, env_cfg)
    build_s = time.perf_counter() - began

    def step() -> None:
        env.step(random_actions(env))

    step()
    first_step_s = time.perf_counter() - STARTED
    if settings.start == "end":
        fill_segment(env)
    for _ in range(WARM_UP):
        step()
    durations = [time_ms(step, device) for _ in range(settings.steps)]
    total = statistics.median(durations)
    row = {
        "num_envs": num_envs,
        "patients": len(env.scene["colon"].patients),
        "build_s": build_s,
        "env_steps_per_s": 1.0e3 * num_envs / total,
        "sim_s_per_wall_s": 1.0e3 * num_envs * env.step_dt / total,
        "ms": {"total": total},
        "mean_step_ms": statistics.fmean(durations),
        "device_mib": None if used_before is None else (device_mib(device) or 0.0) - used_before,
        "host_mib": peak_host_mib(),
        "first_step_s": first_step_s,
        "world_failures": env.world_failures,
        **situation(env),
    }
    add_details(row, env, settings)
    env.close()
    return row


def build(task: str, env_cfg: Any) -> tuple[Any, float | None]:
    """Return the environment after its first reset, and the device memory in use before [MiB]."""
    import warp as wp

    from arcgym.utils import warp_setup  # noqa: F401  sets the log level that the next line changes

    wp.config.log_level = wp.LOG_INFO
    wp.init()
    used_before = device_mib(env_cfg.sim.device)
    return make_env(task, env_cfg), used_before


def fill_segment(env: Any) -> None:
    """Put every world into the start state of the next segment and withdraw the tip into the task's."""
    import torch

    segments = env.scene["colon"].segments
    following = segments[segments.index(env.cfg.segment) + 1 :]
    if not following:
        sys.exit(f"{env.cfg.segment} is the last segment of the colon; take --start entry")
    end = env.scene["colon"].data.segment_spans[:, SEGMENTS.index(env.cfg.segment), 1]
    env.sim.load_snapshots(states_at(env, following[0]))
    env.sim.write_snapshot(env.sim.snapshots.index(following[0]))
    env.sim.forward()
    actions = torch.zeros(env.num_envs, env.action_manager.total_action_dim, device=env.device)
    actions[:, forward_axis(env)] = -1.0
    for _ in range(MOST_WITHDRAWING):
        advance(env, actions)
        if bool((env.scene["endoscope"].data.tip_arc_length < end - BEFORE_END).all()):
            return


def states_at(env: Any, segment: str) -> list[Any]:
    """Return the start states of the task's segment and of ``segment`` in every patient."""
    from arcgym.benchmarks.throughput.stand_ins import moved_states
    from arcgym.sim.snapshot import fingerprint
    from arcgym.start_states.find import ensure, ensure_all

    patients = env.scene["colon"].patients
    if "stand_ins" not in patients[-1].path.parts:
        found = ensure_all(env.scene, segment)
    else:
        rests = [patient.wall.points for patient in patients]
        found = moved_states(
            ensure(env.scene, segment), rests, [fingerprint(env.sim, index) for index in range(len(patients))]
        )
    return [states.only([env.cfg.segment, segment]) for states in found]


def situation(env: Any) -> Row:
    """Return the device and where the scopes are at the end of the timed steps: means over the worlds."""
    import warp as wp

    data = env.scene["endoscope"].data
    return {
        "device_name": wp.get_device(env.device).name,
        "tip_arc_m": data.tip_arc_length.mean().item(),
        "inserted_m": data.inserted_length.mean().item(),
        "links_touching": (data.link_force_peak > 0.0).float().sum(dim=1).mean().item(),
    }


def add_details(row: Row, env: Any, settings: Settings) -> None:
    """Add the stages and the memory traffic to a row, as far as wished."""
    if not (settings.stages or settings.bandwidth):
        return
    from arcgym.benchmarks.throughput.stages import time_stages
    from arcgym.benchmarks.throughput.traffic import traffic

    row["ms"].update(time_stages(env, random_actions(env), settings.repeats))
    if settings.bandwidth:
        row["bandwidth"] = traffic(env.sim, env.cfg.decimation, row["ms"]["physics"])


if __name__ == "__main__":
    main(*sys.argv[1:])
