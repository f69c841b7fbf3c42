# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Layout of a training run on disk: ``logs/rsl_rl/<experiment>/<time>[_<run name>]/``."""

from __future__ import annotations

import re
from datetime import datetime
from pathlib import Path
from typing import Any

import yaml

LOG_ROOT = Path("logs") / "rsl_rl"


def create_run_folder(experiment: str, run_name: str = "", root: Path = LOG_ROOT) -> Path:
    """Create and return the folder of a new run, named by the time of its start."""
    stamp = datetime.now().strftime("%Y-%m-%d_%H-%M-%S")
    folder = (root / experiment / f"{stamp}_{run_name}".rstrip("_")).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def write_params(folder: Path, **cfgs: Any) -> None:
    """Write each configuration as ``params/<name>.yaml``.

    Args:
        folder: Folder of the run.
        cfgs: Configurations with ``to_dict``, by name.
    """
    (folder / "params").mkdir(exist_ok=True)
    for name, cfg in cfgs.items():
        (folder / "params" / f"{name}.yaml").write_text(yaml.safe_dump(_plain(cfg.to_dict()), sort_keys=False))


def find_checkpoint(experiment: str, load_run: str = ".*", checkpoint: str = "latest", root: Path = LOG_ROOT) -> Path:
    """Return the checkpoint that the arguments select.

    Args:
        experiment: Experiment whose runs are searched.
        load_run: Name of a run or a regular expression; among matches the newest run that has the checkpoint wins.
        checkpoint: ``latest``, ``best``, a file name such as ``model_100.pt``, or a path to a file.
        root: Folder of all experiments.

    Raises:
        FileNotFoundError: Nothing matches; the message lists what is there.
    """
    if Path(checkpoint).is_file():
        return Path(checkpoint).resolve()
    runs = sorted((path for path in (root / experiment).glob("*") if path.is_dir()), reverse=True)
    for run in runs:
        if run.name == load_run or re.fullmatch(load_run, run.name):
            found = _select(run, checkpoint)
            if found is not None:
                return found.resolve()
    available = [str(path.relative_to(root / experiment)) for run in runs for path in _checkpoints(run)]
    raise FileNotFoundError(
        f"No checkpoint '{checkpoint}' of a run matching '{load_run}' in {(root / experiment).resolve()}. "
        f"Available: {', '.join(available) or 'none'}."
    )


def _select(run: Path, checkpoint: str) -> Path | None:
    if checkpoint == "latest":
        numbered = _checkpoints(run)
        return numbered[-1] if numbered else None
    path = run / ("model_best.pt" if checkpoint == "best" else checkpoint)
    return path if path.is_file() else None


def _checkpoints(run: Path) -> list[Path]:
    """Numbered checkpoints of a run, oldest iteration first."""
    numbers = {path: re.fullmatch(r"model_(\d+)\.pt", path.name) for path in run.glob("model_*.pt")}
    return sorted((path for path, match in numbers.items() if match), key=lambda path: int(path.stem.split("_")[1]))


def _plain(value: Any) -> Any:
    """Convert to what YAML can hold: functions and classes become ``module:name``, other objects their text."""
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple, set)):
        return [_plain(item) for item in value]
    if callable(value) and hasattr(value, "__qualname__"):
        return f"{value.__module__}:{value.__qualname__}"
    return str(value)
