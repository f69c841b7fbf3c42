# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Tables in the paper's layout, beside the paper's figures. Loads neither torch nor Warp."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import yaml

from arcgym.evaluation.result_folder import Row
from arcgym.evaluation.statistics import Interval, bootstrap, mean, training_runs, wilson
from arcgym.evaluation.suites import FOLDER, split_task
from arcgym.utils.errors import UsageError
from arcgym.utils.string import did_you_mean

TABLES_FILE = FOLDER / "paper_tables.yaml"
"""Layout of the tables, and what the paper published."""

KEYS = ("segment", "variant", "patient", "task", "algorithm", "trained_with")
"""What a table may tell trials apart by."""

RATES = ("success", "time_out")
"""Metrics that are shares of the trials [%], with Wilson's interval; of the others the mean is given."""


def paper_table(rows: Sequence[Row], name: str) -> str:
    """Return one of the paper's tables, in Markdown, of the trials of its suite.

    Each cell has the mean with its 95 % interval, and the paper's figure in brackets where there is one.

    Args:
        rows: Rows of trials.
        name: Name of the table, which is that of its suite or study; ``forces`` takes the trials of any suite.

    Raises:
        UsageError: There is no such table, no trial, or trials lack a column.
    """
    tables = yaml.safe_load(TABLES_FILE.read_text())
    if name not in tables:
        raise UsageError(f"The paper has no table '{name}'. {did_you_mean(name, tables)}")
    if not rows:
        raise UsageError("No trial was finished, so there is nothing to report.")
    table = tables[name]
    ((key, columns),) = table["columns"].items()
    keyed = [{**row, **_keys(row)} for row in rows]
    lines = list(table["rows"])
    if "by" in table:
        values = sorted({row[table["by"]] for row in keyed})
        lines += [{"label": value, table["by"]: value} for value in values]
    head = [f"| {' | '.join(['', *columns])} |", f"|{'---|' * (len(columns) + 1)}"]
    body = [_line(line, keyed, key, columns) for line in lines]
    note = "In brackets: the paper's own figure, in its own simulation." if table["rows"] else ""
    if any(line.get("metric") == "step_reward" for line in lines):
        note += " Step rewards are of the reward that was evaluated with; the paper's alone is env.reward=paper."
    return f"**{table['title']}.** {note}\n\n" + "\n".join([*head, *body]) + "\n"


def _keys(row: Row) -> dict[str, str]:
    task, variant = split_task(row["task"])
    return {"segment": task.split("-")[1], "variant": variant or ""}


def _line(line: dict[str, Any], rows: Sequence[Row], key: str, columns: Sequence[str]) -> str:
    own = [row for row in rows if all(row[name] == line[name] for name in KEYS if name in line)]
    published = line.get("paper") or [None] * len(columns)
    cells = []
    for column, figure in zip(columns, published, strict=True):
        metric = column if key == "metric" else line["metric"]
        chosen = own if key == "metric" else [row for row in own if row[key] == column]
        cells.append(_cell(chosen, metric) + ("" if figure is None else f" [{figure}]"))
    return f"| {' | '.join([line['label'], *cells])} |"


def _cell(rows: Sequence[Row], metric: str) -> str:
    if not rows:
        return "no trial"
    if metric in RATES:
        count = sum(row["end"] == metric for row in rows)
        return _text(wilson(count, len(rows)), 100.0, 0)
    if metric != "step_reward" and metric not in rows[0]:
        raise UsageError(
            f"The trials of {rows[0]['task']} have no {metric}, which the table needs: it is made of the folders of an "
            "evaluation, not of the small copies that results summary --keep writes."
        )
    values = np.array([row["reward"] / row["seconds"] if metric == "step_reward" else row[metric] for row in rows])
    return _text(bootstrap(values.astype(float), training_runs(rows), mean), 1.0, 3)


def _text(interval: Interval, factor: float, digits: int) -> str:
    value, low, high = (f"{factor * number:.{digits}f}" for number in (interval.value, interval.low, interval.high))
    return f"{value} ({low} to {high})"
