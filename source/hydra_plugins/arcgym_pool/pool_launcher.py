# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Launcher of Hydra that runs jobs in threads, each on a device that is free.

Hydra finds it by its place in ``hydra_plugins``. A job must do its work in a process of its own, as those of
``arcgym study`` do: threads share Python.
"""

from __future__ import annotations

import queue
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hydra.core.config_store import ConfigStore
from hydra.core.utils import JobReturn, JobStatus
from hydra.plugins.launcher import Launcher
from hydra.types import HydraContext, TaskFunction
from omegaconf import DictConfig, open_dict


@dataclass
class PoolLauncherConf:
    """Settings of :class:`PoolLauncher`."""

    _target_: str = "hydra_plugins.arcgym_pool.pool_launcher.PoolLauncher"
    devices: list[str] = field(default_factory=lambda: ["cpu"])
    """Devices that jobs are put on, written into the job's ``device``."""
    per_device: int = 1
    """Jobs at a time on each."""


ConfigStore.instance().store(group="hydra/launcher", name="pool", node=PoolLauncherConf, provider="arcgym")


class PoolLauncher(Launcher):
    """Runs ``len(devices) * per_device`` jobs at a time; each gets ``device`` in its configuration."""

    def __init__(self, devices: Sequence[str], per_device: int) -> None:
        """Keep the settings, see :class:`PoolLauncherConf`."""
        self.slots = list(devices) * per_device
        self.config: DictConfig | None = None
        self.task_function: TaskFunction | None = None
        self.hydra_context: HydraContext | None = None

    def setup(self, *, hydra_context: HydraContext, task_function: TaskFunction, config: DictConfig) -> None:
        """Keep what Hydra gives."""
        self.config, self.hydra_context, self.task_function = config, hydra_context, task_function

    def launch(self, job_overrides: Sequence[Sequence[str]], initial_job_idx: int) -> Sequence[JobReturn]:
        """Run all jobs and return what they return, in their order."""
        assert self.config is not None
        Path(str(self.config.hydra.sweep.dir)).mkdir(parents=True, exist_ok=True)
        free: queue.Queue[str] = queue.Queue()
        for slot in self.slots:
            free.put(slot)
        with ThreadPoolExecutor(len(self.slots)) as pool:
            jobs = [pool.submit(self._run, self._compose(overrides), free) for overrides in job_overrides]
            try:
                return [job.result() for job in jobs]
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                raise

    def _compose(self, overrides: Sequence[str]) -> DictConfig:
        """Return the configuration of one job, without Hydra's own part."""
        assert self.hydra_context is not None and self.config is not None
        config: Any = self.hydra_context.config_loader.load_sweep_config(self.config, list(overrides))
        with open_dict(config):
            del config["hydra"]
        return config

    def _run(self, config: DictConfig, free: queue.Queue[str]) -> JobReturn:
        """Run one job on a free device."""
        assert self.task_function is not None
        device = free.get()
        try:
            with open_dict(config):
                config["device"] = device
            result = JobReturn(cfg=config, status=JobStatus.COMPLETED)
            result.return_value = self.task_function(config)
        except Exception as error:  # Hydra raises it again where the value is asked for
            result = JobReturn(cfg=config, status=JobStatus.FAILED)
            result.return_value = error
        finally:
            free.put(device)
        return result
