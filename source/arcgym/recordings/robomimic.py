# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Recordings as one HDF5 file that robomimic reads."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from pathlib import Path

import h5py
import numpy as np

from arcgym.recordings.samples import NO_EPISODE, Samples
from arcgym.utils.errors import UsageError

GYM = 2
"""Robomimic's number for environments of Gym."""
VALIDATION = 10
"""Every so many episodes, one is for validation."""


def write_robomimic(samples: Iterable[Samples], path: Path) -> int:
    """Write episodes: ``data/demo_k`` with ``obs``, ``next_obs``, ``actions``, ``rewards``, ``dones`` and ``states``.

    Observations are ``state`` and, where there are pictures, ``endoscope_image``. ``mask/train`` and ``mask/valid``
    part the episodes, one in ten for validation where there are two or more.

    Args:
        samples: The episodes.
        path: File to write; appears when it is complete.

    Returns:
        Number of episodes.

    Raises:
        UsageError: If there is none.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    total, names, tasks = 0, [], set()
    try:
        with h5py.File(partial, "w") as file:
            data = file.create_group("data")
            for number, one in enumerate(samples):
                names.append(f"demo_{number}")
                _write_episode(data.create_group(names[-1]), one)
                total += len(one)
                tasks.add(one.task)
            if not names:
                raise UsageError(NO_EPISODE)
            data.attrs["total"] = total
            args = {"env_name": "+".join(sorted(tasks)), "type": GYM, "env_kwargs": {}}
            data.attrs["env_args"] = json.dumps(args)
            valid = names[VALIDATION - 1 :: VALIDATION] or names[1:][-1:]
            for key, chosen in (("train", [name for name in names if name not in valid]), ("valid", valid)):
                file[f"mask/{key}"] = np.array(chosen, dtype="S")
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)
    return len(names)


def _write_episode(group: h5py.Group, one: Samples) -> None:
    done = np.zeros(len(one), np.int64)
    done[-1] = 1
    group.attrs["num_samples"] = len(one)
    group.attrs["success"] = one.success
    for name, value in {
        "actions": one.action,
        "rewards": one.reward,
        "dones": done,
        "states": one.state,
        "obs/state": one.state,
        "next_obs/state": one.next_state,
        "obs/endoscope_image": one.image,
        "next_obs/endoscope_image": one.next_image,
    }.items():
        if value is not None:
            group.create_dataset(name, data=value, compression="gzip", compression_opts=1)
