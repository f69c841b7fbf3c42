# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""What a session can be started with: task, patient, tissue, start and driver."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import torch

from arcgym.envs import mdp
from arcgym.managers import RecorderTerm, RecorderTermCfg
from arcgym.managers.recorder_term import Record
from arcgym.rl.params import differences, restore
from arcgym.utils.coerce import to_plain
from arcgym.utils.errors import UsageError
from arcgym.utils.hydra import apply_overrides
from arcgym.utils.paths import assets_dir
from arcgym.utils.registry import list_tasks, load_cfg_from_registry, plain_task, play_task

KEPT_METRICS = ("success", "progress", "looping_ratio", "inserted_length", "max_tip_force", "max_base_force")
"""Metrics of a reduced session: those that need no picture."""
NEVER = 1.0e9
"""Period after which the policy's camera draws in a reduced session [s]."""


@dataclasses.dataclass(frozen=True)
class Choice:
    """What a session runs."""

    task: str
    """Registered task, without ``-Play``."""
    patient: str | None = None
    """Stage of the colon; None for the task's."""
    tissue: str | None = None
    """Preset of the tissue; None for the task's."""
    start: str | None = None
    """``segment``, or ``rest`` to begin in the anus; None for the task's."""
    driver: str = "hand"
    """``hand``, or the name of what drives until a hand takes over."""
    device: str = "cpu"
    """Where it runs."""
    seed: int = 0
    """Seed of the environment."""
    overrides: tuple[str, ...] = ()
    """Texts ``env.path=value``, applied last."""
    settings: dict[str, Any] | None = None
    """Configuration that the task was trained with, as plain values, for the policy that was trained in it."""
    num_envs: int = 1
    """Number of worlds; the first is shown, steered and recorded."""
    gas: bool = False
    """Whether the lumen has gas, with insufflation and suction by hand; not for policies, which have no such action."""
    reduced: bool = False
    """Whether what only policies and their judges need is left out: observations, rewards, costs, most metrics."""


class HandRecorder(RecorderTerm):
    """``hand/leads``: whether a person chose the action, uint8, shape (T,): the steps of an intervention."""

    def record_pre_step(self) -> Record:
        """Return who chose the action that is about to be applied."""
        env: Any = self._env
        return "hand/leads", env.hand_leads


class MarksRecorder(RecorderTerm):
    """``marks/step`` (M,) and ``marks/state/...`` (M, ...): complete states from which a replay can go on."""

    def record_pre_reset(self, env_ids: torch.Tensor) -> Record:
        """Return the marks of the episode that ends; nothing where there are none."""
        env: Any = self._env
        if not env.hand_marks:
            return None, None
        steps = torch.tensor([[step for step, _ in env.hand_marks]])
        names = env.hand_marks[0][1]
        states = {name: torch.stack([state[name] for _, state in env.hand_marks], dim=1) for name in names}
        return "marks", {"step": steps, "state": {name: value[env_ids] for name, value in states.items()}}


def tasks() -> list[str]:
    """Return the tasks that can be chosen."""
    return [name for name in list_tasks() if plain_task(name) == name]


def patients() -> list[str]:
    """Return the colons that come along, as ``colon_1/colon.usda``."""
    root = assets_dir()
    return sorted(str(path.relative_to(root)) for path in root.glob("*/colon.usda"))


def make_cfg(choice: Choice, out: Path) -> tuple[str, Any]:
    """Return the task's name and its configuration, its first world recorded to a folder.

    Raises:
        UsageError: If the task is unknown, or an override is wrong.
    """
    name = play_task(choice.task) if play_task(choice.task) in list_tasks(prefix="") else choice.task
    try:
        cfg = load_cfg_from_registry(name, "env_cfg_entry_point")
        if choice.settings is not None:
            plain = to_plain(load_cfg_from_registry(choice.task, "env_cfg_entry_point"))
            restore(cfg, choice.settings, "env", keep=list(differences(plain, to_plain(cfg))))
        cfg.scene.num_envs, cfg.sim.device, cfg.seed = choice.num_envs, choice.device, choice.seed
        _choose(cfg, choice)
        if choice.reduced:
            _reduce(cfg)
        recorders = mdp.TrajectoryRecorderCfg(dataset_export_dir_path=str(out), dataset_filename="teleop")
        recorders.env_ids = (0,)
        recorders.wall = mdp.PostStepWallRecorderCfg(positions=True)
        recorders.hand = RecorderTermCfg(class_type=HandRecorder)
        recorders.marks = RecorderTermCfg(class_type=MarksRecorder)
        cfg.recorders = recorders
        apply_overrides({"env": cfg}, list(choice.overrides))
        if choice.gas and not any(text.startswith("env.gas=") for text in choice.overrides):
            _add_gas(cfg)
    except (TypeError, ValueError) as error:
        raise UsageError(str(error)) from error
    return name, cfg


def _choose(cfg: Any, choice: Choice) -> None:
    if choice.patient is not None:
        cfg.scene.colon.usd_path = choice.patient
    if choice.tissue is not None:
        cfg.scene.colon.material = choice.tissue
    if choice.start is not None:
        cfg.start = choice.start


def _add_gas(cfg: Any) -> None:
    """Let the hand insufflate, where the task knows gas and its wall and solver can have it."""
    if getattr(cfg, "gas", "") == "none" and cfg.scene.colon.wall_model == "shell" and cfg.sim.solver == "two_level":
        cfg.gas = "commanded"


def _reduce(cfg: Any) -> None:
    """Leave out what policies and their judges need and a hand does not: a sixth of a control step's time."""
    for terms, kept in ((cfg.observations, ()), (cfg.rewards, ()), (cfg.costs, ()), (cfg.metrics, KEPT_METRICS)):
        for name in vars(terms):
            if name not in kept:
                setattr(terms, name, None)
    if getattr(cfg.scene, "camera", None) is not None:
        cfg.scene.camera.update_period = NEVER


def axes_of(env: Any) -> tuple[Sequence[str], Sequence[str]]:
    """Return name and unit of each action of an environment."""
    names: list[str] = []
    units: list[str] = []
    for term_name in env.action_manager.active_terms:
        term = env.action_manager.get_term(term_name)
        own = list(getattr(term, "axis_names", [f"{term_name}_{k}" for k in range(term.action_dim)]))
        names += own
        units += list(getattr(term, "axis_units", [""] * len(own)))
    return names, units
