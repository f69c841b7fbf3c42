#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Search for an insertion of the pushed scope as a patient hand with marks and undo does, over many processes.

    python scripts/tools/search_insertion.py --tissue in_situ --processes 8 --minutes 10 --out logs/insertion

Every process goes back to a mark that got far, tries a few seconds with other settings of the scripted expert, often
after having withdrawn and turned the shaft, and marks where that led to. What leads to the foremost mark is one
continuous insertion: ``best.npz`` has its actions, and the steps at which it was marked. It ends with its time, also
where it has arrived; the same command goes on where it was stopped.
"""

from __future__ import annotations

import argparse
import io
import json
import multiprocessing
import os
import pickle
import queue
import random
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

TASK = "ARC-Cecum-Proximal-Play"
ARC_CELL, LOOP_CELL = 0.005, 0.03
"""Size of the cells of arc length and inserted length of which one mark each is kept [m]."""
FRONT, WIDE = 10, 60
"""Foremost marks from which is mostly gone on, and those for the rest."""
WIDE_SHARE = 0.25
"""Share of the tries that begin at one of the wide choice."""
SLACK = 0.4
"""Arc length that a mark is behind by a length of scope in loops."""
SLIPS = 0.03
"""Way that the tip may slip back while the shaft is withdrawn [m]."""
GUIDE = 30
"""Control steps of a guide between two marks."""
BIN = 10
"""Control steps between two looks at what was reached."""
TIP_LIMIT, WINDOW_LIMIT = 14.0, 45.0
"""Forces of the wall above which a try is given up [N]."""


@dataclass
class Mark:
    """Where a try led to."""

    actions: np.ndarray
    """Actions since the mark that it began at, shape (T, 4)."""
    state: dict[str, np.ndarray]
    """Complete state."""
    arc: float
    """Arc length of the tip [m]."""
    inserted: float
    """Length of scope inside [m]."""
    tip: float = 0.0
    """Largest force of the wall on the tip since the start [N]."""
    window: float = 0.0
    """Largest force on 50 mm of scope since the start [N]."""
    steps: int = 0
    """Control steps since the start."""
    parent: int = -1
    """Number of the mark that it began at."""
    tries: int = 0
    """How often was begun here."""
    plan: dict[str, Any] = field(default_factory=dict)
    """Settings of the try."""

    @property
    def cell(self) -> tuple[int, int]:
        """Where it counts."""
        return int(self.arc / ARC_CELL), int(self.inserted / LOOP_CELL)

    @property
    def merit(self) -> float:
        """How far it got, less scope that lies in loops [m]."""
        return self.arc - SLACK * (self.inserted - self.arc)

    @property
    def cost(self) -> float:
        """What two marks of a cell are compared by: time [s], and force [N] above what is gentle."""
        return 0.1 * self.steps + 4.0 * self.tip + 1.0 * self.window


def main() -> int:
    """Parse the command line and search."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tissue", default="in_situ", help="preset of the tissue (in_situ)")
    parser.add_argument("--patient", default="colon_1/colon.usda", help="stage of the colon (colon_1)")
    parser.add_argument("--processes", type=int, default=2, help="processes (2)")
    parser.add_argument("--minutes", type=float, default=10.0, help="time of the search [min] (10)")
    parser.add_argument("--seed", type=int, default=0, help="seed (0)")
    parser.add_argument("--guide", type=Path, help="best.npz of another search, whose actions are tried first")
    parser.add_argument("--overrides", nargs="*", default=[], help="env.path=value")
    parser.add_argument("--out", type=Path, required=True, help="folder of best.npz and marks.pkl")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    end = time.monotonic() + 60.0 * args.minutes
    settings = (args.tissue, args.patient, tuple(args.overrides))
    context = multiprocessing.get_context("spawn")
    tasks, results = context.Queue(), context.Queue()
    workers = [
        context.Process(target=work, args=(settings, tasks, results), daemon=True) for _ in range(args.processes)
    ]
    workers[0].start()
    marks = Marks(args.out, random.Random(args.seed))
    first = results.get()  # the first compiles, the others find its kernels
    if not marks.all:
        marks.add(first)
    for worker in workers[1:]:
        worker.start()
    guide = [] if args.guide is None or len(marks.all) > 1 else list(guided(args.guide))
    tasks.put((0, marks.all[0].state, guide.pop(0)) if guide else marks.choose())
    for _ in workers[1:]:
        tasks.put(marks.choose())
    while time.monotonic() < end:
        try:
            parent, found = results.get(timeout=5.0)
        except queue.Empty:
            continue
        if found is None:  # a start mark of another process
            continue
        last = parent
        for mark in found:
            mark.parent = parent
            last = marks.add(mark)
        led = bool(found) and "actions" in found[-1].plan
        tasks.put((last, marks.all[last].state, guide.pop(0)) if led and guide else marks.choose())
        marks.report()
    marks.save()
    for worker in workers:
        if worker.is_alive():
            worker.kill()
    return 0


