# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Make a trained policy one that comes with ARCGym, in ``policies/<segment>-<robot>/``.

    python scripts/tools/ship_policy.py logs/rsl_rl/left_colon/2026-11-22_20-00-00/model_93.pt
    arcgym evaluate --suite left_colon --agent assets/policies/leftcolon-magnetic/model.pt --out results/shipped
    python scripts/tools/ship_policy.py --evaluation results/shipped

The first call writes the actor in a quarter of its size, the parameters and the curve of its run, and about.json. The
second adds trials, which must be those of the file that was written: rounding changes actions in their third digit.
Of a path on the machine of the training only folder and file are kept: ``patient_0/colon.usda``.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Any

from arcgym.evaluation.result_folder import read_run
from arcgym.evaluation.results import find_results
from arcgym.evaluation.results_keep import keep
from arcgym.rl.checkpoint import file_sha256, read_checkpoint
from arcgym.rl.first_episodes import write_rows
from arcgym.rl.params import RunParams, differences, read_params
from arcgym.rl.pretrained import ABOUT, FILE, folder_of, policies_dir, write_small
from arcgym.rl.run_folder import write_params
from arcgym.rl.small_weights import LEVELS
from arcgym.utils.coerce import to_plain
from arcgym.utils.errors import UsageError
from arcgym.utils.registry import load_cfg_from_registry

OF_THE_MAKER = ("usd_path", "num_patients")
"""Fields of ``scene.colon`` that name patients on the machine of the training; a player's task has its own, as it has
its own events."""

NAMES = 2
"""Last names of a path that are kept: folder and file, by which results tell patients apart."""

CURVE = "curves.csv"
"""Name of a policy's curve in its folder."""


def main() -> None:
    """Write a policy's folder, or add an evaluation to it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkpoint", type=Path, nargs="?", help="checkpoint of a run, in the run's folder")
    parser.add_argument("--evaluation", type=Path, nargs="*", default=[], help="result folders of shipped policies")
    parser.add_argument("--curve", type=Path, help="curves.csv of a study's cell (default: of the run's own log)")
    parser.add_argument("--trained_on", help="patients of the training (default: as in the run's parameters)")
    parser.add_argument(
        "--levels", type=int, default=LEVELS, help="largest whole number of a weight: fewer make a smaller file"
    )
    parser.add_argument("--out", type=Path, help="folder of all shipped policies (default: beside the USD assets)")
    args = parser.parse_args()
    out = args.out or policies_dir()
    try:
        if args.checkpoint:
            print(f"written: {ship(args.checkpoint, out, args.curve, args.trained_on, args.levels)}")
        for folder in args.evaluation:
            print(f"evaluation: {add_evaluation(folder, out)}")
    except (UsageError, ValueError) as error:
        sys.exit(f"ship_policy: {error}")


def ship(
    checkpoint: Path, out: Path, curve: Path | None = None, trained_on: str | None = None, levels: int = LEVELS
) -> Path:
    """Write a policy's folder, and return the file with its weights.

    Raises:
        UsageError: The checkpoint is damaged, or its run's parameters are not beside it.
    """
    saved = read_params(checkpoint.parent)
    if saved is None:
        raise UsageError(f"{checkpoint.parent} has no params/, which names task and agent; expected a run's folder.")
    folder = out / folder_of(saved.task)
    write_small(checkpoint, folder / FILE, levels)
    about = _about(checkpoint, folder, saved, trained_on) | {"trained_with": _other_draws(saved)}
    (folder / ABOUT).write_text(json.dumps(about, indent=1) + "\n")
    for name in OF_THE_MAKER:
        saved.env.get("scene", {}).get("colon", {}).pop(name, None)
    saved.env.pop("events", None)
    env, agent = without_folders(saved.env), without_folders(saved.agent)
    write_params(folder, run={"task": saved.task, "agent": saved.agent_key}, env=env, agent=agent)
    _write_curve(checkpoint.parent, curve, folder / CURVE)
    return folder / FILE


def add_evaluation(folder: Path, out: Path) -> Path:
    """Put a small copy of an evaluation beside the policy that ran it, and return its place.

    Raises:
        UsageError: No shipped policy has the hash that the trials were run with, or the trials cannot be shown.
    """
    hashes = read_run(folder).get("checkpoint_sha256", [])
    owners = [path.parent for path in out.glob(f"*/{FILE}") if [file_sha256(path)] == hashes]
    if not owners:
        raise UsageError(f"{folder} was run with {', '.join(hashes) or 'no checkpoint'}, which is no file in {out}.")
    results, left_out = find_results([folder])
    if left_out:
        raise UsageError(f"{folder}: {'; '.join(left_out[folder])}.")
    keep(results, owners[0] / "evaluation")
    return owners[0] / "evaluation" / folder.name


def without_folders(value: Any) -> Any:
    """Return plain values, nested at will, in which every absolute path is cut to its last :data:`NAMES` names."""
    if isinstance(value, dict):
        return {name: without_folders(child) for name, child in value.items()}
    if isinstance(value, list):
        return [without_folders(child) for child in value]
    if not isinstance(value, str):
        return value
    kinds = (PurePosixPath(value), PureWindowsPath(value))
    return next(("/".join(path.parts[1:][-NAMES:]) for path in kinds if path.is_absolute()), value)


def _about(checkpoint: Path, folder: Path, saved: RunParams, trained_on: str | None) -> dict[str, object]:
    infos = read_checkpoint(checkpoint)["infos"] or {}
    return {
        "task": saved.task,
        "agent": saved.agent_key,
        "trained_on": without_folders(trained_on or saved.env["scene"]["colon"]["usd_path"]),
        "began_with": _began_with(saved.agent.get("init_policy")),
        "transitions": infos.get("transitions"),
        "seconds_of_learning": infos.get("seconds"),
        "sha256": file_sha256(folder / FILE),
        "made_from_sha256": file_sha256(checkpoint),
    }


def _other_draws(saved: RunParams) -> dict[str, Any]:
    """Return what the training drew otherwise than its task as registered, such as friction, by dotted path.

    A policy that ships meets the task as registered: its parameters have no events.
    """
    registered = to_plain(load_cfg_from_registry(saved.task, "env_cfg_entry_point").events)
    found = differences(registered, saved.env.get("events", registered))
    return {f"env.events.{path}": used for path, (_, used) in found.items() if path.partition(".")[0] != "patient"}


def _began_with(init_policy: str | None) -> dict[str, Any] | None:
    """Return name, task and hash of the policy that a training began with, as far as its file is still there."""
    if init_policy is None:
        return None
    path = Path(init_policy)
    run = read_params(path.parent)
    return {
        "policy": without_folders(init_policy),
        "task": None if run is None else run.task,
        "sha256": file_sha256(path) if path.is_file() else None,
    }


def _write_curve(run: Path, given: Path | None, out: Path) -> None:
    """Write the curve that is given, or that of the run's log, if it has one."""
    if given:
        shutil.copy(given, out)
    elif list(run.glob("events.*")):
        from arcgym.studies.curves import read_log

        rows = [{"iteration": iteration, **row} for iteration, row in sorted(read_log(run).items())]
        names = list(dict.fromkeys(name for row in rows for name in row))
        write_rows(out, [{name: row.get(name, "") for name in names} for row in rows])


if __name__ == "__main__":
    main()
