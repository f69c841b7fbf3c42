# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The pages of tasks, actions and observations; shapes and scales are read from environments built for them."""

from __future__ import annotations

import functools
import inspect
from typing import Any

import torch
from markdown import code, plain, table

from arcgym.envs import ManagerBasedRLEnv
from arcgym.utils.config_reference import fields_of, shown
from arcgym.utils.reference import describe
from arcgym.utils.registry import list_tasks, load_cfg_from_registry

MANAGERS = ("rewards", "terminations", "events", "costs", "metrics")
"""Members of a task's configuration that the page of tasks lists."""


def robots() -> list[str]:
    """Return the robots that ship, as tasks name them."""
    return sorted({task.split("-")[2] for task in tasks()})


def tasks() -> list[str]:
    """Return the tasks that ship, without their ``-Play`` variants."""
    shipped = [task for task in list_tasks() if not task.endswith("-Play")]
    return [task for task in shipped if type(load_env_cfg(task)).__module__.startswith("arcgym_tasks.")]


def load_env_cfg(task: str) -> Any:
    """Return the configuration of a task's environment."""
    return load_cfg_from_registry(task, "env_cfg_entry_point")


@functools.cache
def environment(robot: str) -> ManagerBasedRLEnv:
    """Return one world of a robot, at rest in the anus."""
    cfg = load_env_cfg(f"ARC-Rectum-{robot}-Play")
    cfg.scene.num_envs, cfg.start, cfg.seed = 1, "rest", 0
    return ManagerBasedRLEnv(cfg)


def tasks_page() -> str:
    """Return the page of tasks."""
    cfgs = {task: load_env_cfg(task) for task in tasks()}
    parts = ["# Tasks in figures\n", "Made from the code.\n", "## Episodes\n", _episodes(cfgs)]
    others = _others(cfgs)
    for manager in MANAGERS:
        parts += [
            f"## {manager.capitalize()}\n",
            f"{_who(others[manager])}\n",
            _terms(manager, next(iter(cfgs.values()))),
        ]
    parts += ["## Differences of the `-Play` variants\n", _play()]
    return "\n".join(parts)


def actions_page() -> str:
    """Return the page of actions."""
    parts = [
        "# Actions\n",
        "Made from environments that the build of this page makes. A raw action is clipped to [-1, 1]; the first table "
        "has what a raw action of one commands, zero commands rest. The second has the drives and their limits.\n",
    ]
    for robot in robots():
        parts += [f"## {robot}\n", _axes(robot), _drives(robot)]
    return "\n".join(parts)


def observations_page() -> str:
    """Return the page of observations."""
    parts = [
        "# Observations\n",
        "Made from environments that the build of this page makes: what each group holds, in this order. Shapes are "
        "those of one world. Segment and number of worlds change nothing.\n",
    ]
    for robot in robots():
        groups = environment(robot).observation_manager.groups
        parts += [f"## {robot}\n"] + [_group(name, group) for name, group in groups.items()]
    return "\n".join(parts)


def _episodes(cfgs: dict[str, Any]) -> str:
    head = ("Task", "Control step", "Longest episode", "From rest", "Physics step", "Default worlds")
    return table(head, (_episode(task, cfg) for task, cfg in cfgs.items()))


def _episode(task: str, cfg: Any) -> list[str]:
    step = cfg.decimation * cfg.sim.dt
    longest = cfg.max_episode_length_s
    steps = f"{longest:g} s, {round(longest / step)} steps"
    rest = cfg.copy()
    rest.start = "rest"
    physics = f"1/{1 / cfg.sim.dt:.0f} s"
    return [code(task), f"{step:g} s", steps, f"{rest.max_episode_length_s:g} s", physics, str(cfg.scene.num_envs)]