class Marks:
    """All marks, and the choice of where to go on."""

    def __init__(self, out: Path, chance: random.Random) -> None:
        """Read those of an earlier run."""
        self.out, self.chance, self.all = out, chance, list[Mark]()
        self.cells: dict[tuple[int, int], int] = {}
        self.began = self.said = self.saved = time.monotonic()
        self.count = 0
        if (out / "marks.pkl").exists():
            self.all = pickle.loads((out / "marks.pkl").read_bytes())
            for index in range(len(self.all)):
                self._place(index)

    def add(self, mark: Mark) -> int:
        """Add a mark, and return its number; forces and steps count from the start."""
        self.count += 1
        if mark.parent >= 0:
            before = self.all[mark.parent]
            mark.tip, mark.window = max(mark.tip, before.tip), max(mark.window, before.window)
            mark.steps = before.steps + len(mark.actions)
        other = self.cells.get(mark.cell)
        better = other is None or mark.cost < self.all[other].cost
        if better or "actions" in mark.plan:
            self.all.append(mark)
        if better:
            self.cells[mark.cell] = len(self.all) - 1
        return len(self.all) - 1

    def _place(self, index: int) -> None:
        mark = self.all[index]
        other = self.cells.get(mark.cell)
        if mark.state and (other is None or mark.cost < self.all[other].cost):
            self.cells[mark.cell] = index

    def choose(self) -> tuple[int, dict[str, np.ndarray], dict[str, Any]]:
        """Return a mark to begin at, and what to try there."""
        order = sorted(self.cells.values(), key=lambda k: -(self.all[k].merit - 0.002 * self.all[k].tries))
        wide = self.chance.random() < WIDE_SHARE
        some = order[: WIDE if wide else FRONT]
        weights = [1.0 / (1.0 + self.all[k].tries) for k in some]
        index = self.chance.choices(some, weights)[0]
        self.all[index].tries += 1
        return index, self.all[index].state, self._plan()

    def _plan(self) -> dict[str, Any]:
        c = self.chance
        plan: dict[str, Any] = {
            "speed": c.uniform(0.015, 0.05), "look": c.uniform(0.015, 0.05), "gain": 0.1 * 5.0 ** c.random(),
            "largest": c.uniform(1.5, 2.9), "jiggle": c.choice([0.0, 0.0, c.uniform(0.0, 0.03)]),
            "twist": c.choice([0.0, 0.0, c.uniform(0.0, 0.8)]), "least_pace": c.uniform(0.15, 0.8), "patience": 1e6,
            "slack": c.uniform(0.04, 0.4), "seed": c.randrange(2**31), "push": c.choice([c.randrange(20, 60), 100]),
            "noise": c.choice([0.0, 0.5, 1.0]), "roll_steps": c.randrange(5, 80),
            "roll": c.choice([0.0, 0.0, c.uniform(-1.0, 1.0)]),
            "back": 0, "back_speed": c.uniform(0.01, 0.05), "back_roll": c.choice([0.0, c.uniform(-1.0, 1.0)]),
            "hold": c.random() < 0.5,
        }  # fmt: skip
        if c.random() < 0.5:
            plan["back"] = c.choice([c.randrange(4, 15), c.randrange(10, 80)])
        return plan

    def report(self) -> None:
        """Say how far it is, every ten seconds, and save now and then."""
        now = time.monotonic()
        if now - self.said > 10.0:
            self.said = now
            best = max(self.all, key=lambda mark: mark.arc)
            print(
                f"{now - self.began:.0f} s: {self.count} tries, {len(self.cells)} marks, {best.arc:.3f} m after "
                f"{0.1 * best.steps:.0f} s, {best.inserted:.2f} m inserted, tip {best.tip:.1f} N, "
                f"shaft {best.window:.1f} N",
                flush=True,
            )
        if now - self.saved > 30.0:
            self.saved = now
            self.save()

    def save(self) -> None:
        """Write all marks, and the actions to the foremost."""
        write(self.out / "marks.pkl", pickle.dumps(self.all))
        index = max(range(len(self.all)), key=lambda k: self.all[k].arc)
        line: list[Mark] = []
        while index >= 0:
            line.insert(0, self.all[index])
            index = line[0].parent
        steps = [mark.steps for mark in line]
        actions = np.concatenate([mark.actions for mark in line])
        best = line[-1]
        facts = {
            "arc": best.arc,
            "inserted": best.inserted,
            "tip": best.tip,
            "window": best.window,
            "steps": best.steps,
        }
        content = io.BytesIO()
        np.savez_compressed(content, actions=actions, steps=steps, facts=json.dumps(facts))
        write(self.out / "best.npz", content.getvalue())
        plain = [{name: value for name, value in mark.plan.items() if name != "actions"} for mark in line]
        plans = [{"arc": round(mark.arc, 4), "steps": mark.steps, **p} for mark, p in zip(line, plain, strict=True)]
        write(self.out / "best.json", json.dumps(plans, indent=1).encode())


