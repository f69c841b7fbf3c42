# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The patients that a checkpoint has seen in training, by what lies beside it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from arcgym.assets import ColonCfg
from arcgym.evaluation.result_folder import UNKNOWN
from arcgym.rl.demonstrations import demonstrated_patients
from arcgym.rl.params import BEGUN_FROM, RunParams, read_params
from arcgym.rl.pretrained import ABOUT
from arcgym.utils.hydra import apply_overrides


def trained_on(checkpoint: Path) -> Any:
    """Return the patients that a checkpoint was trained on; None where nothing beside it says so.

    The parameters of its run name them, or else the command that started it; those of a shipped policy do not, but its
    description does. A policy or teacher that the run began with brings its own, as do the run that it resumed and
    recorded episodes that it learnt from; what is no longer there is ``unknown: PATH``.
    """
    about = checkpoint.with_name(ABOUT)
    if about.is_file():
        return json.loads(about.read_text()).get("trained_on")
    saved = read_params(checkpoint.parent)
    if saved is None:
        return None
    own = saved.env.get("scene", {}).get("colon", {}).get("usd_path") or _patients_in(saved.command)
    others = [*_of_checkpoints(saved), *_of_demonstrations(saved)]
    return own if own is None or not others else _joined(own, *others)


def _of_checkpoints(saved: RunParams) -> list[Any]:
    """Return the patients of each checkpoint that a run began or went on from."""
    paths = [Path(saved.agent[name]) for name in BEGUN_FROM if saved.agent.get(name)]
    paths += [saved.resumed_from] if saved.resumed_from else []
    return [(trained_on(path) if path.is_file() else None) or f"{UNKNOWN} {path}" for path in paths]


def _of_demonstrations(saved: RunParams) -> list[Any]:
    """Return the patients of the recorded episodes that a run learnt from; an expert is asked in the run's own."""
    folder = saved.agent.get("algorithm", {}).get("demonstrations")
    if not folder or folder == "expert":
        return []
    return [demonstrated_patients(folder) or f"{UNKNOWN} {folder}"]


def _joined(*names: Any) -> list[str]:
    """Return the names of several settings of ``usd_path``, each once."""
    return list(dict.fromkeys(name for one in names for name in ([one] if isinstance(one, str) else one)))


def _patients_in(command: Sequence[str]) -> Any:
    """Return the patients that a command's words give a training; None where they leave it to the task."""
    colon, scene = ColonCfg(), "env.scene."
    words = [word.removeprefix(scene) for word in command if word.startswith(f"{scene}colon.usd_path=")]
    apply_overrides({"colon": colon}, words)
    return colon.usd_path if words else None
