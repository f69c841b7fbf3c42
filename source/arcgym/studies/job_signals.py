# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Lets a cell's process leave a checkpoint before its job is put into a cluster's queue again."""

from __future__ import annotations

import signal
import subprocess
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from types import FrameType
from typing import Any

JOB_SIGNALS = (signal.SIGUSR1, signal.SIGUSR2)
"""What schedulers send some time before they end a job. Slurm sends it to all processes of the job; submitit's handler
puts the job into the queue again, at which Slurm kills what is left of it."""

CHECKPOINT_S = 60.0
"""Time that a cell's process has to leave its checkpoint; half of what submitit asks Slurm for."""


class JobEndedError(Exception):
    """The job is over and will not be put into the queue again; what it left goes on with the next call."""


@contextmanager
def start_child(command: Sequence[str], log: Any) -> Iterator[subprocess.Popen[bytes]]:
    """Run a command inside the block and end it after the block; a job's signal ends it before anything else.

    Where someone handles :data:`JOB_SIGNALS`, as submitit does, the process does not see them. It is asked to end by
    SIGTERM, and the handler is called when it has.

    Args:
        command: The program and its arguments.
        log: File that takes all it prints.

    Raises:
        JobEndedError: The handler has raised an error, as submitit's does where a job may not be queued again.
    """
    handlers = _handlers()
    for number in handlers:
        signal.signal(number, signal.SIG_IGN)  # what is ignored stays so in the process
    try:
        process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
    finally:
        _install(handlers)

    def end_first(number: int, frame: FrameType | None) -> None:
        end(process)
        try:
            handlers[number](number, frame)
        except Exception as error:
            raise JobEndedError(str(error)) from error

    _install(dict.fromkeys(handlers, end_first))
    try:
        yield process
    finally:
        process.terminate()
        _install(handlers)


def end(process: subprocess.Popen[bytes], seconds: float = CHECKPOINT_S) -> None:
    """Ask a process to end, and wait for it for some time."""
    process.terminate()
    try:
        process.wait(seconds)
    except subprocess.TimeoutExpired:
        print(f"process {process.pid} has not ended after {seconds:.0f} s", flush=True)


def _handlers() -> dict[int, Callable[[int, FrameType | None], Any]]:
    """Return who handles the job's signals, by signal; only the main thread may change that."""
    if threading.current_thread() is not threading.main_thread():
        return {}
    found = {number: signal.getsignal(number) for number in JOB_SIGNALS}
    return {int(number): handler for number, handler in found.items() if callable(handler)}


def _install(handlers: dict[int, Callable[[int, FrameType | None], Any]]) -> None:
    for number, handler in handlers.items():
        signal.signal(number, handler)