def guided(path: Path) -> Iterator[dict[str, Any]]:
    """Yield plans that follow the actions of a file piece by piece."""
    actions = np.load(path)["actions"]
    for first in range(0, len(actions), GUIDE):
        yield {"actions": actions[first : first + GUIDE], "back": 0, "push": len(actions[first : first + GUIDE])}


def write(path: Path, content: bytes) -> None:
    """Write a file, whole or not at all."""
    partial = path.with_name(f".{path.name}.partial")
    partial.write_bytes(content)
    os.replace(partial, path)


def make_env(tissue: str, patient: str, overrides: tuple[str, ...]) -> Any:
    """Return the task's environment of one world, with nothing but physics and actions."""
    import gymnasium as gym

    import arcgym_tasks  # noqa: F401
    from arcgym.utils.hydra import apply_overrides
    from arcgym.utils.registry import load_cfg_from_registry, load_task_packages

    load_task_packages()
    cfg = load_cfg_from_registry(TASK, "env_cfg_entry_point")
    cfg.scene.num_envs, cfg.sim.device, cfg.seed, cfg.autoreset = 1, "cpu", 0, False
    cfg.scene.colon.usd_path, cfg.scene.colon.material = patient, tissue
    cfg.scene.camera = None
    for name in ("observations", "rewards", "costs", "metrics", "terminations"):
        setattr(cfg, name, None)
    apply_overrides({"env": cfg}, list(overrides))
    return gym.make(TASK, cfg=cfg).unwrapped


def work(settings: Any, tasks: Any, results: Any) -> None:
    """Try what is asked for, again and again."""
    import torch

    torch.set_num_threads(1)
    env = make_env(*settings)
    env.reset()
    env.step(torch.zeros(1, env.action_manager.total_action_dim))
    env.reset()
    data = env.scene["endoscope"].data
    start = Mark(np.zeros((0, 4), np.float32), state_of(env), float(data.tip_arc_length), float(data.inserted_length))
    first = multiprocessing.current_process().name.endswith("-1")
    results.put(start if first else (-1, None))
    from arcgym.utils.threads import one_thread

    with torch.no_grad(), one_thread():
        while True:
            index, state, plan = tasks.get()
            try:
                results.put((index, attempt(env, state, plan)))
            except Exception as error:  # noqa: BLE001 - one try fails, the others go on
                print(f"a try failed: {type(error).__name__}: {error}", file=sys.stderr, flush=True)
                results.put((index, []))


