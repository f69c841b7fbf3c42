# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Make a trained policy one that comes with ARCGym: its actor in half precision, and the parameters of its run.

    python scripts/tools/ship_policy.py logs/rsl_rl/left_colon/2026-11-22_20-00-00/model_93.pt

The robot is that of the run's task. Evaluate the file that is written, not the one it was made from.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from arcgym.rl.params import read_params
from arcgym.rl.pretrained import FILE, policies_dir, robot_of, write_small
from arcgym.rl.run_folder import write_params
from arcgym.utils.errors import UsageError

OF_THE_MAKER = ("usd_path", "num_patients")
"""Fields of ``scene.colon`` that name patients on the machine of the training; a player's task has its own."""


def main() -> None:
    """Write ``policies/<robot>/model.pt`` and ``policies/<robot>/params``."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkpoint", type=Path, help="checkpoint of a run, in the run's folder")
    parser.add_argument("--out", type=Path, help="folder of all shipped policies (default: beside the USD assets)")
    args = parser.parse_args()
    try:
        print(f"written: {ship(args.checkpoint, args.out or policies_dir())}")
    except UsageError as error:
        sys.exit(f"ship_policy: {error}")


def ship(checkpoint: Path, out: Path) -> Path:
    """Write a policy's folder, and return the file with its weights.

    Raises:
        UsageError: The checkpoint is damaged, or its run's parameters are not beside it.
    """
    saved = read_params(checkpoint.parent)
    if saved is None:
        raise UsageError(f"{checkpoint.parent} has no params/, which names task and agent; expected a run's folder.")
    folder = out / robot_of(saved.task)
    write_small(checkpoint, folder / FILE)
    for name in OF_THE_MAKER:
        saved.env.get("scene", {}).get("colon", {}).pop(name, None)
    run = {"task": saved.task, "agent": saved.agent_key}
    write_params(folder, run=run, env=saved.env, agent=saved.agent)
    return folder / FILE


if __name__ == "__main__":
    main()
