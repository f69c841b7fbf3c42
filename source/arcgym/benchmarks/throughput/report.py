# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The tables that the throughput benchmark prints. Importing this loads neither torch nor Warp."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table

from arcgym.benchmarks.throughput.settings import Row

COLUMNS = {
    "num_envs": ("worlds", "{}"),
    "patients": ("patients", "{}"),
    "env_steps_per_s": ("env steps/s", "{:.1f}"),
    "sim_s_per_wall_s": ("sim s/wall s", "{:.2f}"),
    "total": ("ms/step", "{:.2f}"),
    "device_mib": ("device MiB", "{:.0f}"),
    "host_mib": ("host MiB", "{:.0f}"),
    "links_touching": ("touching", "{:.1f}"),
    "compile_s": ("compile s", "{:.1f}"),
    "build_s": ("build s", "{:.1f}"),
    "first_step_s": ("first step s", "{:.1f}"),
}
"""Heading and format of each figure of a row."""


def headings() -> str:
    """Return the first line of the table of results."""
    return "".join(f"{heading:>14s}" for heading, _ in COLUMNS.values())


def describe(row: Row) -> str:
    """Return one line of the table of results."""
    if "error" in row:
        return f"{row['num_envs']:>14d}  {row['error']}"
    values = {"patients": 1, "build_s": None, **row, **row["ms"]}
    cells = ["-" if values[key] is None else form.format(values[key]) for key, (_, form) in COLUMNS.items()]
    return "".join(f"{cell:>14s}" for cell in cells)


def stage_table(rows: Sequence[Row]) -> Table:
    """Return milliseconds a control step, one line a stage and one column a number of worlds."""
    from arcgym.benchmarks.throughput.stages import STAGES

    done = [row for row in rows if "error" not in row]
    table = Table("stage", "what", title="ms per control step")
    for row in done:
        table.add_column(f"N = {row['num_envs']}, P = {row.get('patients', 1)}", justify="right")
    for name, what in {"total": "env.step, from the loop", **STAGES}.items():
        if any(name in row["ms"] for row in done):
            table.add_row(name, what, *(f"{row['ms'].get(name, float('nan')):.3f}" for row in done))
    return table


def device_name(rows: Sequence[Row], device: str) -> str:
    """Return the device, with the hardware's name if a worker came far enough to tell."""
    names = [row["device_name"] for row in rows if "device_name" in row]
    return f"{device} ({names[0]})" if names else device