def state_of(env: Any) -> dict[str, np.ndarray]:
    """Copy the complete state."""
    return {name: array[0].numpy().copy() for name, array in env.sim.world_arrays().items()}


def attempt(env: Any, state: dict[str, np.ndarray], plan: dict[str, Any]) -> list[Mark]:
    """Begin at a state, withdraw if the plan says so, then push; return the foremost place and the end."""
    import torch

    from arcgym.experts.push_expert import PushExpert
    from arcgym.recordings.restoring import put_in_state

    put_in_state(env, state, {})
    data, scope = env.scene["endoscope"].data, env.scene["endoscope"]
    if "actions" in plan:
        return follow(env, plan)
    names = ("look", "gain", "largest", "jiggle", "twist", "least_pace", "patience", "slack")
    expert = PushExpert(env.scene, plan["speed"], **{name: plan[name] for name in names})
    expert.reset(torch.zeros(1, dtype=torch.long))
    noise = torch.Generator().manual_seed(plan["seed"])
    actions, tip, window = [], 0.0, 0.0
    found: list[Mark] = []
    best, began, backs = -1.0, float(data.tip_arc_length), plan["back"]
    for step in range(plan["back"] + plan["push"]):
        if step < backs and float(data.tip_arc_length) < began - SLIPS:
            backs = step
        back = step < backs
        drift = 0.85 * expert.disturbance + 0.25 * plan["noise"] * torch.randn(1, 3, generator=noise)
        expert.disturbance.copy_(drift)
        kept = expert.bending.clone()
        expert.act()
        if back:
            if plan["hold"]:
                expert.bending.copy_(kept)
                scope.set_bending_command(kept[:, 0], kept[:, 1])
            expert.velocity.fill_(-plan["back_speed"])
            scope.set_insertion_command(expert.velocity, torch.full((1,), float(plan["back_roll"])))
        elif plan["roll"] and step - backs < plan["roll_steps"]:
            scope.set_insertion_command(expert.velocity, torch.full((1,), float(plan["roll"])))
        action = env.action_manager.commanded_actions().clone()
        env.step(action)
        actions.append(action[0].numpy().copy())
        tip, window = max(tip, float(data.tip_force_peak)), max(window, float(data.window_force_peak.max()))
        if bool(env.sim.non_finite[0]) or bool(env.sim.wall_penetrated[0]) or tip > TIP_LIMIT or window > WINDOW_LIMIT:
            break
        arc, inserted = float(data.tip_arc_length), float(data.inserted_length)
        last = step == plan["back"] + plan["push"] - 1
        if (step + 1) % BIN and not last:
            continue
        mark = Mark(np.array(actions, np.float32), state_of(env), arc, inserted, tip, window, plan=plan)
        if mark.merit > best or last or step + 1 == backs:
            best = max(best, mark.merit)
            found.append(mark)
    return found


def follow(env: Any, plan: dict[str, Any]) -> list[Mark]:
    """Make given steps; return where they lead to, or nothing where forces get too high."""
    import torch

    data, tip, window = env.scene["endoscope"].data, 0.0, 0.0
    for action in plan["actions"]:
        env.step(torch.as_tensor(action)[None])
        tip, window = max(tip, float(data.tip_force_peak)), max(window, float(data.window_force_peak.max()))
        if bool(env.sim.non_finite[0]) or bool(env.sim.wall_penetrated[0]) or tip > TIP_LIMIT or window > WINDOW_LIMIT:
            return []
    arc, inserted = float(data.tip_arc_length), float(data.inserted_length)
    return [Mark(np.array(plan["actions"], np.float32), state_of(env), arc, inserted, tip, window, plan=plan)]


if __name__ == "__main__":
    sys.exit(main())