def _others(cfgs: dict[str, Any]) -> dict[str, list[str]]:
    """Return for each manager the tasks that have other terms than the first one."""
    first = next(iter(cfgs.values()))
    return {
        name: [task for task, cfg in cfgs.items() if getattr(cfg, name).to_dict() != getattr(first, name).to_dict()]
        for name in MANAGERS
    }


def _who(others: list[str]) -> str:
    if not others:
        return "The same in every task."
    return f"The same in every task but {', '.join(map(code, others))}, see `arcgym train --task ... --help`."


def _terms(manager: str, cfg: Any) -> str:
    rows = []
    for name, term in vars(getattr(cfg, manager)).items():
        if term is None:
            rows.append([code(name), "off", "", "", ""])
            continue
        params = ", ".join(f"{key}={shown(value)}" for key, value in term.params.items())
        reference = describe(term.func)
        rows.append([code(name), code(reference.name), code(params), _settings(term), plain(reference.summary)])
    return table(("Term", "Function", "Parameters", "Settings", "Description"), rows)


def _settings(term: Any) -> str:
    """Return what a term sets beside function and parameters, where it is not the default."""
    usual = type(term)(func=term.func).to_dict()
    names = [name for name in vars(term) if name not in ("func", "params")]
    always = ("weight", "mode", "reduce")
    return ", ".join(
        code(f"{name}={shown(getattr(term, name))}")
        for name in names
        if name in always or term.to_dict()[name] != usual[name]
    )


def _play() -> str:
    train, play = load_env_cfg(tasks()[0]), load_env_cfg(f"{tasks()[0]}-Play")
    off = [name for name, term in vars(play.events).items() if term is None and getattr(train.events, name) is not None]
    return f"{play.scene.num_envs} worlds; the events {', '.join(map(code, off))} are off; no noise on observations.\n"


def _axes(robot: str) -> str:
    manager = environment(robot).action_manager
    rows = []
    for name in manager.active_terms:
        term = manager.get_term(name)
        for axis, unit in zip(term.axis_names, term.axis_units, strict=True):
            rows.append([str(len(rows)), code(name), axis, _commanded(term, term.axis_names.index(axis)), unit])
    return table(("Index", "Term", "Axis", "At a raw action of 1", "Unit"), rows)


def _commanded(term: Any, index: int) -> str:
    """Return what a raw action of one commands on an axis."""
    raw = torch.zeros(1, term.action_dim)
    raw[0, index] = 1.0
    before = term.process_actions(torch.zeros_like(raw)) or term.processed_actions.clone()
    term.process_actions(raw)
    value = (term.processed_actions - before).abs().max().item()
    term.reset()
    return f"{value:.6g}"


def _drives(robot: str) -> str:
    actuators = environment(robot).cfg.scene.endoscope.actuators
    rows = [
        [code(f"actuators.{name}.{field.name}"), code(shown(getattr(cfg, field.name))), plain(field.description)]
        for name, cfg in actuators.items()
        for field in fields_of(type(cfg))
        if field.name != "class_type"
    ]
    return table(("Drive", "Value", "Description"), rows)


def _group(name: str, group: Any) -> str:
    rows, start = [], 0
    for term, pipeline in group.pipelines.items():
        cfg, shape = pipeline.cfg, tuple(pipeline.shape)
        stop = start + shape[0]
        history = f"{cfg.history_length} frames, oldest first" if cfg.history_length else ""
        entries = str(start) if shape[0] == 1 else f"{start}–{stop - 1}"
        rows.append([entries, code(term), code(shape), history, plain(_summary(cfg.func))])
        start = stop
    kind = next(iter(group.pipelines.values())).dtype
    head = f"### Group {code(name)}\n\n{code(group.shape)}, {code(kind)}, joined along the first dimension.\n"
    return f"{head}\n{table(('Entries', 'Term', 'Shape', 'History', 'Description'), rows)}"


def _summary(func: Any) -> str:
    """Return the first paragraph of a term, or of the class of one that holds state."""
    return describe(func if inspect.isfunction(func) else type(func)).summary
