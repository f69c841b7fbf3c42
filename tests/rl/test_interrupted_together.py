# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Processes that learn together stop after the same update, though one of them alone has a signal."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest
import torch
import torch.multiprocessing

from arcgym.rl.interrupt import InterruptGuard, TrainingInterrupted


def learn(rank: int, folder: str) -> None:
    """Make three updates that need each other's gradients; process 1 has a signal in its second rollout."""
    torch.distributed.init_process_group("gloo", init_method=f"file://{folder}/store", rank=rank, world_size=2)
    gradients = []
    try:
        with InterruptGuard(together=True) as guard:
            for update in range(3):
                if (rank, update) == (1, 1):
                    os.kill(os.getpid(), signal.SIGTERM)
                with guard.hold():
                    gradient = torch.tensor(float(rank + update))
                    torch.distributed.all_reduce(gradient)
                    gradients.append(float(gradient))
    except TrainingInterrupted as interrupt:
        Path(folder, str(rank)).write_text(f"{gradients} {interrupt.signal_number}")
    torch.distributed.destroy_process_group()


@pytest.mark.slow
def test_all_end_after_the_update_before_which_one_had_a_signal(tmp_path) -> None:
    torch.multiprocessing.spawn(learn, args=(str(tmp_path),), nprocs=2)
    assert [(tmp_path / str(rank)).read_text() for rank in range(2)] == [f"[1.0, 3.0] {int(signal.SIGTERM)}"] * 2
