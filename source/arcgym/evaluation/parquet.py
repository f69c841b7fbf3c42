# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The rows of a result folder as Parquet, for data frames."""

from __future__ import annotations

import importlib.util
import os
from pathlib import Path

from arcgym.evaluation.result_folder import read_trial_rows

PARQUET_FILE = "trials.parquet"
"""The rows of ``trials.csv``, with the types of their columns."""


def write_parquet(folder: Path) -> Path | None:
    """Write the rows beside ``trials.csv``, whole or not at all, and return the file; None without pyarrow."""
    if importlib.util.find_spec("pyarrow") is None:
        return None
    import pyarrow
    import pyarrow.parquet

    path = folder / PARQUET_FILE
    partial = path.with_suffix(".tmp")
    pyarrow.parquet.write_table(pyarrow.Table.from_pylist(read_trial_rows(folder)), partial)
    os.replace(partial, path)
    return path
