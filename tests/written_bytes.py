# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Counts what torch's operations write."""

from __future__ import annotations

from typing import Any

import torch
from torch.utils._python_dispatch import TorchDispatchMode


class WrittenBytes(TorchDispatchMode):
    """Adds up the bytes of images, uint8, that every operation inside the context writes; views write none."""

    def __init__(self) -> None:
        super().__init__()
        self.total = 0

    def __torch_dispatch__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        result = func(*args, **(kwargs or {}))
        outputs = result if isinstance(result, (list, tuple)) else [result]
        for output, declared in zip(outputs, func._schema.returns, strict=False):
            alias = declared.alias_info
            is_written = alias is None or alias.is_write
            if isinstance(output, torch.Tensor) and output.dtype == torch.uint8 and is_written:
                self.total += self._written(func, args, output)
        return result

    @staticmethod
    def _written(func: Any, args: Any, output: torch.Tensor) -> int:
        """Bytes of the output, or of the entries that an indexed assignment writes; empty memory is not written."""
        name = func._schema.name
        if name.startswith("aten::empty"):
            return 0
        if name in ("aten::index_put_", "aten::_index_put_impl_"):
            return output[tuple(slice(None) if i is None else i for i in args[1])].numel()
        return output.numel()
