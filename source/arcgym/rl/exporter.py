# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Writes a trained policy to files that run without ARCGym."""

from __future__ import annotations

import logging
import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import torch
from rsl_rl.models import MLPModel


def export_policy_as_jit(policy: MLPModel, folder: str | os.PathLike, filename: str = "policy.pt") -> Path:
    """Write the deterministic policy as TorchScript on the CPU and return the file's path."""
    path = _target(folder, filename)
    torch.jit.script(policy.as_jit().to("cpu").eval()).save(str(path))
    return path


def export_policy_as_onnx(policy: MLPModel, folder: str | os.PathLike, filename: str = "policy.onnx") -> Path:
    """Write the deterministic policy as ONNX, with a free batch size, and return the file's path."""
    path = _target(folder, filename)
    module = policy.as_onnx(verbose=False).to("cpu").eval()
    batch = torch.export.Dim("batch")
    inputs = module.get_dummy_inputs()
    shapes = tuple({0: batch} for _ in inputs)
    with _quiet_exporter():
        torch.onnx.export(
            module,
            inputs,
            str(path),
            opset_version=18,
            input_names=module.input_names,
            output_names=module.output_names,
            dynamic_shapes=(shapes,) if _is_variadic(module) else shapes,
            external_data=False,
            verbose=False,
            dynamo=True,
        )
    return path


def _target(folder: str | os.PathLike, filename: str) -> Path:
    Path(folder).mkdir(parents=True, exist_ok=True)
    return Path(folder) / filename


@contextmanager
def _quiet_exporter() -> Iterator[None]:
    """Hide torch's notes on its own deprecations and on torchvision, which no policy needs."""
    log = logging.getLogger("torch.onnx._internal.exporter._registration")
    level = log.level
    log.setLevel(logging.ERROR)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        log.setLevel(level)


def _is_variadic(module: torch.nn.Module) -> bool:
    return bool(module.forward.__code__.co_flags & 0x04)
